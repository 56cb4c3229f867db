"""Cost: seconds per implicit iteration, explicit step and set-up on this machine, measured once and kept in a file."""

from __future__ import annotations

import json
import os
import platform
import time
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ancf import _core
from ancf.bodies import Rectangle
from ancf.loads import Gravity
from ancf.materials import Material
from ancf.model import Model
from ancf.places import EDGES
from ancf.plan.ladder import CONTINUOUS, THIN, Choice, Family, Rung
from ancf.run import Dynamic, Method, Static
from ancf.scene import Scene
from ancf.solve import simulate
from ancf.supports import Support

if TYPE_CHECKING:
    from ancf.plan.pilots import Pilot

_SIDES = (1, 3, 8, 16)
"""Elements along a side of the square plates that are timed."""
_STEPS: dict[Method, int] = {"hht": 6, "verlet": 40}
"""Steps that are timed: explicit ones with their share of the search for the limit of stability, every 20."""
_REPEATS = 5
_MEASURED = "processor"
"""How seconds are measured: what was measured otherwise is not used."""
_ITERATIONS, _STEPS_OF_LOAD = 3.0, 2.0
"""Iterations of an implicit step, and steps to a load factor, of scenes that were not run."""
_FEWEST_SHARED = 64
"""Elements of the smallest plate that is timed on all threads: it and smaller ones are one task of the assembly."""
_GAIN = 0.9
"""Seconds on all threads, relative to one, below which they are used."""


@dataclass(frozen=True)
class Rates:
    """What plates of a family cost on one thread and, the larger ones, on all.

    Parameters
    ----------
    elements : tuple of int
        Of the plates that were timed.
    setup, iteration, force : tuple of float
        Seconds for each: to make the system, of one implicit iteration, of one explicit step.
    iteration_shared, force_shared : tuple of float
        The same on all threads.
    """

    elements: tuple[int, ...]
    setup: tuple[float, ...]
    iteration: tuple[float, ...]
    force: tuple[float, ...]
    iteration_shared: tuple[float, ...]
    force_shared: tuple[float, ...]

    def at(self, what: str, elements: int) -> float:
        """Return the seconds of one `what` for some elements, between and beyond those timed by powers."""
        x, y = np.log(self.elements), np.log(getattr(self, what))
        if elements > self.elements[-1]:
            slope = max((y[-1] - y[-2]) / (x[-1] - x[-2]), 1.0)
            return float(np.exp(y[-1] + slope * (np.log(elements) - x[-1])))
        return float(np.exp(np.interp(np.log(elements), x, y)))


class Costs:
    """Predicts seconds from those of the machine, and better from those of pilots of the same scene.

    Parameters
    ----------
    rates : dict of Family to Rates
        Of the machine.
    threads : int or None
        That runs may use; None for all.
    """

    def __init__(self, rates: dict[Family, Rates], threads: int | None = None) -> None:
        self._rates = rates
        self._threads = threads
        # A plan asks for the same ones again and again.
        self._of = cache(self._of_kind)

    def threads(self, choice: Choice) -> int | None:
        """Return how many threads a choice is run on: 1 unless more are predicted to take clearly less time."""
        kind = "force" if choice.stepping is not None and choice.stepping.explicit else "iteration"
        return self._threads if self._shared(kind, choice.rung.family, choice.rung.elements) else 1

    def ratio(self, rung: Rung, pilot: Pilot) -> float:
        """Return the cost of a rung relative to that of a pilot with the same stepping.

        Implicit steps are as many on any mesh; the explicit limit shrinks with the sides of the elements.
        """
        stepping = pilot.choice.stepping
        old = pilot.choice.rung
        explicit = stepping is not None and stepping.explicit
        kind = "force" if explicit else "iteration"
        ratio = self._of(kind, rung.family, rung.elements) / self._of(kind, old.family, old.elements)
        if explicit:
            finest = [max(max(pair) for pair in r.divisions) for r in (rung, old)]
            ratio *= finest[0] / finest[1]
        return ratio

    def setup(self, rung: Rung) -> float:
        """Return the seconds to make the system of a rung."""
        return self._of("setup", rung.family, rung.elements)

    def predict(self, rung: Rung, pilot: Pilot) -> float:
        """Return the seconds of a rung from a pilot of the same scene with the same stepping."""
        assert pilot.result is not None
        # On a busy machine the set-up may have lasted longer than all of the run took the processor.
        setup = min(float(pilot.result.seconds["setup"]), self.setup(pilot.choice.rung))
        return self.setup(rung) + max(pilot.seconds - setup, 0.0) * self.ratio(rung, pilot)

    def steps(self, rung: Rung, steps: float, *, explicit: bool) -> float:
        """Return about the seconds of some steps, or steps of load; other families cost as those most like them."""
        if rung.family not in self._rates:
            rung = replace(rung, family=THIN[-1] if rung.family.element == THIN[-1].element else CONTINUOUS)
        kind = "force" if explicit else "iteration"
        work = self._of(kind, rung.family, rung.elements) * (1.0 if explicit else _ITERATIONS)
        return self.setup(rung) + steps * work

    def _of_kind(self, kind: str, family: Family, elements: int) -> float:
        shared = kind != "setup" and self._shared(kind, family, elements)
        return self._family(family).at(f"{kind}_shared" if shared else kind, elements)

    def _shared(self, kind: str, family: Family, elements: int) -> bool:
        rates = self._family(family)
        return self._threads != 1 and rates.at(f"{kind}_shared", elements) < _GAIN * rates.at(kind, elements)

    def _family(self, family: Family) -> Rates:
        return self._rates.get(family, self._rates[CONTINUOUS])


