"""The runs of the study, and where their outcomes are found."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ancf.reproduce.dufva_shabana.paper import MESHES, PENDULUM_MESHES, THICKNESSES, cantilever, pendulum
from ancf.reproduce.dufva_shabana.velocities import Steps, integrate
from ancf.scene import Scene
from ancf.sweep import Outcome, Timing, Variant, sweep, time_alone

MODELS: dict[str, Mapping[str, Any]] = {
    "Model I, thin36": {"element": "thin36", "membrane": "full"},
    "Model II, full48a": {"element": "full48a"},
    "thin48": {"element": "thin48", "membrane": "full"},
    "full48b": {"element": "full48b"},
}
"""The elements of the paper, and two more; `full` is the paper's integration of the membrane."""
THIN, SOLID = "Model I, thin36", "Model II, full48a"
BEST_STATIC = "best, thin36 lobatto"
BEST_MOTION = "best, thin36 lobatto, verlet"
EXPLICIT = "explicit"

Key = tuple[str, str, float]
"""Example ("cantilever", "mesh", "thickness" or "explicit"), model, and its mesh or thickness."""


@dataclass(frozen=True)
class Runs:
    """What was run.

    Parameters
    ----------
    outcomes : mapping of Key to Outcome
        How each run ended.
    timings : mapping of Key to Timing
        Of those in motion that ended well.
    repeats : int
        How often each was timed.
    limit : float
        Seconds after which a run was stopped.
    """

    outcomes: Mapping[Key, Outcome]
    timings: Mapping[Key, Timing]
    repeats: int
    limit: float

    def seconds(self, key: Key) -> float | None:
        """Return the shortest processor time of a run, s; None if it did not end well."""
        timing = self.timings.get(key)
        return None if timing is None else min(timing.processor)


def plan(quick: bool) -> dict[Key, Variant]:
    """Return all runs; with `quick` only coarse meshes."""
    most, most_pendulum = (4, 2) if quick else (max(MESHES), max(PENDULUM_MESHES))
    plate, motion = cantilever(), pendulum()
    runs: dict[Key, Variant] = {}
    for number in (n for n in MESHES if n <= most):
        static = {**MODELS, BEST_STATIC: {"element": "thin36", "membrane": "lobatto"}}
        for name, model in static.items():
            runs["cantilever", name, number] = Variant.of(plate, **model, divisions=[number, 1])
    best = {"element": "thin36", "membrane": "lobatto", "method": "verlet", "rtol": 1e-3}
    moving = {**MODELS, BEST_MOTION: best}
    for number in (n for n in PENDULUM_MESHES if n <= most_pendulum):
        for name, model in moving.items():
            runs["mesh", name, number] = Variant.of(motion, **model, divisions=[number, number])
    for thickness in THICKNESSES:
        for name, model in moving.items():
            runs["thickness", name, thickness] = Variant.of(motion, **model, divisions=[2, 2], thickness=thickness)
        for name in (THIN, SOLID):
            runs[EXPLICIT, name, thickness] = Variant.of(
                motion, **MODELS[name], divisions=[2, 2], thickness=thickness, method="rk", rtol=1e-3
            )
    return runs


def run(folder: Path, *, quick: bool, repeats: int, limit: float, executor: Executor | None, progress: bool) -> Runs:
    """Run everything, and what moves again, alone, for its time."""
    runs = plan(quick)
    log = folder / "runs.jsonl"
    found = sweep(list(runs.values()), log, limit=limit, executor=executor, progress="values " if progress else None)
    outcomes = {key: outcome for key, outcome in zip(runs, found, strict=True) if outcome is not None}
    moving = [key for key, outcome in outcomes.items() if outcome.status == "ok" and key[0] != "cantilever"]
    timings = time_alone(
        [runs[key] for key in moving], log, repeats=repeats, limit=limit, progress="times " if progress else None
    )
    timed = {key: timing for key, timing in zip(moving, timings, strict=True) if timing is not None}
    return Runs(outcomes, timed, repeats, limit)


def run_velocities(quick: bool) -> dict[tuple[float, str, float], Steps]:
    """Run the plates of Table 2 once more, with all coordinates and velocities under error control.

    Returns
    -------
    dict of (float, str, float) to Steps
        For each tolerance, model and thickness.
    """
    found = {}
    for rtol in (1e-3,) if quick else (1e-3, 1e-4, 1e-5):
        for name in (THIN, SOLID):
            for thickness in THICKNESSES:
                variant = Variant.of(pendulum(), **MODELS[name], divisions=[2, 2], thickness=thickness)
                core = Scene.of(variant.scene).model.assemble("constant")
                found[rtol, name, thickness] = integrate(core, 0.3, rtol)
    return found
