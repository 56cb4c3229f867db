"""Scene files: in TOML what can be said in Python, in the same words."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator, ValidationInfo, field_validator

from ancf.bodies import SHAPES, Plate
from ancf.errors import InputError, Mistake, Mistakes, one_of
from ancf.inputs import Input, table
from ancf.loads import Load
from ancf.materials import Material
from ancf.model import Model
from ancf.probes import Probe
from ancf.progress import Progress
from ancf.result import Result
from ancf.run import Dynamic, Run, Static
from ancf.solve import solve
from ancf.supports import Support

_TABLES = {"bodies": "body", "supports": "support", "loads": "load", "probes": "probe"}
_ANY_MATERIAL = Material(E=1.0, nu=0.0)


@dataclass(frozen=True)
class Scene:
    """A model and how to run it.

    Parameters
    ----------
    title : str
        What it is called.
    model : Model
        What to run.
    run : Static or Dynamic
        How to run it.
    """

    title: str
    model: Model
    run: Static | Dynamic

    def solve(
        self,
        *,
        checkpoint: str | os.PathLike[str] | None = None,
        resume: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        progress: Progress = None,
        throw: bool = True,
    ) -> Result:
        """Run the scene.

        Parameters
        ----------
        checkpoint, resume, threads, progress, throw : optional
            As in `solve_static` and `simulate`; the first two are for motion only.

        Returns
        -------
        Result
            The state at the start, then one for each output.

        Raises
        ------
        InputError
            If the model cannot be run in this way.
        SolveError
            If the run fails; `SolveError.result` holds what it had.
        Interrupted
            On Ctrl-C; `Interrupted.result` holds what it had.
        """
        start = None
        if isinstance(self.run, Dynamic):
            start = partial(self.run.start, checkpoint=checkpoint, resume=resume)
        elif checkpoint is not None or resume is not None:
            raise InputError(Mistake(("checkpoint",), "is for motion only"))
        with _scene_paths({}):
            return solve(self.model, self.run, threads=threads, progress=progress, throw=throw, start=start)


def load_scene(path: str | os.PathLike[str]) -> Scene:
    """Read and check a scene file.

    Parameters
    ----------
    path : str or path
        The TOML file.

    Returns
    -------
    Scene
        Ready to be run.

    Raises
    ------
    InputError
        If there is no such file, it is not TOML, or there are mistakes in it.
    """
    document = _read(Path(path))
    scene = _File(**document)
    material_names = {name: body["material"] for name, body in document["body"].items()}
    with _scene_paths(material_names):
        model = Model(bodies=scene.body, supports=scene.support, loads=scene.load, probes=scene.probe)
        scene.run.check(model)
    return Scene(scene.title, model, scene.run)


class _File(Input):
    """The tables of a scene file, each checked by itself."""

    title: str = ""
    material: Mapping[str, Annotated[Material, PlainValidator(table(Material))]]
    body: Mapping[str, Plate]
    support: tuple[Annotated[Support, PlainValidator(table(Support))], ...] = ()
    load: tuple[Load, ...] = ()
    probe: tuple[Annotated[Probe, PlainValidator(table(Probe))], ...] = ()
    run: Run

    @field_validator("body", mode="plain")
    @classmethod
    def _make_bodies(cls, tables: Any, info: ValidationInfo) -> dict[str, Input]:
        """Put the materials in the place of their names, and any where the materials themselves are wrong."""
        if not isinstance(tables, dict):
            raise ValueError("must be a table of bodies, [body.<name>]")
        materials: Mapping[str, Material] | None = info.data.get("material")
        make = table(*SHAPES, key="shape")
        mistakes = Mistakes()
        bodies = {}
        for name, body in tables.items():
            values = body
            if isinstance(body, dict) and "material" in body:
                given = body["material"]
                known = isinstance(given, str) and materials is not None and given in materials
                if materials is not None and not known:
                    mistakes.add((name, "material"), one_of(materials, given), given)
                values = {**body, "material": materials[given] if materials and known else _ANY_MATERIAL}
            with mistakes.gather(name):
                bodies[name] = make(values)
        mistakes.check()
        return bodies


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_bytes().decode())
    except OSError as error:
        problem = f"cannot be read: {error.strerror}"
    except UnicodeDecodeError as error:
        problem = f"is not TOML: not UTF-8 at byte {error.start}"
    except tomllib.TOMLDecodeError as error:
        problem = f"is not TOML: {error}"
    raise InputError(Mistake((str(path),), problem))


@contextmanager
def _scene_paths(material_names: Mapping[str, str]) -> Iterator[None]:
    """Name in an `InputError` the keys of the scene file instead of the arguments in Python."""
    try:
        yield
    except InputError as error:
        raise InputError(*(_in_scene(mistake, material_names) for mistake in error.mistakes)) from None


def _in_scene(mistake: Mistake, material_names: Mapping[str, str]) -> Mistake:
    match mistake.path:
        case ("bodies", name, "material", *rest):
            path = ("material", material_names[str(name)], *rest)
        case (first, *rest) if first in _TABLES:
            path = (_TABLES[str(first)], *rest)
        case _:
            path = ("run", *mistake.path)
    return replace(mistake, path=path)