def calibrated(folder: Path | None = None, threads: int | None = None) -> Costs:
    """Return the costs of this machine, measured in a few seconds unless a file has them.

    Parameters
    ----------
    folder : Path, optional
        Where the file is kept; that of the user's caches if left out.
    threads : int, optional
        That runs may use; all if left out.

    Returns
    -------
    Costs
        For predictions.
    """
    file = (folder or cache_folder()) / "cost.json"
    key = _machine()
    try:
        kept: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        if kept["machine"] == key:
            return Costs({Family(e, m): Rates(**_tuples(r)) for e, m, r in kept["rates"]}, threads)
    except (OSError, ValueError, KeyError, TypeError):
        pass
    rates = {family: _measure(family) for family in (*THIN, CONTINUOUS)}
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        text = json.dumps({"machine": key, "rates": [[*family, vars(rate)] for family, rate in rates.items()]})
        file.write_text(text, encoding="utf-8")
    except OSError:
        # Without the file they are measured again the next time.
        pass
    return Costs(rates, threads)


def as_written(scene: Scene, costs: Costs) -> float | None:
    """Return about the seconds of a scene as it is written; None where error control sets its steps."""
    bodies = list(scene.model.bodies.values())
    rung = Rung(Family(bodies[0].element, bodies[0].membrane), tuple(body.divisions for body in bodies))
    run = scene.run
    if isinstance(run, Static):
        return costs.steps(rung, _STEPS_OF_LOAD * len(run.load_factors), explicit=False)
    if not isinstance(run, Dynamic) or run.step is None or run.method == "rigid":
        return None
    return costs.steps(rung, run.until / run.step, explicit=run.method in ("verlet", "rk"))


def _tuples(values: dict[str, list[float]]) -> dict[str, Any]:
    return {name: tuple(numbers) for name, numbers in values.items()}


def cache_folder() -> Path:
    """Return where what was measured on this machine is kept."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ancf"


def _machine() -> list[str]:
    return [
        _MEASURED,
        _core.__version__,
        platform.node(),
        platform.processor(),
        str(os.cpu_count()),
        *_core.info().values(),
    ]


def _measure(family: Family) -> Rates:
    """Time short motions of a clamped plate of rubber under its weight."""
    rubber = Material(E=1e6, nu=0.3, density=1000.0)
    seconds: dict[str, list[float]] = {name: [] for name in Rates.__dataclass_fields__ if name != "elements"}
    for n in _SIDES:
        plate = Rectangle(
            size=(0.3, 0.3),
            divisions=(n, n),
            thickness=0.01,
            material=rubber,
            element=family.element,  # type: ignore[arg-type]
            membrane=family.membrane,  # type: ignore[arg-type]
        )
        model = Model(
            bodies={"plate": plate},
            supports=[Support(at=EDGES[0], clamp=True)],
            loads=[Gravity(acceleration=(0.0, 0.0, -9.81))],
        )
        for threads, name in ((1, ""), (None, "_shared")):
            if threads is None and n * n < _FEWEST_SHARED:
                seconds["iteration_shared"].append(seconds["iteration"][-1])
                seconds["force_shared"].append(seconds["force"][-1])
                continue
            (setup, implicit, counts), (_, explicit, steps) = (_motion(model, method, threads) for method in _STEPS)
            if threads == 1:
                seconds["setup"].append(setup)
            seconds[f"iteration{name}"].append(implicit / max(counts["iterations"], 1))
            seconds[f"force{name}"].append(explicit / steps["steps"])
    return Rates(tuple(n * n for n in _SIDES), **_tuples(seconds))


def _motion(model: Model, method: Method, threads: int | None) -> tuple[float, float, dict[str, int]]:
    """Return the least seconds of set-up and work of several short motions, and what was counted."""
    until = 1e-5
    # On one thread the processor's time is what a motion costs, whatever else the machine does.
    clock = time.process_time if threads == 1 else time.perf_counter
    setups, totals = [], []
    for _ in range(_REPEATS):
        start = clock()
        result = simulate(model, until=until, step=until / _STEPS[method], every=until, method=method, threads=threads)
        totals.append(clock() - start)
        setups.append(result.seconds["setup"])
    return min(setups), max(min(totals) - min(setups), 1e-7), result.counts
