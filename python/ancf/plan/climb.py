"""The climb of one family: its finest rung, what is known along its sides, and the error that is left."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ancf.plan.errors import RATES, UNKNOWN_RATE, Side, Values
from ancf.plan.ladder import Family, Rung

_STALLED = 0.4
"""Rate of convergence that counts as no better."""


@dataclass
class Climb:
    """How far a family has been refined.

    Parameters
    ----------
    next : Rung
        What is run next.
    rung : Rung or None
        The finest that reached its end; None before the first.
    last : Rung or None
        The one before it.
    exact : list of ndarray
        The wanted quantities of `rung`, extrapolated where rates are known.
    own : float
        Error left in `exact`, relative.
    sides : dict of (int, int) to Side
        Differences and rates along body and axis.
    refined : bool
        Whether `rung` is finer than one before it: a single difference may be small by accident.
    apart : bool
        Whether what two sides changed has cancelled, so that it is told apart.
    rate : float
        With which `own` shrank when it was refined last, as a power of 2, in the range that is trusted.
    stalled : int
        Rungs in a row that were no better than the one before.
    ended : bool
        Whether it is given up.
    """

    next: Rung
    rung: Rung | None = None
    last: Rung | None = None
    exact: Values = field(default_factory=list)
    own: float = np.inf
    sides: dict[tuple[int, int], Side] = field(default_factory=dict)
    refined: bool = False
    apart: bool = False
    rate: float = UNKNOWN_RATE
    stalled: int = 0
    ended: bool = False

    def restart(self, rung: Rung) -> None:
        """Begin anew with a rung of another family."""
        self.next, self.rung, self.last = rung, None, None
        self.exact, self.own, self.sides, self.refined = [], np.inf, {}, False
        self.rate, self.stalled = UNKNOWN_RATE, 0

    def observe(self, before: float) -> None:
        """Compare `own` with what it was before the last rung."""
        self.stalled = self.stalled + 1 if self.own > before * 2.0**-_STALLED else 0
        if self.own < np.inf and before < np.inf:
            self.rate = float(np.clip(np.log2(before / self.own), *RATES))

    @property
    def sudden(self) -> bool:
        """Whether the difference along a side shrank too fast to be believed."""
        return any(side.sudden for side in self.sides.values())

    @property
    def family(self) -> Family:
        """The element and membrane."""
        return self.next.family
