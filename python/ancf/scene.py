"""Scene files: in TOML what can be said in Python, in the same words."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import tomli_w
from pydantic import PlainValidator, ValidationInfo, field_validator

from ancf.bodies import SHAPES, Plate
from ancf.errors import InputError, Mistake, Mistakes, one_of
from ancf.find_modes import find_modes
from ancf.inputs import Input, table
from ancf.loads import Load
from ancf.materials import Material
from ancf.modal import AnyResult, ModalResult
from ancf.model import Model
from ancf.output import replacing
from ancf.probes import Probe
from ancf.progress import Progress
from ancf.result import Result
from ancf.run import Dynamic, Modes, Run, Static
from ancf.solve import solve
from ancf.supports import Support

_TABLES = {"bodies": "body", "supports": "support", "loads": "load", "probes": "probe"}
_RUN_KEYS = {*Static.model_fields, *Dynamic.model_fields, *Modes.model_fields}
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
    run : Static, Dynamic or Modes
        How to run it.
    material_names : mapping of str to str, optional
        What the material of each body is called; like the body if left out.

    Raises
    ------
    InputError
        If a name is that of two materials, or of the material of a body that does not exist.
    """

    title: str
    model: Model
    run: Static | Dynamic | Modes
    material_names: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        bodies = self.model.bodies
        mistakes = Mistakes()
        for body in self.material_names:
            if body not in bodies:
                mistakes.add(("material_names",), one_of(bodies, body), body)
        names = {body: self.material_names.get(body, body) for body in bodies}
        materials: dict[str, Material] = {}
        for body, name in names.items():
            if materials.setdefault(name, bodies[body].material) != bodies[body].material:
                mistakes.add(("material_names", body), "is the name of another material", name)
        mistakes.check()
        object.__setattr__(self, "material_names", names)

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> Scene:
        """Make a scene of the tables of a scene file.

        Parameters
        ----------
        document : mapping
            Tables and values, as `tomllib` reads them.

        Returns
        -------
        Scene
            Ready to be run.

        Raises
        ------
        InputError
            If there are mistakes in it.
        """
        scene = _File(**document)
        material_names = {name: body["material"] for name, body in document["body"].items()}
        with _scene_paths(material_names):
            model = Model(bodies=scene.body, supports=scene.support, loads=scene.load, probes=scene.probe)
            scene.run.check(model)
        return cls(scene.title, model, scene.run, material_names)

    def document(self) -> dict[str, Any]:
        """Return the tables of the scene file that makes the same scene.

        Returns
        -------
        dict
            Of plain Python values; `Scene.of` takes it.

        Raises
        ------
        InputError
            If a body is a `Surface`: a scene file cannot hold a function.
        """
        bodies, materials = {}, {}
        mistakes = Mistakes()
        for name, body in self.model.bodies.items():
            material = self.material_names[name]
            materials[material] = body.material.document()
            with mistakes.gather("body", name):
                bodies[name] = body.document() | {"material": material}
        mistakes.check()
        items = {"support": self.model.supports, "load": self.model.loads, "probe": self.model.probes}
        lists = {key: [item.document() for item in values] for key, values in items.items() if values}
        return {"title": self.title, "material": materials, "body": bodies, **lists, "run": self.run.document()}

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the scene as a file that `load_scene` and ``ancf run`` take; an earlier file is replaced in one go.

        Parameters
        ----------
        path : str or path
            The TOML file.

        Raises
        ------
        InputError
            If a body is a `Surface`: a scene file cannot hold a function.
        OSError
            If the file cannot be written.
        """
        text = tomli_w.dumps(self.document())
        with replacing(Path(path)) as (file,):
            file.write_text(text, encoding="utf-8")

    def solve(
        self,
        *,
        checkpoint: str | os.PathLike[str] | None = None,
        resume: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        progress: Progress = None,
        throw: bool = True,
    ) -> Result:
        """Run a scene of statics or motion; one of the kind "modes" has `modes`.

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
        if isinstance(self.run, Modes):
            raise InputError(Mistake(("run", "kind"), "is found by Scene.modes, not by Scene.solve", "modes"))
        start = None
        if isinstance(self.run, Dynamic):
            start = partial(self.run.start, checkpoint=checkpoint, resume=resume)
        else:
            _check_no_checkpoint(checkpoint, resume)
        with _scene_paths({}):
            return solve(self.model, self.run, threads=threads, progress=progress, throw=throw, start=start)

    def modes(self, *, threads: int | None = None, progress: Progress = None, throw: bool = True) -> ModalResult:
        """Find the modes of a scene of the kind "modes".

        Parameters
        ----------
        threads, progress, throw : optional
            As in `ancf.modes`.

        Returns
        -------
        ModalResult
            Frequencies and shapes.

        Raises
        ------
        InputError
            If the model cannot be run in this way.
        SolveError
            If the run fails; `SolveError.result` holds what it had.
        Interrupted
            On Ctrl-C; `Interrupted.result` holds what it had.
        """
        if not isinstance(self.run, Modes):
            raise InputError(Mistake(("run", "kind"), "is run by Scene.solve, not by Scene.modes", self.run.kind))
        with _scene_paths({}):
            return find_modes(self.model, self.run, threads=threads, progress=progress, throw=throw)


def run_scene(
    scene: Scene,
    *,
    checkpoint: str | os.PathLike[str] | None = None,
    resume: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    throw: bool = True,
) -> AnyResult:
    """Run a scene of whatever kind, for what does not know which: see `Scene.solve` and `Scene.modes`."""
    if isinstance(scene.run, Modes):
        _check_no_checkpoint(checkpoint, resume)
        return scene.modes(threads=threads, progress=progress, throw=throw)
    return scene.solve(checkpoint=checkpoint, resume=resume, threads=threads, progress=progress, throw=throw)


def _check_no_checkpoint(checkpoint: str | os.PathLike[str] | None, resume: str | os.PathLike[str] | None) -> None:
    if checkpoint is not None or resume is not None:
        raise InputError(Mistake(("checkpoint" if resume is None else "resume",), "is for motion only"))


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
    return Scene.of(_read(Path(path)))


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
        # Some editors put a byte order mark first.
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
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
        case (first, *_) if first in _RUN_KEYS:
            path = ("run", *mistake.path)
        case _:
            path = mistake.path
    return replace(mistake, path=path)
