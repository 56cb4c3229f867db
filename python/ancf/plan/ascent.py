"""Up the ladder: families are refined side by side until the error of one is small enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ancf.plan.climb import Climb
from ancf.plan.errors import RATES, Side, distance, scales
from ancf.plan.ladder import Choice, Family, Rung
from ancf.plan.pilots import Pilot
from ancf.plan.search import Search
from ancf.plan.timing import SHARE

BEST = 0.3
"""Part of the tolerance below which the finest rung's own error must be."""
_CLEAR, _LITTLE = 0.1, 0.15
"""The same that is tried for while the next rung costs no more than this part of the plan so far."""
_DOMINANT = 0.4
"""A side is refined if its error is at least this part of the largest."""
_SMALL_SIDE = 0.05
"""Part of the tolerance below which a side is not refined further."""
_COMPARED = 32
"""Elements up to which a rung is compared with neighbours that are coarser along one side."""
_RECONSIDERED, _APART = 64, 3.0
"""Elements up to which another family may take over, and errors of the lead by which one must be off it for that."""
_TRUST = 0.5
"""Part of the error that remains when it is extrapolated."""
_SHORTER = 5
"""Times that steps are shortened where they cannot be solved."""
_PATIENCE = 2
"""Rungs in a row that may be no better than the one before."""
_STALLED = 0.4
"""Rate of convergence that counts as no better."""
_AGREED = 0.6
"""Part of the tolerance up to which another element on the finest mesh may be off."""
_RIVAL = 1.4
"""Cost of another stepping, predicted and observed, relative to the one that was run, up to which it is kept."""
_RACE = 0.05
"""Part of the time left that such a run may take."""
_AFFORDED = 0.5
"""Part of the time left that a rung on the way up may take: what is chosen of it must be checked, too."""
_LARGEST = 20_000
"""Elements of the finest rung."""


