"""What varies over time - histories of loads, motions of supports - and what a run sees of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ancf import _core

if TYPE_CHECKING:
    from ancf.model import Model
    from ancf.run import Dynamic

FloatArray: TypeAlias = NDArray[np.float64]

_IMPULSE = 0.05
"""Share of the largest impulse of a load that steps may miss: a sine has it at 8 steps a period."""
_WAY = 0.1
"""Share of the range of a support's motion that the straight way of a step may miss: a sine at 5 steps a period."""
_OVERSHOOT = 0.2
"""Share of the range of its rows by which a curve may leave it: beside a pulse in even rows it does by 0.14."""
_SAMPLES = 16


class CourseWarning(RuntimeWarning):
    """A motion is not given what its tables over time say: a load between two steps, a curve that leaves its rows."""


def course_warnings(model: Model, run: Dynamic) -> tuple[str, ...]:
    """Say which tables over time a motion does not see as they are meant.

    Parameters
    ----------
    model : Model
        Its loads and supports.
    run : Dynamic
        How the motion is found.

    Returns
    -------
    tuple of str
        A line for each load whose impulse up to any time, as the ends of fixed steps see it, is off; for each moved
        support that has been elsewhere within a step; and for each that its smooth curve takes far beyond its rows.
        Steps under error control end where tables bend, and miss nothing.
    """
    return (*_missed_loads(model, run), *_curves(model, run))


def _missed_loads(model: Model, run: Dynamic) -> Iterator[str]:
    if run.step is None:
        return
    for index, load in enumerate(model.loads):
        if isinstance(load.history, str | None):
            continue
        t, missed = _missed_impulse(np.array(load.history), run.step, run.until)
        if len(t) and missed.max() > _IMPULSE:
            first = t[np.flatnonzero(missed > _IMPULSE)[0]]
            yield (
                f"loads.{index}.history: fixed steps see an impulse of this load that is off by {missed.max():.0%} of "
                f"the largest, beyond {_IMPULSE:.0%} at t = {first:.6g} s: the load changes between the steps. "
                "Try: error control (rtol), or a smaller step"
            )


def _missed_impulse(rows: FloatArray, step: float, until: float) -> tuple[FloatArray, FloatArray]:
    """Return the ends of the steps in which a table bends, and what is missed up to there, relative to the largest."""
    t, factor = rows.T
    bends = t[(t > 0) & (t < until)]
    starts, ends = map(np.unique, _steps_around(bends, step, until))

    def value(x: FloatArray) -> FloatArray:
        factors: FloatArray = np.interp(x, t, factor)
        return factors

    # Between bends and zeros the impulse is that of trapezoids and has no extremes.
    grid = np.concatenate(([0.0], bends, [until]))
    left, right = value(grid[:-1]), value(grid[1:])
    turns = left * right < 0
    zeros = grid[:-1][turns] + np.diff(grid)[turns] * left[turns] / (left[turns] - right[turns])
    grid = np.sort(np.concatenate((grid, zeros)))
    sums = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(grid) * (value(grid[:-1]) + value(grid[1:])))))

    def impulse(x: FloatArray) -> FloatArray:
        before = np.searchsorted(grid, x, side="right") - 1
        return sums[before] + 0.5 * (x - grid[before]) * (value(x) + value(grid[before]))

    largest = float(np.abs(sums).max())
    if largest == 0:
        return np.empty(0), np.empty(0)
    seen = 0.5 * (ends - starts) * (value(starts) + value(ends))
    return ends, np.abs(np.cumsum(seen - (impulse(ends) - impulse(starts)))) / largest


def _steps_around(times: FloatArray, step: float, until: float) -> tuple[FloatArray, FloatArray]:
    """Return the starts and the ends of the fixed steps in which times lie."""
    starts = np.floor(times / step) * step
    return starts, np.minimum(starts + step, until)


def _curves(model: Model, run: Dynamic) -> Iterator[str]:
    for index, support in enumerate(model.supports):
        if support.translation:
            rows = np.array(support.translation)
            for column, axis in enumerate("xyz", start=1):
                yield from _curve(f"supports.{index}.translation, {axis}", rows[:, [0, column]], "m", run)
        if support.rotation:
            yield from _curve(f"supports.{index}.rotation.angle", np.array(support.rotation.angle), "rad", run)


def _curve(name: str, rows: FloatArray, unit: str, run: Dynamic) -> Iterator[str]:
    """Say what is doubtful about a smooth curve through rows [t, value]."""
    t, value = rows.T
    lowest, highest = value.min(), value.max()
    size = float(highest - lowest)
    if size == 0:
        return

    def curve(x: FloatArray) -> FloatArray:
        return _core.curve(rows, x)

    shares = np.arange(_SAMPLES) / _SAMPLES
    between = (t[:-1, None] + np.diff(t)[:, None] * shares).ravel()
    between = between[(between >= 0) & (between <= run.until)]
    values = curve(between)
    beyond = np.maximum(values - highest, lowest - values)
    if len(beyond) and beyond.max() > _OVERSHOOT * size:
        worst = between[beyond.argmax()]
        yield (
            f"{name}: the smooth curve through the rows goes to {values[beyond.argmax()]:.3g} {unit} at "
            f"t = {worst:.6g} s, beyond them, which are from {lowest:.3g} to {highest:.3g} {unit}. "
            "Try: more rows where the curve has to stay, and before and after where it bends"
        )
    bends = t[(t > 0) & (t < run.until)]
    if run.step is None or not len(bends):
        return
    start, end = _steps_around(bends, run.step, run.until)
    straight = curve(start) + (bends - start) / (end - start) * (curve(end) - curve(start))
    off = np.abs(curve(bends) - straight)
    if off.max() > _WAY * size:
        yield (
            f"{name}: between fixed steps, at t = {bends[off.argmax()]:.6g} s, the support is {off.max():.3g} {unit} "
            "off the straight way that they see. Try: error control (rtol), or a smaller step"
        )
