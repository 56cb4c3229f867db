"""Down the ladder: rungs that are cheaper than the finest and good enough."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ancf.plan.errors import distance, scales
from ancf.plan.guess import Guess, fit
from ancf.plan.ladder import COUNTS, Choice, Family, Rung
from ancf.plan.search import Search

_TRIALS = 8
"""Rungs that are tried because they promise a saving."""
_WORTH = 0.75
"""Predicted cost of a trial relative to the choice so far."""
_HALF = 0.5
"""The same where only the cost speaks for it."""
_LIKELY = 0.2
"""Chance below which a rung promises nothing."""
_ROOM = 0.7
"""Part of the error that is allowed above which that of the finest rung leaves no room for a cheaper one's."""
_DOWN, _RUNS = 0.3, 60.0
"""Time for each part of the way down, relative to the time before and to that of a run of the choice so far."""
_HOPE = 3.0
"""Errors, relative to the tolerance, that may be too large only by the model that guesses them."""
_NEAR, _SHORT = 1.5, 0.1
"""Times the cheapest, and seconds, up to which a run is repeated before one is chosen."""
_LONGER = (2.0, 1.5)
"""Times the steps of the cheapest rung that are tried last, as long as they are good enough and cheaper."""


@dataclass(frozen=True)
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

    def down(self) -> None:
        """Look for cheaper rungs below the finest, for a part of the time of the plan so far in each of three ways.

        First those that promise most, then the best of those at half the cost, at last all, cheap first: errors of
        coarse rungs can cancel, so that one is better than what a finer one of its family lets expect.
        """
        ways = [(_LIKELY, _WORTH), (0.0, _HALF)]
        if self.search.own > _ROOM * self.search.allowance:
            # What is known best leaves hardly any room for errors: only what promises much is tried.
            ways = ways[:1]
        for chance, worth in ways:
            for _ in zip(range(_TRIALS), self._turns(), strict=False):
                limit = self._limit()
                trial = self._trial(limit, chance, worth)
                if trial is None:
                    break
                self._try(trial, 1.5 * limit + 0.02)
        if len(ways) == 1:
            return
        for (cost, hopeful, rung), _ in zip(self._cheap(), self._turns(), strict=False):
            if cost <= (_WORTH if hopeful else _HALF) * self._limit():
                self._try(rung, self._limit() + 0.02)

    def _turns(self) -> Iterator[None]:
        """Yield while there is time for more."""
        pilots = self.search.pilots
        end = min(pilots.spent + min(_DOWN * pilots.spent, _RUNS * self._limit()), self.worth)
        while pilots.spent < end and pilots.left > 0.0:
            yield None

    def _try(self, rung: Rung, limit: float) -> None:
        self.search.guessed[self.search.choice(rung)] = self._guess(rung.family)(rung) + self.search.own
        self.search.run(rung, limit)

    def settle(self) -> None:
        """Repeat the short runs among which the cheapest is chosen."""
        current = self.search.cheapest(self.search.observed())
        for pilot in self.search.good(self.search.observed()):
            if current is not None and pilot.seconds <= _NEAR * current.seconds and pilot.seconds <= _SHORT:
                self.search.pilots.again(pilot)

    def lengthen(self) -> None:
        """Try other and longer steps on the cheapest rung: those it was chosen for are small enough on a coarse one."""
        current = self.search.cheapest(self.search.observed())
        if current is None or current.choice.stepping is None:
            return
        for stepping in self.search.allowed:
            if stepping != current.choice.stepping:
                self.search.pilots.run(replace(current.choice, stepping=stepping), _WORTH * self._limit())
        for factor in _LONGER:
            while (longer := self._longer(factor)) is not None:
                pilot = self.search.pilots.run(longer, self._limit())
                if pilot is not self.search.cheapest(self.search.observed()):
                    break

    def _longer(self, factor: float) -> Choice | None:
        """Return the cheapest choice with steps that are longer by a factor, and allow them."""
        current = self.search.cheapest(self.search.observed())
        assert current is not None
        assert current.choice.stepping is not None
        longer = current.choice.stepping.longer(factor)
        if longer is None:
            return None
        self.search.allowed.append(longer)
        return replace(current.choice, stepping=longer)

    def _limit(self) -> float:
        current = self.search.cheapest(self.search.observed())
        return np.inf if current is None else current.seconds

    def _cheap(self) -> list[tuple[float, bool, Rung]]:
        """Return the predicted costs of the rungs that were not run, and whether they might be good enough.

        Those come first, and of both the cheapest.
        """
        tried = {pilot.choice.rung for pilot in self.search.pilots.done}
        found = []
        for family in self.search.families:
            guess = self._guess(family)
            for rung in self._below(family):
                cost = self.search.predict(rung)
                if rung not in tried and cost is not None:
                    found.append((cost, guess(rung) <= _HOPE * self.search.tol, rung))
        return sorted(found, key=lambda one: (not one[1], one[0]))

    def _trial(self, limit: float, chance: float, worth: float) -> Rung | None:
        """Return the rung that was not run, costs little enough and promises the largest saving with some chance."""
        found: tuple[float, Rung] | None = None
        done = [pilot for pilot in self.search.pilots.done if pilot.ok]
        tried = {pilot.choice.rung for pilot in self.search.pilots.done}
        errors = self.search.observed()
        poor = [pilot.choice.rung for pilot in done if errors[pilot.choice] > self.search.allowance]
        for family in self.search.families:
            guess = self._guess(family)
            for rung in self._below(family):
                # A rung is not better than a finer one of its family.
                if rung in tried or any(_within(rung, other) for other in poor):
                    continue
                cost = self.search.predict(rung)
                if cost is None or cost > worth * limit or cost > self.search.pilots.left:
                    continue
                likely = 1.0 / (1.0 + ((guess(rung) + self.search.own) / (self.search.allowance)) ** 4)
                saving = likely * (1.0 - cost / limit if np.isfinite(limit) else 1.0)
                if likely > chance and (found is None or saving > found[0]):
                    found = saving, rung
        return found[1] if found else None

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
        """Return a model of the errors of a family, fitted to its pilots."""
        known = next((climb.sides for climb in self.search.climbs if climb.family == family), self.search.sides)
        rates = {at: min(max(side.rate or 2.0, 1.0), 3.0) for at, side in known.items()}
        scale = scales(self.search.exact)
        # Distances below what `exact` lacks tell nothing.
        errors = [
            (pilot.choice.rung, max(distance(pilot.values, self.search.exact, scale), 0.5 * self.search.own))
            for pilot in self.search.pilots.done
            if pilot.ok and pilot.choice.rung.family == family
        ]
        if errors:
            return fit(errors, list(self.search.best.sides()), rates)
        # Nothing is known of it: as good as the one that was refined.
        return self._guess(self.search.best.family) if family != self.search.best.family else Guess(rates, {})


def _within(rung: Rung, other: Rung) -> bool:
    """Tell whether a rung has no more elements along any side than another of its family."""
    pairs = zip(rung.divisions, other.divisions, strict=True)
    return rung.family == other.family and all(x <= a and y <= b for (x, y), (a, b) in pairs)
