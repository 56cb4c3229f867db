"""Errors: differences of rungs relative to the change of what is wanted, rates, and what they promise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Values = Sequence[FloatArray]

RATES = (0.5, 2.0)
"""Rates of convergence are taken to lie here: a lower one is no convergence, a higher one may be an accident."""
UNKNOWN_RATE = 1.0
_SLOWEST, _FASTEST, _SUDDEN = 1.0, 3.0, 5.0
"""Rates of steady convergence, and the one beyond which differences are small by accident."""
SAFETY = 1.2


def scales(values: Values) -> list[float]:
    """Return for each wanted quantity its largest change from the first state: what errors are relative to."""
    return [float(np.linalg.norm(value - value[0], axis=1).max()) for value in values]


def distance(one: Values, other: Values, scale: Sequence[float]) -> float:
    """Return the largest difference over all states and quantities, relative to their scales.

    Infinite where a quantity that has no scale, because it does not change, differs.
    """
    worst = 0.0
    for a, b, size in zip(one, other, scale, strict=True):
        off = float(np.linalg.norm(a - b, axis=1).max())
        if off > 0.0:
            worst = max(worst, off / size if size > 0.0 else np.inf)
    return worst


@dataclass(frozen=True)
class Side:
    """What is known of the error along one side of the mesh.

    Parameters
    ----------
    difference : float
        Of the rung and the one with half the elements along the side, relative.
    rate : float or None
        Observed, from the difference before; None if it is not known.
    """

    difference: float
    rate: float | None

    def rate_to(self, after: float) -> float | None:
        """Return the rate with which the difference shrinks to the next one; None if that cannot be told.

        What is small by accident is left out: then the rate is the mean of two refinements.
        """
        if not 0 < self.difference < np.inf or not 0 < after < np.inf:
            return None
        rate = float(np.log2(self.difference / after))
        return rate if self.rate is None or not self.sudden else 0.5 * (self.rate + rate)

    @property
    def sudden(self) -> bool:
        """Whether the difference shrank too fast to be believed."""
        return self.rate is not None and self.rate > _SUDDEN

    @property
    def steady(self) -> bool:
        """Whether the difference shrank as it does where elements converge, as far as is known."""
        return self.rate is None or _SLOWEST <= self.rate <= _FASTEST

    @property
    def error(self) -> float:
        """What is left along the side, relative, with safety."""
        low, high = RATES
        rate = UNKNOWN_RATE if self.rate is None else min(max(self.rate, low), high)
        return float(SAFETY * self.difference / (2.0**rate - 1.0))
