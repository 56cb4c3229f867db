"""The search up the ladder, until the error is small enough, and down again, to what is cheapest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product

import numpy as np

from ancf.plan.climb import Climb
from ancf.plan.cost import Costs
from ancf.plan.errors import RATES, Side, Values, distance, scales
from ancf.plan.guess import Guess, fit
from ancf.plan.ladder import COUNTS, RIGID, Choice, Family, Rung, Stepping
from ancf.plan.pilots import Pilot, Pilots
from ancf.plan.timing import SHARE, Timing

BEST = 0.3
"""Part of the tolerance below which the finest rung's own error must be."""
_DOMINANT = 0.4
"""A side is refined if its error is at least this part of the largest."""
_SMALL_SIDE = 0.05
"""Part of the tolerance below which a side is not refined further."""
_TRIALS = 8
"""Cheaper rungs that are tried on the way down."""
_WORTH = 0.75
"""Predicted cost of a trial relative to the choice so far."""
_COMPARED = 32
"""Elements up to which a rung is compared with neighbours that are coarser along one side."""
_TRUST = 0.5
"""Part of the error that remains when it is extrapolated."""
_SHORTER = 5
"""Times that steps are shortened where they cannot be solved."""
_PATIENCE = 2
"""Rungs in a row that may be no better than the one before."""
_LIKELY = 0.2
"""Chance below which a cheaper rung is not tried."""
_STALLED = 0.4
"""Rate of convergence that counts as no better."""
_AGREED = 0.6
"""Part of the tolerance up to which another element on the finest mesh may be off."""
_DOWN = 0.4
"""Time for each part of the way down, relative to the time before."""
_HOPE = 3.0
"""Errors, relative to the tolerance, that may be too large only by the model that guesses them."""
_RIVAL = 2.0
"""Cost of another stepping, predicted and observed, relative to the one that was run, up to which it is kept."""
_RACE = 0.05
"""Part of the time left that such a run may take."""
_AFFORDED = 0.5
"""Part of the time left that a rung on the way up may take: what is chosen of it must be checked, too."""
_NEAR, _SHORT = 1.5, 0.1
"""Times the cheapest, and seconds, up to which a run is repeated before one is chosen."""
_LONGER = (2.0, 1.5)
"""Times the steps of the cheapest rung that are tried last."""
_LARGEST = 20_000
"""Elements of the finest rung."""


