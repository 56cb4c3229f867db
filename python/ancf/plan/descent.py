"""Down the ladder: rungs that are cheaper than the finest and good enough."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import count, product

import numpy as np

from ancf.plan.errors import distance, scales
from ancf.plan.guess import Guess, fit
from ancf.plan.ladder import COUNTS, Choice, Family, Rung, Stepping
from ancf.plan.pilots import Pilot
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
_DOWN, _RUNS, _FEW = 0.3, 60.0, 8
"""Time for each part of the way down, relative to the time before and to that of a run of the choice so far;
and how much is tried anyway."""
_HOPE = 3.0
"""Errors, relative to the tolerance, that may be too large only by the model that guesses them."""
_HOPELESS = 6.0
"""Those that are."""
_STEPS, _SLIGHT, _CHEAPER = 24, 0.03, 0.85
"""Trials next to the cheapest, the chance that is enough for one, and its predicted cost."""
_NEAR, _SHORT = 1.5, 0.1
"""Times the cheapest, and seconds, up to which a run is repeated before one is chosen."""
_LONGER = (1.5, 2.0, 3.0)
"""Times the steps that were found that are considered."""
_ORDER = 2
"""Of the error in time."""


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
                trial = self._trial(self._meshes(), chance, worth)
                if trial is None:
                    break
                self._try(trial, 1.5)
        if len(ways) == 1:
            return
        for (cost, hopeful, rung), _ in zip(self._cheap(), self._turns(), strict=False):
            if cost <= (_WORTH if hopeful else _HALF) * self._limit():
                self._try(self.search.choice(rung), 1.0)

    def _turns(self) -> Iterator[None]:
        """Yield while there is time for more, but a few times at least: the clock shall not choose."""
        pilots = self.search.pilots
        end = min(pilots.spent + min(_DOWN * pilots.spent, _RUNS * self._limit()), self.worth)
        for turn in count():
            if pilots.left <= 0.0 or (pilots.spent >= end and (turn >= _FEW or pilots.spent >= self.worth)):
                return
            yield None

    def _try(self, choice: Choice, patience: float) -> Pilot:
        search = self.search
        search.guessed[choice] = self._guess(choice.rung.family)(choice.rung) + search.own
        predicted = search.predict_choice(choice)
        if predicted is not None:
            search.predicted.setdefault(choice, predicted)
        return search.pilots.run(choice, patience * self._limit() + 0.02)

    def settle(self) -> None:
        """Repeat the short runs among which the cheapest is chosen."""
        current = self.search.cheapest(self.search.observed())
        for pilot in self.search.good(self.search.observed()):
            if current is not None and pilot.seconds <= _NEAR * current.seconds and pilot.seconds <= _SHORT:
                self.search.pilots.again(pilot)

    def near(self) -> None:
        """Try what is near the cheapest: coarser along one side or both, of another family, with other, longer steps.

        Errors of space and time, and along the sides, can cancel, so that one of these may do where it is not expected.
        """
        for _ in zip(range(_STEPS), self._turns(), strict=False):
            current = self.search.cheapest(self.search.observed())
            trial = None if current is None else self._trial(self._around(current.choice.rung), _SLIGHT, _CHEAPER)
            if trial is None:
                return
            self._try(trial, 1.0)

    def _around(self, rung: Rung) -> Iterator[Rung]:
        """Yield a rung, and those of all families next to it that are coarser."""
        if len(rung.divisions) > 1:
            yield from (replace(rung, family=family) for family in self.search.families)
            return
        [(x, y)], [(a, b)] = rung.divisions, self.search.base
        for family, m, n in product(self.search.families, _lower(x, a), _lower(y, b)):
            yield Rung(family, ((m, n),))

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
                error = guess(rung)
                if rung not in tried and cost is not None and error <= _HOPELESS * self.search.tol:
                    found.append((cost, error <= _HOPE * self.search.tol, rung))
        return sorted(found, key=lambda one: (not one[1], one[0]))

    def _meshes(self) -> Iterator[Rung]:
        """Yield the rungs below the finest of which no finer one of their family is known to be poor."""
        search, errors = self.search, self.search.observed()
        found = {None, *(timing.stepping for timing in search.timings)}
        poor = [c.rung for c, error in errors.items() if error > search.allowance and c.stepping in found]
        for family in search.families:
            for rung in self._below(family):
                if not any(_within(rung, other) for other in poor):
                    yield rung

    def _trial(self, rungs: Iterable[Rung], chance: float, worth: float) -> Choice | None:
        """Return what was not run, costs little enough and promises the largest saving with some chance."""
        search = self.search
        limit, room = self._limit(), search.allowance
        tried = {pilot.choice for pilot in search.pilots.done}
        guesses = {family: self._guess(family) for family in search.families}
        found: tuple[float, Choice] | None = None
        for rung in rungs:
            in_space = guesses[rung.family](rung) + search.own
            if _likely(in_space / room) <= chance:
                continue
            for stepping, in_time in self._steppings(rung):
                choice = Choice(rung, stepping)
                likely = _likely((in_space + in_time) / room)
                if choice in tried or likely <= chance:
                    continue
                cost = search.predict_choice(choice)
                if cost is None or cost > worth * limit or cost > search.pilots.left:
                    continue
                saving = likely * (1.0 - cost / limit if np.isfinite(limit) else 1.0)
                if found is None or saving > found[0]:
                    found = saving, choice
        return found[1] if found else None

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


def _likely(error: float) -> float:
    """Return the chance that something is good enough of which an error is guessed, relative to what is allowed."""
    return float(1.0 / (1.0 + error**4)) if error >= 0.0 else 0.0


def _lower(count: int, base: int) -> list[int]:
    """Return a number of elements and the next smaller one of the ladder."""
    smaller = [k * base for k in COUNTS if k * base < count]
    return [count, *smaller[-1:]]