@dataclass(frozen=True)
class Ascent:
    """The way up.

    Parameters
    ----------
    search : Search
        What it adds to.
    """

    search: Search

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
            Whether any rung reached its end; `best`, `exact` and `own` of the search are then known.
        """
        self.search.climbs = [Climb(_doubled(Rung(family, self.search.base))) for family in families]
        while going := [climb for climb in self.search.climbs if not climb.ended]:
            self._step(min(going, key=lambda climb: self.search.predict(climb.next) or 0.0))
            if any(climb.rung for climb in self.search.climbs) and self._enough():
                self._sharpen()
                break
        return any(climb.rung for climb in self.search.climbs)

    def _enough(self) -> bool:
        """Tell whether the error of the leading climb is small enough, and trusted."""
        lead = self.search.lead
        return lead.refined and lead.own <= BEST * self.search.tol and self._confirmed(self.search.best)

    def _sharpen(self) -> None:
        """Refine the leading climb further while that costs little beside the plan so far.

        What is known best leaves the more room for errors of cheaper rungs.
        """
        search, lead = self.search, self.search.lead
        while not lead.ended and lead.own > _CLEAR * search.tol:
            cost = search.predict(lead.next)
            if cost is None or cost > _LITTLE * search.pilots.spent:
                break
            self._step(lead)

    def _step(self, climb: Climb) -> None:
        """Run the next rung of a climb and learn from it, or end the climb."""
        rung = climb.next
        if (
            rung.elements > _LARGEST
            or (self.search.predict(rung) or 0.0) > _AFFORDED * self.search.pilots.left
            or climb.stalled > _PATIENCE
        ):
            climb.ended = True
            return
        self._compare_steps(climb)
        if self._run(rung).ok:
            before = climb.own
            self._learn(climb)
            climb.stalled = climb.stalled + 1 if climb.own > before * 2.0**-_STALLED else 0
            climb.next = self._refined(climb)
            self._race(rung)
            self._reconsider(climb)
        elif climb.rung is None and self.search.pilots.left > 0.0:
            climb.next = _doubled(rung)
        else:
            climb.ended = True

    def _run(self, rung: Rung) -> Pilot:
        """Run a rung; where its steps are too long to be solved, with shorter ones from now on."""
        pilot = self.search.run(rung)
        for _ in range(_SHORTER):
            stepping = pilot.choice.stepping
            if pilot.ok or stepping is None or self.search.pilots.left <= 0:
                break
            self.search.shorten(stepping, replace(stepping, reuse=False) if stepping.reuse else stepping.tighter())
            pilot = self.search.run(rung)
        return pilot

    def _compare_steps(self, climb: Climb) -> None:
        """Before a rung is run with another stepping than the last one, see that the two agree there, or shorten it.

        Steps that are short enough on the coarse mesh, on which they were found, may not be on a finer one, and then
        the error in time would be taken for one in space.
        """
        last = climb.rung
        for _ in range(_SHORTER):
            stepping = self.search.stepping(climb.next)
            if last is None or stepping is None:
                return
            known = [
                self.search.pilots.known(Choice(last, other)) for other in self.search.allowed if other != stepping
            ]
            others = [pilot.values for pilot in known if pilot is not None]
            if not others:
                return
            own = self.search.pilots.run(Choice(last, stepping), _AFFORDED * self.search.pilots.left)
            if not own.ok:
                return
            scale = scales(own.values)
            if min(distance(own.values, values, scale) for values in others) <= 2 * SHARE * self.search.tol:
                return
            self.search.shorten(stepping, stepping.tighter())

    def _reconsider(self, climb: Climb) -> None:
        """Go on with another family of the element where it is much nearer to what another element tells.

        On the coarsest meshes what locks hardly changes, so that the wrong family may have been taken.
        """
        lead, rung = self.search.lead, climb.rung
        assert rung is not None
        if lead.family.element == rung.family.element or rung.elements > _RECONSIDERED:
            return
        scale = scales(lead.exact)
        values = self.search.values(rung)
        assert values is not None
        nearest = distance(values, lead.exact, scale)
        if nearest <= _APART * lead.own:
            return
        nearest /= 2
        for family in self.search.families:
            if family.element == rung.family.element and family != rung.family:
                other = replace(rung, family=family)
                pilot = self.search.run(other, 2 * self._seconds(rung))
                if pilot.ok and distance(pilot.values, lead.exact, scale) < nearest:
                    nearest = distance(pilot.values, lead.exact, scale)
                    climb.restart(other)

    def _race(self, rung: Rung) -> None:
        """Run a small rung with the other steppings that may be cheaper, and forget those that were much slower.

        An implicit one that is slower than an explicit one is kept: it may be cheaper on finer meshes.
        """
        if rung.elements > _COMPARED:
            return
        first = self.search.stepping(rung)
        limit = _RIVAL * self._seconds(rung)
        for timing in list(self.search.timings):
            if timing.stepping == first or self.search.predict_with(rung, timing) > limit:
                continue
            pilot = self.search.pilots.run(Choice(rung, timing.stepping), min(limit, _RACE * self.search.pilots.left))
            # Explicit steps only lose more on finer meshes.
            if not pilot.ok and (timing.stepping.explicit or not (first and first.explicit)):
                self.search.timings.remove(timing)

    def _learn(self, climb: Climb) -> None:
        """Set the finest rung, what is known along its sides, the extrapolated values and what they lack.

        Small rungs are compared with their neighbours that are coarser along one side. Of larger ones only the last
        rung is at hand: its difference is shared out along the sides that were refined as the errors were before.
        """
        rung, last = climb.next, climb.rung
        values = self.search.values(rung)
        assert values is not None
        scale = scales(values)
        before = dict(climb.sides)
        refined = [side for side in rung.sides() if last is None or _count(rung, side) > _count(last, side)]
        if last is None or rung.elements <= _COMPARED:
            for side in rung.sides():
                half = rung.scaled(side, Fraction(1, 2))
                if half is None:
                    continue
                pilot = self.search.run(half)
                coarse = pilot.values if pilot.ok else None if last is None else self.search.values(last)
                if coarse is None:
                    continue
                difference = distance(values, coarse, scale)
                old = before.get(side)
                rate = old.rate if old else None
                if old is not None and side in refined:
                    rate = _rate(old.difference, difference)
                climb.sides[side] = Side(difference, rate)
        else:
            coarse = self.search.values(last)
            assert coarse is not None
            total = distance(values, coarse, scale)
            expected = {side: before[side].error for side in refined if side in before}
            share = sum(expected.values())
            for side in refined:
                part = total * expected.get(side, 0.0) / share if share else total
                climb.sides[side] = Side(part, _rate(before[side].difference, part) if side in before else None)
        climb.rung, climb.exact, climb.refined = rung, values, last is not None
        # Nothing is known of a side along which no coarser rung reached its end.
        known = all(side in climb.sides for side in rung.sides())
        climb.own = sum(side.error for side in climb.sides.values()) if known else np.inf
        if last is not None and refined:
            self._extrapolate(climb, last, scale, refined)
            self._agree(climb, scale)

    def _extrapolate(self, climb: Climb, last: Rung, scale: Sequence[float], refined: list[tuple[int, int]]) -> None:
        """Where the sides refined last converge at a known rate, take out the error that it tells of."""
        rates = [climb.sides[side].rate for side in refined]
        known = [rate for rate in rates if rate is not None]
        coarse = self.search.values(last)
        if coarse is None or len(known) < len(rates) or min(known) < RATES[0] * 2:
            return
        factor = 1.0 / (2.0 ** min(*known, RATES[1]) - 1.0)
        values = climb.exact
        climb.exact = [fine + factor * (fine - old) for fine, old in zip(values, coarse, strict=True)]
        removed = factor * distance(values, coarse, scale)
        climb.own = max(climb.own - (1 - _TRUST) * removed, _TRUST * climb.own)

    def _agree(self, climb: Climb, scale: Sequence[float]) -> None:
        """Trust an estimate more where the climb of another element comes to the same."""
        for other in self.search.climbs:
            if other.refined and other.family.element != climb.family.element:
                apart = distance(other.exact, climb.exact, scale)
                climb.own = min(climb.own, max(2 * apart, _TRUST * climb.own))

    def _confirmed(self, rung: Rung) -> bool:
        """Check the estimate with another element; if it is far off, half of that may be missing.

        Its climb tells, or else it is run on the same mesh. There one of its families must agree, the one that is
        refined before those that may lock or be weak here.
        """
        lead = self.search.lead
        scale = scales(lead.exact)
        agreed, nearest = max(_AGREED * self.search.tol, 3 * lead.own), np.inf
        for other in self.search.climbs:
            if other.refined and other.family.element != rung.family.element:
                nearest = min(nearest, distance(other.exact, lead.exact, scale))
        if nearest <= agreed:
            return True
        nearest = np.inf
        refined = {climb.family for climb in self.search.climbs}
        order = sorted(self.search.families, key=lambda f: (f.element == rung.family.element, f not in refined))
        for family in order:
            if nearest <= agreed or (nearest < np.inf and family.element == rung.family.element):
                break
            if family != rung.family:
                pilot = self.search.run(replace(rung, family=family), 6 * self._seconds(rung))
                if pilot.ok:
                    nearest = min(nearest, distance(pilot.values, lead.exact, scale))
        if agreed < nearest < np.inf:
            lead.own = max(lead.own, nearest / 2)
        return lead.own <= BEST * self.search.tol

    def _seconds(self, rung: Rung) -> float:
        pilot = self.search.pilots.known(self.search.choice(rung))
        return pilot.seconds + 0.02 if pilot else np.inf

    def _refined(self, climb: Climb) -> Rung:
        """Double the elements along the sides whose error dominates."""
        rung = climb.next
        errors = {at: side.error for at, side in climb.sides.items()}
        if np.isinf(climb.own) or max(errors.values()) <= _SMALL_SIDE * self.search.tol:
            return _doubled(rung)
        worst = max(errors.values())
        for at, error in errors.items():
            if error >= _DOMINANT * worst and error > _SMALL_SIDE * self.search.tol:
                rung = rung.scaled(at, Fraction(2)) or rung
        return rung


def _count(rung: Rung, side: tuple[int, int]) -> int:
    body, axis = side
    return rung.divisions[body][axis]


def _rate(before: float, after: float) -> float | None:
    if not 0 < before < np.inf or not 0 < after < np.inf:
        return None
    return float(np.log2(before / after))


def _doubled(rung: Rung) -> Rung:
    return replace(rung, divisions=tuple((2 * x, 2 * y) for x, y in rung.divisions))
