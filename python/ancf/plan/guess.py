"""A model of the errors of rungs that were not run: a power of the elements along each side, fitted to pilots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ancf.plan.ladder import Rung

_RATES = np.array((0.5, 1.0, 1.5, 2.0, 2.5, 3.0))
"""Rates along x and y that are considered."""
_PARTS = 1.0 / (1.0 + np.exp(np.linspace(-7.0, 7.0, 15)))
"""And parts of the error of a single element that lie along x."""
_OFF, _RATE_OFF, _PART_OFF = 0.3, 0.7, 2.0
"""How far logarithms of errors are off a power, and how far from what is expected rates and (as log-odds) parts lie."""


class Prior(NamedTuple):
    """Rates along x and y, and the part along x of a single element's error, that are expected before any pilot."""

    rate_x: float = 2.0
    rate_y: float = 2.0
    part: float = 0.5


@dataclass(frozen=True)
class Guess:
    """Errors of a family: `size` times a mean, over the bodies, of powers of their elements along x and y.

    Parameters
    ----------
    rates : tuple of two float
        Along x and y.
    part : float
        Part of the error of a single element that lies along x.
    size : float
        Error of a single element, relative.
    """

    rates: tuple[float, float]
    part: float
    size: float

    def __call__(self, rung: Rung) -> float:
        """Return the error of a rung, relative."""
        (p, q), part = self.rates, self.part
        along = [part * float(x) ** -p + (1.0 - part) * float(y) ** -q for x, y in rung.divisions]
        return float(self.size * sum(along) / len(along))


def fit(known: Sequence[tuple[Rung, float]], prior: Prior) -> Guess:
    """Return the powers that are the most likely to leave the relative errors of rungs of a family.

    Errors and what is expected of rates and parts are taken as normal, errors by their logarithms: what is too small
    by a factor counts as much as what is too large by it.

    Parameters
    ----------
    known : sequence of (Rung, float)
        At least one.
    prior : Prior
        What is expected.

    Returns
    -------
    Guess
        Of all considered rates and parts the best.
    """
    rates = np.array([*product(_RATES, _RATES), (prior.rate_x, prior.rate_y)])
    part = float(np.clip(prior.part, _PARTS.min(), _PARTS.max()))
    parts = np.append(_PARTS, part)
    counts = np.array([rung.divisions for rung, _ in known], dtype=float)
    along = (counts[None] ** -rates[:, None, None, :]).mean(axis=2)
    mixed = parts[:, None] * along[:, None, :, 0] + (1.0 - parts[:, None]) * along[:, None, :, 1]
    off = np.log([error for _, error in known]) - np.log(mixed)
    # Fine rungs tell more of fine ones.
    weights = np.array([rung.elements for rung, _ in known]) ** 0.25
    weights /= weights.max()
    size = off @ weights / weights.sum()
    doubt = ((off - size[..., None]) ** 2 @ weights) / _OFF**2
    doubt += (((rates - rates[-1]) / _RATE_OFF) ** 2).sum(axis=1)[:, None]
    doubt += ((_odds(parts) - _odds(np.array(part))) / _PART_OFF) ** 2
    best = np.unravel_index(int(doubt.argmin()), doubt.shape)
    (p, q) = rates[best[0]].tolist()
    return Guess((p, q), float(parts[best[1]]), float(np.exp(size[best])))


def _odds(part: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.log(part / (1.0 - part)))
