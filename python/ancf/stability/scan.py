"""The runs of a map: every method at every step and every value of a stiffness parameter."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any, get_args

import numpy as np

from ancf.errors import InputError, Mistake, Mistakes, one_of, show
from ancf.places import is_number
from ancf.run import Dynamic, Method
from ancf.scene import Scene
from ancf.stability.cells import Cell, classify, explicit_limit
from ancf.sweep import Outcome, Variant, sweep

METHODS = ("verlet", "newmark", "hht", "energy_momentum", "tr_bdf2", "esdirk")
PARTS = (10, 20, 40, 80, 160, 320, 640)
"""Steps in the whole motion."""
FACTORS = {
    "E": (0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5),
    "thickness": (1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4),
    "mesh": (0.25, 0.5, 1.0, 2.0),
}
"""Default values of a stiffness parameter: times that of the scene."""
VISCOSITIES = (0.0, 1e-5, 1e-4, 1e-3, 1e-2)
"""Default values of damping, s."""
_OUTPUTS = 10
_EXACT = {"method": "esdirk", "rtol": 1e-5}


@dataclass(frozen=True)
class Map:
    """What was found.

    Parameters
    ----------
    scene : Scene
        Of which scene.
    parameter : str
        The stiffness parameter.
    cells : list of Cell
        Every run.
    limits : dict of float to float
        For each value of the parameter the longest stable step of explicit methods, 2 / omega_max, s; nan if unknown.
    missing : list of float
        Values for which no run with small steps ended well.
    """

    scene: Scene
    parameter: str
    cells: list[Cell]
    limits: dict[float, float]
    missing: list[float]


def scan(
    scene: Scene,
    log: Path,
    *,
    parameter: str = "E",
    values: Sequence[float] | None = None,
    methods: Sequence[str] | None = None,
    steps: Sequence[float] | None = None,
    limit: float = 60.0,
    executor: Executor | None = None,
    progress: bool = False,
) -> Map:
    """Run a scene in motion with every method, step and value.

    Parameters
    ----------
    scene : Scene
        In motion, with probes.
    log : Path
        Where outcomes are kept; what is there already is not run again.
    parameter : str, default "E"
        A setting of `Variant.of`: E, thickness, mesh (times the divisions), viscosity or mass_damping.
    values : sequence of float, optional
        Its values; by default some powers of ten times that of the scene.
    methods : sequence of str, optional
        Six of them if left out.
    steps : sequence of float, optional
        s; by default the whole motion in 10 to 640 parts.
    limit : float, default 60
        Seconds after which a run is stopped.
    executor, progress
        As in `ancf.sweep.sweep`, whether to show a bar.

    Returns
    -------
    Map
        Every run and how it went.

    Raises
    ------
    InputError
        If the scene does not move or has no probes, the parameter has no values, or a value or method is impossible.
    """
    if not isinstance(scene.run, Dynamic):
        raise InputError(Mistake(("run", "kind"), "must be dynamic: the map is over time steps", show(scene.run.kind)))
    if not scene.model.probes:
        raise InputError(Mistake(("probe",), "is missing: the map shows the errors of probes"))
    until = scene.run.until
    base: dict[str, Any] = {"every": None, "outputs": [until * (k + 1) / _OUTPUTS for k in range(_OUTPUTS)]}
    chosen = list(values) if values else default_values(scene, parameter)
    mistakes = Mistakes()
    for name, numbers in ((parameter, chosen), ("steps", steps or ())):
        for number in numbers:
            if not is_number(number) or not 0 <= number < inf or (name != "viscosity" and number == 0):
                mistakes.add((name,), "must be numbers greater than 0", number)
    for method in methods or ():
        if method not in get_args(Method):
            mistakes.add(("methods",), one_of(get_args(Method), method), method)
    mistakes.check()
    lengths = list(steps) if steps else [until / parts for parts in PARTS]
    grid = [(method, step, value) for value in chosen for method in methods or METHODS for step in lengths]
    runs = {key: Variant.of(scene, **base, method=key[0], step=key[1], **{parameter: key[2]}) for key in grid}
    exact = {value: Variant.of(scene, **base, **_EXACT, **{parameter: value}) for value in chosen}
    probing = {value: Variant.of(scene, **base, method="verlet", step=until, **{parameter: value}) for value in chosen}
    variants = sorted([*runs.values(), *exact.values(), *probing.values()], key=lambda variant: variant.effort)
    label = "runs " if progress else None
    outcomes = sweep(variants, log, limit=limit, executor=executor, progress=label)
    found: dict[str, Outcome] = {
        v.digest: outcome for v, outcome in zip(variants, outcomes, strict=True) if outcome is not None
    }
    references = {value: found[variant.digest] for value, variant in exact.items()}
    cells = [classify(*key, found[variant.digest], references[key[2]]) for key, variant in runs.items()]
    limits = {value: explicit_limit(found[variant.digest]) for value, variant in probing.items()}
    missing = [value for value, outcome in references.items() if outcome.status != "ok"]
    return Map(scene, parameter, cells, limits, missing)


def default_values(scene: Scene, parameter: str) -> list[float]:
    """Return values of a stiffness parameter that show where methods fail.

    Raises
    ------
    InputError
        If there are none for this parameter.
    """
    body = next(iter(scene.model.bodies.values()))
    own = {"E": body.material.E, "thickness": body.thickness, "mesh": 1.0}
    if parameter in own:
        # Rounded, so that tables read well.
        return [float(np.format_float_scientific(own[parameter] * factor, 6)) for factor in FACTORS[parameter]]
    if parameter == "viscosity":
        return list(VISCOSITIES)
    raise InputError(Mistake(("against", parameter), f"give it values, as {parameter}=1,2"))