@dataclass
class Search:
    """The state of a search.

    Parameters
    ----------
    pilots : Pilots
        Runs and remembers.
    costs : Costs
        Predicts.
    families : sequence of Family
        That the scene allows.
    base : tuple of pairs of int
        The coarsest divisions.
    tol : float
        Of the plan.
    timings : list of Timing
        In motion, what is good enough in time; empty in statics.
    """

    pilots: Pilots
    costs: Costs
    families: Sequence[Family]
    base: tuple[tuple[int, int], ...]
    tol: float
    timings: list[Timing] = field(default_factory=list)
    predicted: dict[Choice, float] = field(default_factory=dict)
    allowed: list[Stepping] = field(default_factory=list)
    guessed: dict[Choice, float] = field(default_factory=dict)
    climbs: list[Climb] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Allow the steppings that are good enough; those that replace them are allowed later."""
        self.allowed = [timing.stepping for timing in self.timings]

    @property
    def allowance(self) -> float:
        """The error in space that the choice may have: in motion a share is left for that in time."""
        return (1.0 - SHARE if self.timings else 1.0) * self.tol

    @property
    def lead(self) -> Climb:
        """The climb with the smallest error."""
        return min((climb for climb in self.climbs if climb.rung is not None), key=lambda climb: climb.own)

    @property
    def best(self) -> Rung:
        """The finest rung of the leading climb."""
        assert self.lead.rung is not None
        return self.lead.rung

    @property
    def exact(self) -> Values:
        """What is known best of the wanted quantities."""
        return self.lead.exact

    @property
    def own(self) -> float:
        """The error of `exact`, relative."""
        return self.lead.own

    @property
    def sides(self) -> dict[tuple[int, int], Side]:
        """What is known along the sides of `best`."""
        return self.lead.sides

    def stepping(self, rung: Rung) -> Stepping | None:
        """Return the stepping that is predicted to be the cheapest on a rung; None in statics."""
        if not self.timings:
            return None
        return min(self.timings, key=lambda timing: self._predict(rung, timing)).stepping

    def _predict(self, rung: Rung, timing: Timing) -> float:
        """Return the seconds of a rung with a stepping, from the pilot with it that is most like the rung."""
        like = self._like(rung, timing.stepping)
        return self.costs.predict(rung, like if like is not None else timing.pilot)

    def _like(self, rung: Rung, stepping: Stepping | None) -> Pilot | None:
        like = [p for p in self.pilots.done if p.ok and p.choice.stepping == stepping]

        def unlike(pilot: Pilot) -> tuple[float, bool]:
            other = pilot.choice.rung
            return abs(np.log(other.elements / rung.elements)), other.family != rung.family

        return min(like, key=unlike, default=None)

    def choice(self, rung: Rung) -> Choice:
        """Return the rung with the stepping that is predicted to be the cheapest."""
        return Choice(rung, self.stepping(rung))

    def climb(self, rung: Rung) -> Pilot:
        """Run a rung; where its steps are too long to be solved, with shorter ones from now on."""
        pilot = self.run(rung)
        for _ in range(_SHORTER):
            stepping = pilot.choice.stepping
            if pilot.ok or stepping is None or self.pilots.left <= 0:
                break
            for index, timing in enumerate(self.timings):
                if timing.stepping == stepping:
                    shorter = replace(stepping, reuse=False) if stepping.reuse else stepping.tighter()
                    self.allowed.insert(0, shorter)
                    # Its cost is known from the pilot with the longer steps.
                    again = self.pilots.run(Choice(timing.pilot.choice.rung, shorter))
                    self.timings[index] = replace(timing, stepping=shorter, pilot=again if again.ok else timing.pilot)
            pilot = self.run(rung)
        return pilot

    def run(self, rung: Rung, limit: float = np.inf) -> Pilot:
        """Run a rung, after its cost has been predicted from the pilot most like it."""
        choice = self.choice(rung)
        predicted = self.predict(rung)
        if predicted is not None:
            self.predicted.setdefault(choice, predicted)
        return self.pilots.run(choice, limit)

    def predict(self, rung: Rung) -> float | None:
        """Return the seconds that a rung should take, from the pilot that is most like it."""
        like = self._like(rung, self.stepping(rung))
        return None if like is None else self.costs.predict(rung, like)

    def values(self, rung: Rung) -> Values | None:
        """Return the wanted quantities of a rung if it has been run, with any stepping that is good enough."""
        choices = [Choice(rung, stepping) for stepping in self.allowed] if self.timings else [Choice(rung)]
        found = (self.pilots.known(choice) for choice in choices)
        return next((pilot.values for pilot in found if pilot is not None), None)

    def up(self, families: Sequence[Family]) -> bool:
        """Refine several families, the one whose next rung is the cheapest, until one has a part of the tolerance left.

        Elements converge at different rates, and which is the better one shows only on the way.

        Parameters
        ----------
        families : sequence of Family
            What to refine.

        Returns
        -------
        bool
            Whether any rung reached its end; `best`, `exact` and `own` are then known.
        """
        self.climbs = [Climb(_doubled(Rung(family, self.base))) for family in families]
        while going := [climb for climb in self.climbs if not climb.ended]:
            self._step(min(going, key=lambda climb: self.predict(climb.next) or 0.0))
            if any(climb.rung for climb in self.climbs) and self.own <= BEST * self.tol and self._confirmed(self.best):
                break
        return any(climb.rung for climb in self.climbs)

    def _step(self, climb: Climb) -> None:
        """Run the next rung of a climb and learn from it, or end the climb."""
        rung = climb.next
        if (
            rung.elements > _LARGEST
            or (self.predict(rung) or 0.0) > _AFFORDED * self.pilots.left
            or climb.stalled > _PATIENCE
        ):
            climb.ended = True
        elif self.climb(rung).ok:
            before = climb.own
            self._learn(climb)
            climb.stalled = climb.stalled + 1 if climb.own > before * 2.0**-_STALLED else 0
            climb.next = self._refined(climb)
            self._race(rung)
        elif climb.rung is None and self.pilots.left > 0.0:
            climb.next = _doubled(rung)
        else:
            climb.ended = True

    def _race(self, rung: Rung) -> None:
        """Run a small rung with the other steppings that may be cheaper, and forget those that were much slower.

        An implicit one that is slower than an explicit one is kept: it may be cheaper on finer meshes.
        """
        if rung.elements > _COMPARED:
            return
        first = self.stepping(rung)
        limit = _RIVAL * self._seconds(rung)
        for timing in list(self.timings):
            if timing.stepping == first or self._predict(rung, timing) > limit:
                continue
            pilot = self.pilots.run(Choice(rung, timing.stepping), min(limit, _RACE * self.pilots.left))
            # Explicit steps only lose more on finer meshes.
            if not pilot.ok and (timing.stepping.explicit or not (first and first.explicit)):
                self.timings.remove(timing)

    def _learn(self, climb: Climb) -> None:
        """Set the finest rung, what is known along its sides, the extrapolated values and what they lack.

        Small rungs are compared with their neighbours that are coarser along one side. Of larger ones only the last
        rung is at hand: its difference is shared out along the sides that were refined as the errors were before.
        """
        rung, last = climb.next, climb.rung
        values = self.values(rung)
        assert values is not None
        scale = scales(values)
        before = dict(climb.sides)
        refined = [side for side in rung.sides() if last is None or _count(rung, side) > _count(last, side)]
        if last is None or rung.elements <= _COMPARED:
            for side in rung.sides():
                half = rung.scaled(side, Fraction(1, 2))
                if half is None:
                    continue
                pilot = self.run(half)
                coarse = pilot.values if pilot.ok else None if last is None else self.values(last)
                if coarse is None:
                    continue
                difference = distance(values, coarse, scale)
                old = before.get(side)
                rate = old.rate if old else None
                if old is not None and side in refined:
                    rate = _rate(old.difference, difference)
                climb.sides[side] = Side(difference, rate)
        else:
            coarse = self.values(last)
            assert coarse is not None
            total = distance(values, coarse, scale)
            expected = {side: before[side].error for side in refined if side in before}
            share = sum(expected.values())
            for side in refined:
                part = total * expected.get(side, 0.0) / share if share else total
                climb.sides[side] = Side(part, _rate(before[side].difference, part) if side in before else None)
        climb.rung, climb.exact = rung, values
        climb.own = sum(side.error for side in climb.sides.values()) if climb.sides else np.inf
        if last is not None and refined:
            self._extrapolate(climb, last, scale, refined)

    def _extrapolate(self, climb: Climb, last: Rung, scale: Sequence[float], refined: list[tuple[int, int]]) -> None:
        """Where the sides refined last converge at a known rate, take out the error that it tells of."""
        rates = [climb.sides[side].rate for side in refined]
        known = [rate for rate in rates if rate is not None]
        coarse = self.values(last)
        if coarse is None or len(known) < len(rates) or min(known) < RATES[0] * 2:
            return
        factor = 1.0 / (2.0 ** min(*known, RATES[1]) - 1.0)
        values = climb.exact
        climb.exact = [fine + factor * (fine - old) for fine, old in zip(values, coarse, strict=True)]
        removed = factor * distance(values, coarse, scale)
        climb.own = max(climb.own - (1 - _TRUST) * removed, _TRUST * climb.own)

    def _confirmed(self, rung: Rung) -> bool:
        """Check the estimate with another element on the same mesh; if it is far off, half of that may be missing."""
        lead = self.lead
        order = sorted(self.families, key=lambda family: family.element == rung.family.element)
        for family in order:
            if family == rung.family:
                continue
            pilot = self.run(replace(rung, family=family), 6 * self._seconds(rung))
            if pilot.ok:
                other = distance(pilot.values, lead.exact, scales(lead.exact))
                if other > max(_AGREED * self.tol, 3 * lead.own):
                    lead.own = max(lead.own, other / 2)
                break
        return lead.own <= BEST * self.tol

    def _seconds(self, rung: Rung) -> float:
        pilot = self.pilots.known(self.choice(rung))
        return pilot.seconds + 0.02 if pilot else np.inf

    def _refined(self, climb: Climb) -> Rung:
        """Double the elements along the sides whose error dominates."""
        rung = climb.next
        errors = {at: side.error for at, side in climb.sides.items()}
        if max(errors.values(), default=0.0) <= _SMALL_SIDE * self.tol:
            return _doubled(rung)
        worst = max(errors.values())
        for at, error in errors.items():
            if error >= _DOMINANT * worst and error > _SMALL_SIDE * self.tol:
                rung = rung.scaled(at, Fraction(2)) or rung
        return rung

    def down(self) -> None:
        """Look for cheaper rungs below the finest: first those that promise most, then all that might do, cheap first.

        Errors of coarse rungs can cancel, so that one is better than what a finer one of its family lets expect.
        """
        start = self.pilots.spent
        for _ in range(_TRIALS):
            limit = self._limit()
            trial = self._trial(limit)
            if trial is None or self.pilots.spent > (1 + _DOWN) * start or self.pilots.left <= 0.0:
                break
            self._try(trial, 1.5 * limit + 0.02)
        start = self.pilots.spent
        for cost, rung in self._cheap():
            limit = self._limit()
            if cost > _WORTH * limit or self.pilots.spent > (1 + _DOWN) * start or self.pilots.left <= 0.0:
                break
            self._try(rung, limit + 0.02)
        self._lengthen()

    def _try(self, rung: Rung, limit: float) -> None:
        self.guessed[self.choice(rung)] = self._guess(rung.family)(rung) + self.own
        self.run(rung, limit)

    def settle(self) -> None:
        """Repeat the short runs among which the cheapest is chosen."""
        current = self.cheapest(self.observed())
        for pilot in self._good(self.observed()):
            if current is not None and pilot.seconds <= _NEAR * current.seconds and pilot.seconds <= _SHORT:
                self.pilots.again(pilot)

    def _lengthen(self) -> None:
        """Try other and longer steps on the cheapest rung: those it was chosen for are small enough on a coarse one."""
        current = self.cheapest(self.observed())
        if current is None or current.choice.stepping is None:
            return
        for stepping in self.allowed:
            if stepping != current.choice.stepping:
                self.pilots.run(replace(current.choice, stepping=stepping), _WORTH * self._limit())
        for factor in _LONGER:
            current = self.cheapest(self.observed())
            assert current is not None
            assert current.choice.stepping is not None
            longer = current.choice.stepping.longer(factor)
            if longer is None:
                break
            self.allowed.append(longer)
            self.pilots.run(replace(current.choice, stepping=longer), self._limit())

    def _limit(self) -> float:
        current = self.cheapest(self.observed())
        return np.inf if current is None else current.seconds

    def _cheap(self) -> list[tuple[float, Rung]]:
        """Return the rungs that were not run and might be good enough, with their predicted costs, cheapest first."""
        tried = {pilot.choice.rung for pilot in self.pilots.done}
        found = []
        for family in self.families:
            guess = self._guess(family)
            for rung in self._below(family):
                cost = self.predict(rung)
                if rung not in tried and cost is not None and guess(rung) <= _HOPE * self.tol:
                    found.append((cost, rung))
        return sorted(found, key=lambda pair: pair[0])

    def observed(self) -> dict[Choice, float]:
        """Return the error of every pilot that reached its end: its distance to `exact` and what that lacks."""
        scale = scales(self.exact)
        done = (pilot for pilot in self.pilots.done if pilot.ok)
        return {pilot.choice: distance(pilot.values, self.exact, scale) + self.own for pilot in done}

    def cheapest(self, errors: dict[Choice, float]) -> Pilot | None:
        """Return the cheapest pilot whose error is small enough."""
        return min(self._good(errors), key=lambda pilot: pilot.seconds, default=None)

    def _good(self, errors: dict[Choice, float]) -> list[Pilot]:
        rigid = [pilot.choice.stepping for pilot in self.pilots.done if pilot.choice.rung.family == RIGID]
        allowed = [*self.allowed, *rigid] if self.timings else [None]
        return [
            pilot
            for choice, error in errors.items()
            if error <= self.allowance
            and choice.stepping in allowed
            and (pilot := self.pilots.known(choice)) is not None
        ]

    def _trial(self, limit: float) -> Rung | None:
        """Return the rung that was not run yet and promises the largest saving for its cost."""
        found: tuple[float, Rung] | None = None
        done = [pilot for pilot in self.pilots.done if pilot.ok]
        tried = {pilot.choice.rung for pilot in self.pilots.done}
        errors = self.observed()
        poor = [pilot.choice.rung for pilot in done if errors[pilot.choice] > self.allowance]
        for family in self.families:
            guess = self._guess(family)
            for rung in self._below(family):
                # A rung is not better than a finer one of its family.
                if rung in tried or any(_within(rung, other) for other in poor):
                    continue
                cost = self.predict(rung)
                if cost is None or cost > _WORTH * limit or cost > self.pilots.left:
                    continue
                likely = 1.0 / (1.0 + ((guess(rung) + self.own) / (self.allowance)) ** 4)
                saving = likely * (1.0 - cost / limit if np.isfinite(limit) else 1.0)
                if likely > _LIKELY and (found is None or saving > found[0]):
                    found = saving, rung
        return found[1] if found else None

    def _below(self, family: Family) -> Iterator[Rung]:
        """Yield the rungs of a family with no more elements along any side than the finest."""
        if len(self.base) > 1:
            # Of several bodies all are coarsened alike.
            for k in COUNTS:
                pairs = zip(self.best.divisions, self.base, strict=True)
                yield Rung(family, tuple((max(a, x // k), max(b, y // k)) for (x, y), (a, b) in pairs))
            return
        [(x, y)], [(a, b)] = self.best.divisions, self.base
        for m, n in product(COUNTS, COUNTS):
            if m * a <= x and n * b <= y:
                yield Rung(family, ((m * a, n * b),))

    def _guess(self, family: Family) -> Guess:
        """Return a model of the errors of a family, fitted to its pilots."""
        known = next((climb.sides for climb in self.climbs if climb.family == family), self.sides)
        rates = {at: min(max(side.rate or 2.0, 1.0), 3.0) for at, side in known.items()}
        scale = scales(self.exact)
        # Distances below what `exact` lacks tell nothing.
        errors = [
            (pilot.choice.rung, max(distance(pilot.values, self.exact, scale), 0.5 * self.own))
            for pilot in self.pilots.done
            if pilot.ok and pilot.choice.rung.family == family
        ]
        if errors:
            return fit(errors, list(self.best.sides()), rates)
        # Nothing is known of it: as good as the one that was refined.
        return self._guess(self.best.family) if family != self.best.family else Guess(rates, {})


def _within(rung: Rung, other: Rung) -> bool:
    """Tell whether a rung has no more elements along any side than another of its family."""
    return rung.family == other.family and all(_count(rung, side) <= _count(other, side) for side in rung.sides())


def _count(rung: Rung, side: tuple[int, int]) -> int:
    body, axis = side
    return rung.divisions[body][axis]


def _rate(before: float, after: float) -> float | None:
    if not 0 < before < np.inf or not 0 < after < np.inf:
        return None
    return float(np.log2(before / after))


def _doubled(rung: Rung) -> Rung:
    return replace(rung, divisions=tuple((2 * x, 2 * y) for x, y in rung.divisions))
