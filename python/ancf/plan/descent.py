"""Down the ladder: rungs that are cheaper than the finest and good enough."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import count, product

import numpy as np

from ancf.plan.errors import Side, distance, scales
from ancf.plan.guess import Guess, Prior, fit
from ancf.plan.ladder import COUNTS, Choice, Family, Rung, Stepping
from ancf.plan.search import Search

_RUNS = 12.0
"""Runs of the choice for which a trial must pay: its chance times what one run of it saves, times these."""
_WORTH = 0.85
"""Predicted cost of a trial relative to the choice so far: what saves less is left to the noise of the clock."""
_HOPELESS = 0.01
"""Chance below which a rung is not tried however little it costs."""
_TAIL = 2
"""Power of a guessed error with which that chance falls: errors that cancel make it fall slowly."""
_DOWN, _FEW = 0.3, 3
"""Time for the way down, relative to the time before; and how many rungs are tried anyway."""
_NEAR, _SHORT, _TIMED = 1.5, 0.1, 3
"""Times the cheapest, and seconds, up to which a run is timed again before one is chosen; and how many at most."""
_LONGER = (1.5, 2.0, 3.0)
"""Times the steps that were found that are considered."""
_ORDER = 2
"""Of the error in time."""


@dataclass
class Descent:
    """The way down, after an ascent.

    Parameters
    ----------
    search : Search
        What it adds to.
    worth : float
        Seconds after which a plan looks for nothing cheaper: it has cost more than it can save.
    """

    search: Search
    worth: float

    def __post_init__(self) -> None:
        """Note when it begins."""
        self._begin = self.search.pilots.spent

    def down(self) -> None:
        """Run what promises the most: its chance to be good enough times what it saves in some runs, less its cost.

        A model of errors, fitted anew after each trial, and one of costs tell that. It ends when nothing is worth its
        own cost, or after a part of the time of the plan so far.
        """
        pilots = self.search.pilots
        for turn in count():
            taken, limit = pilots.spent - self._begin, self._limit()
            over = taken >= min(_DOWN * self._begin, _RUNS * limit) and turn >= _FEW
            if over or pilots.left <= 0.0 or pilots.spent >= self.worth:
                return
            trial = self._trial(limit)
            if trial is None:
                return
            self._try(*trial, limit)

    def settle(self) -> None:
        """Time again the short runs among which the cheapest is chosen."""
        errors = self.search.observed()
        good = sorted(self.search.good(errors), key=lambda pilot: pilot.seconds)
        for pilot in good[:_TIMED]:
            if len(good) > 1 and pilot.seconds <= min(_NEAR * good[0].seconds, _SHORT):
                self.search.pilots.again(pilot)

    def _try(self, choice: Choice, guessed: float, limit: float) -> None:
        search = self.search
        search.guessed[choice] = guessed
        predicted = search.predict_choice(choice)
        if predicted is not None:
            search.predicted.setdefault(choice, predicted)
        search.pilots.run(choice, limit + 0.02)

    def _limit(self) -> float:
        current = self.search.cheapest(self.search.observed())
        return np.inf if current is None else current.seconds

    def _trial(self, limit: float) -> tuple[Choice, float] | None:
        """Return what was not run and promises the largest saving, and its guessed error; None if nothing is worth it.

        The likeliest come first, so that costs need not be predicted of those that could not save more.
        """
        search = self.search
        own, room, left = search.own, search.allowance, search.pilots.left
        if room <= 0.0:
            return None
        hopes = []
        for family in search.families:
            guess = self._guess(family)
            for rung in self._below(family):
                in_space = guess(rung) + own
                likely = _likely(in_space / room)
                if likely >= _HOPELESS:
                    hopes.append((likely, in_space, rung))
        hopes.sort(key=lambda hope: -hope[0])
        found, best = None, 0.0
        for upper, in_space, rung in hopes:
            if np.isfinite(limit) and upper * _RUNS * limit <= best:
                break
            for stepping, in_time in self._steppings(rung):
                choice = Choice(rung, stepping)
                likely = _likely((in_space + in_time) / room)
                if likely < _HOPELESS or search.pilots.tried(choice):
                    continue
                cost = search.predict_choice(choice)
                if cost is None or cost > min(_WORTH * limit, left):
                    continue
                gain = likely * _RUNS * (limit - cost) - cost if np.isfinite(limit) else likely / cost
                if gain > best:
                    found, best = (choice, in_space), gain
        return found

    def _steppings(self, rung: Rung) -> Iterator[tuple[Stepping | None, float]]:
        """Yield the steppings that are considered on a rung, and their errors as the coarse mesh tells them."""
        if not self.search.timings:
            yield None, 0.0
            return
        timing = self.search.timing(rung)
        yield timing.stepping, timing.error
        for factor in _LONGER:
            longer = timing.stepping.longer(factor)
            if longer is not None:
                yield longer, timing.error * factor**_ORDER

    def _below(self, family: Family) -> Iterator[Rung]:
        """Yield the rungs of a family with no more elements along any side than the finest."""
        if len(self.search.base) > 1:
            # Of several bodies all are coarsened alike.
            for k in COUNTS:
                pairs = zip(self.search.best.divisions, self.search.base, strict=True)
                yield Rung(family, tuple((max(a, x // k), max(b, y // k)) for (x, y), (a, b) in pairs))
            return
        [(x, y)], [(a, b)] = self.search.best.divisions, self.search.base
        for m, n in product(COUNTS, COUNTS):
            if m * a <= x and n * b <= y:
                yield Rung(family, ((m * a, n * b),))

    def _guess(self, family: Family) -> Guess:
        """Return a model of the errors of a family, fitted to its pilots, or else to those that were refined."""
        search = self.search
        sides = next((climb.sides for climb in search.climbs if climb.family == family), search.sides)
        exact, own = search.exact, search.own
        scale = scales(exact)
        # Distances below what `exact` lacks tell nothing.
        errors = [
            (pilot.choice.rung, max(distance(pilot.values, exact, scale), 0.5 * own))
            for pilot in search.pilots.done
            if pilot.ok and pilot.choice.rung.family == family
        ]
        return fit(errors, _expected(search.best, sides)) if errors else self._guess(search.best.family)


def _expected(rung: Rung, sides: Mapping[tuple[int, int], Side]) -> Prior:
    """Return the rates along x and y, and the part of a single element's error along x, that a climb tells."""
    rates: list[float] = []
    sizes: list[float] = []
    for axis in (0, 1):
        along = [(rung.divisions[body][axis], side) for (body, at), side in sides.items() if at == axis]
        rate = max((side.rate or 2.0 for _, side in along), default=2.0)
        rates.append(min(max(rate, 1.0), 3.0))
        sizes.append(sum(side.error * count ** rates[-1] for count, side in along))
    part = sizes[0] / sum(sizes) if 0.0 < sum(sizes) < np.inf else 0.5
    return Prior(rates[0], rates[1], part)


def _likely(error: float) -> float:
    """Return the chance that something is good enough of which an error is guessed, relative to what is allowed."""
    return float(1.0 / (1.0 + error**_TAIL)) if error >= 0.0 else 0.0
