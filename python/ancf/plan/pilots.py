"""Pilots: runs of single rungs, each made once, with a limit of time."""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ancf.balance import FROM_NOWHERE, EnergyWarning
from ancf.courses import CourseWarning
from ancf.errors import InputError, Interrupted
from ancf.plan.cost import Costs
from ancf.plan.ladder import Choice, apply
from ancf.result import Result
from ancf.run import Modes
from ancf.scene import Scene
from ancf.solve import solve

FloatArray = NDArray[np.float64]

SLOW = "slower than others"
"""Outcome of a pilot that has used up its time, so that it may be run again."""


@dataclass(frozen=True)
class Pilot:
    """A run of a choice.

    Parameters
    ----------
    choice : Choice
        What was run.
    result : Result or None
        What it left, if it reached its end.
    values : list of ndarray, each of shape (states, components)
        The wanted quantities; empty if it did not reach its end.
    seconds : float
        What it took.
    outcome : str
        "ok", or why it did not reach its end.
    """

    choice: Choice
    result: Result | None = field(repr=False)
    values: list[FloatArray] = field(repr=False)
    seconds: float
    outcome: str

    @property
    def ok(self) -> bool:
        """Whether it reached its end."""
        return self.result is not None


class _TooSlowError(Exception):
    """A pilot has used up its time."""


class Pilots:
    """Runs choices of a scene and remembers them.

    Parameters
    ----------
    scene : Scene
        What is planned.
    want : list of str
        Names of the probes that matter.
    budget : float
        Seconds that all pilots together may take.
    threads : int or None
        That runs may use; None for all.
    costs : Costs, optional
        Tells which runs more threads help; all if left out.
    """

    def __init__(
        self, scene: Scene, want: list[str], budget: float, threads: int | None, costs: Costs | None = None
    ) -> None:
        self.scene = scene
        self.want = want
        self.threads = threads
        self._costs = costs
        # On one thread the processor's time is what pilots cost, whatever else the machine does.
        self._clock = time.process_time if threads == 1 else time.perf_counter
        self._started = self._clock()
        self._budget = budget
        self._done: dict[Choice, Pilot] = {}
        self.runs = 0
        self.interrupted = False

    @property
    def spent(self) -> float:
        """Seconds since the beginning."""
        return self._clock() - self._started

    @property
    def left(self) -> float:
        """Seconds of the budget that are left; none once the plan has been interrupted."""
        return 0.0 if self.interrupted else self._budget - self.spent

    @property
    def done(self) -> list[Pilot]:
        """All pilots so far, in their order."""
        return list(self._done.values())

    def tried(self, choice: Choice) -> bool:
        """Tell whether a choice was run, to its end or not."""
        return choice in self._done

    def known(self, choice: Choice) -> Pilot | None:
        """Return the pilot of a choice if it was run to its end."""
        pilot = self._done.get(choice)
        return pilot if pilot is not None and pilot.ok else None

    def run(self, choice: Choice, limit: float = np.inf) -> Pilot:
        """Run a choice, or return what is remembered of it.

        Parameters
        ----------
        choice : Choice
            What to run.
        limit : float, optional
            Seconds after which to give up.

        Returns
        -------
        Pilot
            How it went.

        Raises
        ------
        KeyboardInterrupt
            On Ctrl-C; what it had is not kept.
        """
        if choice in self._done and (self._done[choice].ok or self._done[choice].outcome != SLOW):
            return self._done[choice]
        self.runs += 1
        pilot = self._run(choice, limit if self.left > 0.0 else 0.0)
        self._done[choice] = pilot
        return pilot

    def again(self, pilot: Pilot) -> None:
        """Repeat a run and keep the shorter time: the first one also fills the caches of the processor."""
        repeated = self._run(pilot.choice, np.inf)
        if repeated.ok and repeated.seconds < pilot.seconds:
            self._done[pilot.choice] = repeated

    def _run(self, choice: Choice, limit: float) -> Pilot:
        threads = self._costs.threads(choice) if self._costs else self.threads
        # On one thread the processor's time is what the run costs, whatever else the machine does.
        clock = time.process_time if threads == 1 else time.perf_counter
        start = clock()

        def watch(_: float) -> None:
            if clock() - start > limit or self.left <= 0.0:
                raise _TooSlowError

        def failed(outcome: str) -> Pilot:
            return Pilot(choice, None, [], clock() - start, outcome)

        if limit <= 0:
            return failed(SLOW)
        try:
            scene = apply(self.scene, choice)
            start = clock()
            assert not isinstance(scene.run, Modes)
            # What is tried may be wrong; what is chosen tells its warnings in its result.
            with warnings.catch_warnings():
                for told in (EnergyWarning, CourseWarning):
                    warnings.simplefilter("ignore", told)
                result = solve(scene.model, scene.run, threads=threads, progress=watch, throw=False)
        except _TooSlowError:
            return failed(SLOW)
        except InputError as error:
            return failed(str(error))
        except Interrupted as stopped:
            raise KeyboardInterrupt from stopped
        seconds = clock() - start
        if result.status != "ok":
            return failed(result.reason)
        if any(FROM_NOWHERE in warning for warning in result.warnings):
            return failed(FROM_NOWHERE)
        return Pilot(choice, result, [result.probes[name].value for name in self.want], seconds, "ok")
