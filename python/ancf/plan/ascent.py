"""Up the ladder: families are refined side by side until the error of one is small enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np

from ancf.plan.climb import Climb
from ancf.plan.errors import distance, scales
from ancf.plan.ladder import Choice, Family, Rung, Stepping
from ancf.plan.learn import COMPARED, learn, separate
from ancf.plan.pilots import SLOW, Pilot
from ancf.plan.search import Search
from ancf.plan.timing import SHARE

BEST = 0.3
"""Part of the tolerance below which the finest rung's own error must be."""
_CLEAR, _LITTLE = 0.1, 0.2
"""The same that is tried for while the next rung costs no more than this part of the plan so far."""
_COARSE, _MUCH = 0.35, 0.75
"""And that is enough where the next rung costs more than this part of it."""
_HOPEFUL, _GROWTH = 4.0, 4.0
"""Seconds to the end of a climb, relative to the best, beyond which it takes cheap steps only; and growth of costs with
a doubling."""
_DOMINANT = 0.4
"""A side is refined if its error is at least this part of the largest."""
_SMALL_SIDE = 0.05
"""Part of the tolerance below which a side is not refined further."""
_RECONSIDERED = 1024
"""Elements up to which another family may take over."""
_SHORTER = 5
"""Times that steps are shortened where they cannot be solved."""
_PATIENCE = 2
"""Rungs in a row that may be no better than the one before."""
_AGREED = 0.6
"""Part of the tolerance up to which another element on the finest mesh may be off."""
_OTHERS, _OTHERS_COARSE = 6.0, 2.0
"""Times the seconds of the finest mesh that another element may take there, and on half of the elements along sides."""
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
        search = self.search
        search.climbs = [Climb(_doubled(Rung(family, search.base))) for family in families]
        while (going := [climb for climb in search.climbs if not climb.ended]) and not self._enough():
            lead = search.lead if any(climb.rung for climb in search.climbs) else None
            if lead in going and lead.own <= BEST * search.tol:
                # Only its own error is still to be made smaller.
                going = [lead]
            self._step(self._promising(going))
        reached = any(climb.rung for climb in search.climbs)
        if reached and not going:
            # The error of each may turn out to be larger, so that the other leads.
            for _ in search.climbs:
                separate(search, search.lead)
        return reached

    def _promising(self, going: Sequence[Climb]) -> Climb:
        """Return the climb whose next rung is the cheapest, of those that are not hopeless or cost little.

        What costs little, beside the plan so far or what would be run else, may still tell that the other one is wrong.
        """

        def cost(climb: Climb) -> float:
            return self.search.predict(climb.next) or 0.0

        outlook = {climb.family: self._outlook(climb) for climb in going}
        best = min(going, key=lambda climb: outlook[climb.family])
        little = _LITTLE * max(self.search.pilots.spent, cost(best))
        limit = _HOPEFUL * outlook[best.family]
        return min((c for c in going if cost(c) <= little or outlook[c.family] <= limit), key=cost)

    def _outlook(self, climb: Climb) -> float:
        """Predict the seconds until the error of a climb is small enough, from its errors and costs so far."""
        cost = self.search.predict(climb.next) or 0.0
        if climb.rung is None or not np.isfinite(climb.own):
            return cost
        doublings = np.log2(climb.own / (BEST * self.search.tol)) / climb.rate
        more = np.arange(max(np.ceil(doublings), 1.0))
        return cost * float((_GROWTH**more).sum())

    def _enough(self) -> bool:
        """Tell whether the error of the leading climb is small enough, and trusted.

        What is known better leaves the more room for errors of cheaper rungs: it is refined further while that costs
        little beside the plan so far, and not so far where it costs more than that.
        """
        search = self.search
        if not any(climb.rung for climb in search.climbs):
            return False
        lead = search.lead
        cost = np.inf if lead.ended else search.predict(lead.next) or 0.0
        spent = search.pilots.spent
        part = _CLEAR if cost <= _LITTLE * spent else BEST if cost <= _MUCH * spent else _COARSE
        small = lead.refined and lead.own <= part * search.tol and (lead.ended or not lead.sudden)
        if small:
            separate(search, lead)
        return small and lead.own <= part * search.tol and self._confirmed(search.best, part)

    def _step(self, climb: Climb) -> None:
        """Run the next rung of a climb and learn from it, or end the climb."""
        self._reconsider(climb)
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
            learn(self.search, climb)
            climb.observe(before)
            climb.next = self._refined(climb)
            self._race(rung)
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
        """Before the next rung is run, see that all steppings that were run on the last one agree, or shorten one.

        Steps that are short enough on the coarse mesh, on which they were found, may not be on a finer one, and then
        the error in time would be taken for one in space, or be common to all finer meshes and not be seen at all.
        """
        search, last = self.search, climb.rung
        for _ in range(_SHORTER):
            stepping = search.stepping(climb.next)
            if last is None or stepping is None:
                return
            kinds: dict[object, Stepping] = {}
            for known in search.allowed:
                # The shortest of each kind comes first.
                kinds.setdefault(known.kind, known)
            kinds.pop(stepping.kind)
            done = [search.pilots.known(Choice(last, other)) for other in kinds.values()]
            others = [pilot for pilot in done if pilot is not None]
            if not others:
                return
            own = search.pilots.run(Choice(last, stepping), self._even(climb.next, last))
            if not own.ok:
                if own.outcome != SLOW or len(search.timings) == 1 or search.pilots.left <= 0.0:
                    return
                search.timings.remove(search.timing(climb.next))
                continue
            scale = scales(own.values)
            farthest = max(others, key=lambda pilot: distance(own.values, pilot.values, scale))
            if distance(own.values, farthest.values, scale) <= 2 * SHARE * search.tol:
                return
            self._shorten_one(own, farthest)

    def _even(self, rung: Rung, last: Rung) -> float:
        """Return the seconds on the last rung beyond which the stepping of a rung is not the cheapest there."""
        search, stepping = self.search, self.search.stepping(rung)
        others = [search.predict_with(rung, timing) for timing in search.timings if timing.stepping != stepping]
        here, there = (search.predict_choice(Choice(at, stepping)) for at in (last, rung))
        even = min(others, default=np.inf) * here / there if here and there else np.inf
        return min(_RIVAL * even + 0.02, _AFFORDED * search.pilots.left)

    def _shorten_one(self, *pilots: Pilot) -> None:
        """Of two steppings that disagree on a rung shorten the one that changes more with shorter steps."""
        changes = {}
        for pilot in pilots:
            stepping = pilot.choice.stepping
            assert stepping is not None
            tight = self.search.pilots.run(replace(pilot.choice, stepping=stepping.tighter()))
            changes[stepping] = distance(tight.values, pilot.values, scales(pilot.values)) if tight.ok else 0.0
        worse = max(changes, key=changes.__getitem__)
        self.search.shorten(worse, worse.tighter())

    def _reconsider(self, climb: Climb) -> None:
        """Go on with another family of the element where it is much nearer to what another element tells.

        On coarse meshes what locks hardly changes, so that the wrong family may have been taken.
        """
        rung = climb.rung
        others = [other for other in self.search.climbs if other.refined and not other.sudden and other is not climb]
        if rung is None or rung.elements > _RECONSIDERED or not others:
            return
        judge = min(others, key=lambda other: other.own)
        scale = scales(judge.exact)
        values = self.search.values(rung)
        assert values is not None
        nearest = distance(values, judge.exact, scale)
        if nearest <= max(judge.own, self.search.tol):
            return
        nearest /= 2
        for family in self.search.families:
            if family.element == rung.family.element and family != rung.family:
                other = replace(rung, family=family)
                pilot = self.search.run(other, 2 * self._seconds(rung))
                if pilot.ok and distance(pilot.values, judge.exact, scale) < nearest:
                    nearest = distance(pilot.values, judge.exact, scale)
                    climb.restart(other)

    def _race(self, rung: Rung) -> None:
        """Run a small rung with the other steppings that may be cheaper, and forget those that were much slower.

        An implicit one that is slower than an explicit one is kept: it may be cheaper on finer meshes.
        """
        if rung.elements > COMPARED:
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

    def _confirmed(self, rung: Rung, part: float) -> bool:
        """Check the estimate with another element; if it is far off, half of that may be missing.

        Its climb tells, or else it is run, on half the elements along each side and, if that is not near enough, on the
        same mesh. There one of its families must agree, the one that is refined before those that may lock or be weak.
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
        half = replace(rung, divisions=tuple((max(x // 2, 1), max(y // 2, 1)) for x, y in rung.divisions))
        for family, mesh in product(order, (half, rung)):
            if nearest <= max(agreed, 2 * part * self.search.tol):
                break
            if nearest < np.inf and family.element == rung.family.element:
                break
            if family != rung.family:
                limit = (_OTHERS if mesh == rung else _OTHERS_COARSE) * self._seconds(rung)
                pilot = self.search.run(replace(mesh, family=family), limit)
                off = distance(pilot.values, lead.exact, scale) if pilot.ok else np.inf
                # Half of what the coarse mesh is off may be bearable: then the fine one need not be run.
                if mesh == rung or off <= max(agreed, 2 * part * self.search.tol):
                    nearest = min(nearest, off)
        if agreed < nearest < np.inf:
            lead.own = max(lead.own, nearest / 2)
        return lead.own <= part * self.search.tol

    def _seconds(self, rung: Rung) -> float:
        pilot = self.search.pilots.known(self.search.choice(rung))
        return pilot.seconds + 0.02 if pilot else np.inf

    def _refined(self, climb: Climb) -> Rung:
        """Double the elements along the sides whose error dominates."""
        rung = climb.next
        errors = {at: side.error for at, side in climb.sides.items()}
        sudden = [at for at, side in climb.sides.items() if side.sudden]
        if sudden and climb.own <= BEST * self.search.tol:
            # All that is left is to see whether these errors are as small as they seem.
            for at in sudden:
                rung = rung.scaled(at, Fraction(2)) or rung
            return rung
        if np.isinf(climb.own) or max(errors.values()) <= _SMALL_SIDE * self.search.tol:
            return _doubled(rung)
        worst = max(errors.values())
        for at, error in errors.items():
            if error >= _DOMINANT * worst and error > _SMALL_SIDE * self.search.tol:
                rung = rung.scaled(at, Fraction(2)) or rung
        return rung


def _doubled(rung: Rung) -> Rung:
    return replace(rung, divisions=tuple((2 * x, 2 * y) for x, y in rung.divisions))
