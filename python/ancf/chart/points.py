"""The points of a chart, its front and its winners."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ancf.chart.labels import Label
from ancf.records import Record
from ancf.sweep import Timing

LEVELS = (0.1, 0.01, 0.001)


@dataclass(frozen=True)
class Point:
    """A run that ended well.

    Parameters
    ----------
    label : Label
        What it is called.
    scene : mapping
        Its document; empty if another program made it.
    own : bool
        Whether it is the scene as it was given.
    timing : Timing
        Its wall time.
    counts : dict of str to int
        As in `Result`; of another program's run only `elements`.
    error : float
        Against the reference, relative to the size of the motion.
    space, time : float
        The parts of the error: of the same element and mesh with the tightest tolerance, and what is added by the
        method and its step; nan where that run did not end well.
    """

    label: Label
    scene: Mapping[str, Any]
    own: bool
    timing: Timing
    counts: dict[str, int]
    error: float
    space: float
    time: float

    @property
    def elements(self) -> int:
        """How many elements."""
        return self.counts["elements"]


@dataclass(frozen=True)
class Rival:
    """A run of the same scene by another program.

    Parameters
    ----------
    label : Label
        What it is called.
    elements : int
        How many elements.
    timing : Timing
        Its wall time.
    probes : mapping of str to Record
        The scene's probes at the outputs of the chart.
    """

    label: Label
    elements: int
    timing: Timing
    probes: Mapping[str, Record]


@dataclass(frozen=True)
class Lost:
    """A run that has no point.

    Parameters
    ----------
    label : Label
        What it is called.
    status : str
        How it ended, or "omitted".
    reason : str
        Why.
    """

    label: Label
    status: str
    reason: str


@dataclass(frozen=True)
class Winner:
    """The fastest run within an error.

    Parameters
    ----------
    level : float
        The error allowed, relative to the size of the motion.
    point : Point or None
        The run; None if none is so accurate.
    remark : str
        What to know about it.
    """

    level: float
    point: Point | None
    remark: str


def front(points: Sequence[Point]) -> list[Point]:
    """Return the points of which none is both faster and more accurate, the fastest first."""
    best = math.inf
    found = []
    for point in sorted(points, key=lambda point: (point.timing.best, point.error)):
        if point.error < best:
            best = point.error
            found.append(point)
    return found


def winners(points: Sequence[Point], trust: float) -> list[Winner]:
    """Return the fastest run for each of 10 %, 1 % and 0.1 %.

    Parameters
    ----------
    points : sequence of Point
        All runs that ended well.
    trust : float
        How far the reference is known.
    """
    return [_winner(level, points, trust) for level in LEVELS]


def _winner(level: float, points: Sequence[Point], trust: float) -> Winner:
    within = [point for point in points if point.error <= level]
    if not within:
        nearest = min((point.error for point in points), default=math.nan)
        return Winner(level, None, f"no run is so accurate; the best comes to {percent(nearest)}")
    point = min(within, key=lambda point: point.timing.best)
    if trust > level:
        return Winner(level, point, f"against the reference, which is itself known to {percent(trust)} only")
    unsure = math.isnan(trust) or point.error + trust > level
    return Winner(level, point, "the reference is not known well enough to be sure" if unsure else "")


def percent(value: float) -> str:
    """Write a ratio in percent, to two digits."""
    return "unknown" if math.isnan(value) else f"{100 * value:.2g} %"
