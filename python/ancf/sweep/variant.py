"""Variants: a scene with some of its settings replaced."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from math import inf
from typing import Any

from ancf import _core
from ancf.bodies import Rectangle
from ancf.errors import InputError, Mistake, show
from ancf.materials import Material
from ancf.places import is_number
from ancf.run import Dynamic, Modes, Static
from ancf.scene import Scene

OF_BODIES = ("element", "membrane", "curvature", "thickness", "divisions")
"""Settings of bodies."""
_OF_MATERIALS = tuple(Material.model_fields)
_DEFAULTS = {
    **{
        name: field.default
        for cls in (Rectangle, Material, Static, Dynamic)
        for name, field in cls.model_fields.items()
    },
    "membrane": "projected",
    "curvature": "paper",
}
_EXCLUDED = {
    "step": ("rtol", "atol", "first_step", "max_step", "min_step"),
    "rtol": ("step", "force"),
    "method": ("alpha", "rho_inf", "lumped"),
}
"""Keys of [run] that lose their meaning when another is replaced."""
_EXPLICIT = {"verlet": 0.1, "rk": 0.3}
"""What the steps of explicit methods, though more, cost of those of implicit ones."""


@dataclass(frozen=True)
class Variant:
    """A scene as it is run in a sweep, and what tells it from its siblings.

    Parameters
    ----------
    scene : mapping
        The document of the scene, see `Scene.document`. It is checked when it is run: what is impossible becomes an
        outcome with the status "refused".
    settings : mapping
        What was replaced, for tables and pictures.
    repeat : int, default 0
        Tells repetitions of the same run apart.
    """

    scene: Mapping[str, Any] = field(repr=False)
    settings: Mapping[str, Any]
    repeat: int = 0

    @classmethod
    def of(cls, scene: Scene, **settings: Any) -> Variant:
        """Replace some settings of a scene.

        Parameters
        ----------
        scene : Scene
            What to vary; without a `Surface`, which no document can hold.
        **settings
            `element`, `membrane`, `curvature`, `thickness` and `divisions` are those of every body, `mesh` multiplies
            the divisions of every body; `E`, `nu`, `density`, `mass_damping` and `viscosity` are those of every
            material; all others are those of the run. None takes the default. Settings that no longer fit are left out:
            `rtol` if `step` is replaced and the reverse, parameters of the earlier method, the membrane of a solid
            element.

        Returns
        -------
        Variant
            The scene and what was replaced.

        Raises
        ------
        InputError
            If a body is a `Surface`, the scene is run for its modes, or `mesh` is not a number greater than 0.
        """
        if isinstance(scene.run, Modes):
            raise InputError(Mistake(("run", "kind"), "must be static or dynamic to be compared", show("modes")))
        document = deepcopy(scene.document())
        for name, value in settings.items():
            if name == "mesh":
                if not is_number(value) or not 0 < value < inf:
                    raise InputError(Mistake(("mesh",), "must be a number greater than 0", show(value)))
                for body in document["body"].values():
                    body["divisions"] = [max(1, round(value * number)) for number in body["divisions"]]
            elif name in OF_BODIES:
                _replace(document["body"].values(), name, value)
            elif name in _OF_MATERIALS:
                _replace(document["material"].values(), name, value)
            else:
                for other in _EXCLUDED.get(name, ()):
                    if other not in settings:
                        document["run"].pop(other, None)
                _replace([document["run"]], name, value)
        if str(settings.get("element", "")).startswith("full48"):
            for name in {"membrane", "curvature"} - settings.keys():
                _replace(document["body"].values(), name, None)
        return cls(document, settings)

    @property
    def digest(self) -> str:
        """What the outcome is filed under: a fingerprint of the scene, the repetition and the version of `ancf`."""
        scene = {key: value for key, value in self.scene.items() if key != "title"}
        text = json.dumps([_core.__version__, self.repeat, scene], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def effort(self) -> float:
        """A rough measure of the time that the run takes, for the time to go: elements times implicit steps."""
        try:
            return self._effort()
        except (ArithmeticError, TypeError):
            # It is refused when it is run, at once.
            return 0.0

    def _effort(self) -> float:
        run = self.scene["run"]
        elements = sum(body["divisions"][0] * body["divisions"][1] for body in self.scene["body"].values())
        weight = _EXPLICIT.get(run.get("method", ""), 1.0) * elements
        if "step" in run:
            return float(weight * run["until"] / run["step"])
        # Methods with error control are of order 2 and above.
        return float(weight * 10 * run.get("rtol", 1e-3) ** (-1 / 3))


def _replace(tables: Any, name: str, value: Any) -> None:
    """Set a value in tables; what is as by default is left out, as in documents, so that equal scenes are equal."""
    for table in tables:
        if value is None or _DEFAULTS.get(name) == value:
            table.pop(name, None)
        else:
            table[name] = list(value) if isinstance(value, tuple) else value
