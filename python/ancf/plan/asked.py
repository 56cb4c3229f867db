"""What is asked of a plan: the scene, the wanted probes, and whether they can be planned."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from ancf.errors import InputError, Mistake, Mistakes, one_of, show
from ancf.model import Model
from ancf.plan.errors import Values, scales
from ancf.result import Result
from ancf.run import Dynamic, Static
from ancf.scene import Scene, load_scene

_ROUNDING = 1e-12
"""Relative changes of nodal coordinates below it are none."""


def scene_of(given: Scene | Model | str | os.PathLike[str], run: Static | Dynamic | None) -> Scene:
    """Return the scene that is meant; raise `InputError` if it lacks a run or has two."""
    if isinstance(given, Model):
        if run is None:
            raise InputError(Mistake(("run",), "is missing: Static(...) or Dynamic(...)"))
        run.check(given)
        return Scene("", given, run)
    if run is not None:
        raise InputError(Mistake(("run",), "is for models; a scene has its own", show(type(run).__name__)))
    return given if isinstance(given, Scene) else load_scene(given)


def wanted(scene: Scene, want: str | Sequence[str] | None) -> list[str]:
    """Return the names of the wanted probes; raise `InputError` if there are no such ones."""
    known = [probe.name for probe in scene.model.probes]
    if not known:
        raise InputError(Mistake(("want",), "the scene has no probes: nothing can be wanted of it"))
    names = known if want is None else [want] if isinstance(want, str) else list(want)
    mistakes = Mistakes()
    for name in names or [""]:
        if name not in known:
            mistakes.add(("want",), one_of(known, name), name)
    mistakes.check()
    return names


def check(scene: Scene, tol: float, budget: float | None) -> None:
    """Raise `InputError` if a number is impossible or the run is none that can be planned."""
    mistakes = Mistakes()
    limits = [("tol", tol, 1e-6, 1.0)]
    if budget is not None:
        limits.append(("budget", budget, 0.0, np.inf))
    for name, value, low, high in limits:
        number = isinstance(value, (int, float)) and not isinstance(value, bool) and np.isfinite(value)
        if not number or not low <= value < high or value <= 0:
            allowed = "a number from 1e-6 to below 1" if name == "tol" else "a number of seconds greater than 0"
            mistakes.add((name,), f"allowed is {allowed}", value)
    if not isinstance(scene.run, (Static, Dynamic)):
        mistakes.add(("run", "kind"), "statics and motion can be planned", scene.run.kind)
    if isinstance(scene.run, Static) and scene.run.path == "arc":
        mistakes.add(
            ("run", "path"), 'can be planned only for "load": steps along an arc differ from mesh to mesh', "arc"
        )
    mistakes.check()


def still(result: Result) -> bool:
    """Tell whether nothing moves but by rounding."""
    return bool(np.abs(result.q - result.q[0]).max() <= _ROUNDING * np.abs(result.q[0]).max())


def changes(values: Values, names: list[str], result: Result | None = None) -> list[float]:
    """Return the largest changes of what is wanted; raise `InputError` if there is none or `result` is still."""
    scale = [0.0] * len(names) if result is not None and still(result) else scales(values)
    mistakes = Mistakes()
    for name, size in zip(names, scale, strict=True):
        if size == 0.0:
            mistakes.add(("want",), "does not change, so that no error is relative to it", name)
    mistakes.check()
    return scale
