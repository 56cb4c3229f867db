"""A model of the errors of rungs that were not run: a power of the elements along each side, fitted to pilots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ancf.plan.ladder import Rung

At = tuple[int, int]


@dataclass(frozen=True)
class Guess:
    """Errors of a family.

    Parameters
    ----------
    rates, weights : mapping of (int, int) to float
        For body and axis: the error along it is the weight times the elements to the power of minus the rate.
    """

    rates: Mapping[At, float]
    weights: Mapping[At, float]

    def __call__(self, rung: Rung) -> float:
        """Return the error of a rung, relative."""
        return sum(weight * _power(rung, at, self.rates) for at, weight in self.weights.items())


def fit(known: Sequence[tuple[Rung, float]], sides: Sequence[At], rates: Mapping[At, float]) -> Guess:
    """Return what fits relative errors of rungs of a family best, with weights that are not negative."""
    rows = []
    for rung, error in known:
        # Fine rungs tell more of fine ones.
        weight = rung.elements**0.5
        rows.append([*(_power(rung, at, rates) / error * weight for at in sides), weight])
    matrix = np.array(rows)
    weights = np.zeros(len(sides))
    used = np.full(len(sides), True)
    # Those that would be negative are left out.
    while used.any():
        weights[:] = 0.0
        weights[used] = np.linalg.lstsq(matrix[:, :-1][:, used], matrix[:, -1], rcond=1e-9)[0]
        if (weights >= 0.0).all():
            break
        used &= weights > 0.0
    return Guess(rates, dict(zip(sides, weights.tolist(), strict=True)))


def _power(rung: Rung, at: At, rates: Mapping[At, float]) -> float:
    body, axis = at
    return float(float(rung.divisions[body][axis]) ** -rates.get(at, 2.0))
