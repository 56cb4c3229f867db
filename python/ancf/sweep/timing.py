"""Timings that can be compared: each run alone on the machine, in random order, repeated."""

from __future__ import annotations

import os
import random
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import median

from ancf.sweep.engine import sweep
from ancf.sweep.executors import local_executor
from ancf.sweep.variant import Variant


@dataclass(frozen=True)
class Timing:
    """The time of one run.

    Parameters
    ----------
    seconds : tuple of float
        Wall time of each repetition, s: set-up and results included, the start of the process not.
    processor : tuple of float
        Processor time of each, s: nearly the same on one thread, and less disturbed by what else the machine does.
    """

    seconds: tuple[float, ...]
    processor: tuple[float, ...]

    @property
    def best(self) -> float:
        """The shortest, s; what else the machine does can only add to it."""
        return min(self.seconds)

    @property
    def median(self) -> float:
        """The median, s."""
        return median(self.seconds)


def time_alone(
    variants: Sequence[Variant],
    log: str | os.PathLike[str],
    *,
    repeats: int = 3,
    limit: float | None = None,
    budget: float | None = None,
    threads: int = 1,
    progress: str | None = None,
) -> list[Timing | None]:
    """Run variants one at a time, all of them in random order, then all of them again.

    Parameters
    ----------
    variants, log, limit, threads, progress
        As for `sweep`.
    repeats : int, default 3
        How often each is run.
    budget : float, optional
        Seconds after which no further run is started; but each is run at least once.

    Returns
    -------
    list of Timing or None
        In the order of `variants`; None where the run did not end well.
    """
    # Always the same order, so that a killed sweep goes on.
    order = random.Random(0)
    end = None if budget is None else time.monotonic() + budget
    times: list[list[tuple[float, float]]] = [[] for _ in variants]
    for repeat in range(1, repeats + 1):
        left = None if end is None or repeat == 1 else end - time.monotonic()
        if left is not None and left <= 0:
            break
        indices = list(range(len(variants)))
        order.shuffle(indices)
        turn = [replace(variants[index], repeat=repeat) for index in indices]
        with local_executor(jobs=1) as executor:
            outcomes = sweep(turn, log, limit=limit, budget=left, executor=executor, threads=threads, progress=progress)
        for index, outcome in zip(indices, outcomes, strict=True):
            if outcome is not None and outcome.status == "ok":
                times[index].append((outcome.seconds["total"], outcome.seconds["processor"]))
    return [Timing(*map(tuple, zip(*pairs, strict=True))) if pairs else None for pairs in times]
