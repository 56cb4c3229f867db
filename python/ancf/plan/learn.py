"""What a rung on the way up tells: differences and rates along its sides, extrapolated values and their error."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from ancf.plan.climb import Climb
from ancf.plan.errors import RATES, Side, distance, scales
from ancf.plan.ladder import Rung
from ancf.plan.search import Search

COMPARED = 32
"""Elements up to which a rung is compared with neighbours that are coarser along one side."""
_PAIR, _CANCELLED = 2, 1.5
"""Sides whose changes are told apart, and times what they change together from which on they have cancelled."""
_TRUST = 0.5
"""Part of the error that remains when it is extrapolated, or when another element comes to the same."""


def learn(search: Search, climb: Climb) -> None:
    """Set the finest rung, what is known along its sides, the extrapolated values and what they lack.

    Small rungs are compared with their neighbours that are coarser along one side. Of larger ones only the last
    rung is at hand: its difference is shared out along the sides that were refined as the errors were before, unless
    what two of them changed has cancelled once.
    """
    rung, last = climb.next, climb.rung
    values, own = search.values(rung), search.pilots.known(search.choice(rung))
    assert values is not None
    # A coarser mesh that takes longer has trouble on its way, and tells little.
    limit = np.inf if own is None else own.seconds + 0.02
    scale = scales(values)
    before = dict(climb.sides)
    refined = [side for side in rung.sides() if last is None or _count(rung, side) > _count(last, side)]
    if last is None or rung.elements <= COMPARED:
        for side in rung.sides():
            half = rung.scaled(side, Fraction(1, 2))
            if half is None:
                continue
            pilot = search.run(half, limit)
            coarse = pilot.values if pilot.ok else None if last is None else search.values(last)
            if coarse is None:
                continue
            difference = distance(values, coarse, scale)
            old = before.get(side)
            rate = old.rate if old else None
            if old is not None and side in refined:
                rate = old.rate_to(difference)
            climb.sides[side] = Side(difference, rate)
    else:
        coarse = search.values(last)
        assert coarse is not None
        total = distance(values, coarse, scale)
        expected = {side: before[side].error for side in refined if side in before}
        share = sum(expected.values())
        parts = _parts(search, rung, last) if climb.apart else {}
        for side in refined:
            part = parts.get(side, total * expected.get(side, 0.0) / share if share else total)
            climb.sides[side] = Side(part, before[side].rate_to(part) if side in before else None)
    climb.rung, climb.last, climb.exact, climb.refined = rung, last, values, last is not None
    # Nothing is known of a side along which no coarser rung reached its end.
    known = all(side in climb.sides for side in rung.sides())
    together = max if climb.apart else sum
    climb.own = together(side.error for side in climb.sides.values()) if known else np.inf
    if last is not None and refined and all(climb.sides[side].steady for side in refined if side in climb.sides):
        _extrapolate(search, climb, last, scale, refined)
        _agree(search, climb, scale)


def separate(search: Search, climb: Climb) -> None:
    """Tell what two sides of a large mesh that were refined at once have changed: it may have cancelled."""
    rung, last = climb.rung, climb.last
    if rung is None or last is None or rung.elements <= COMPARED or climb.apart:
        return
    parts = _parts(search, rung, last)
    values, coarse = search.values(rung), search.values(last)
    if not parts or values is None or coarse is None:
        return
    if sum(parts.values()) > _CANCELLED * distance(values, coarse, scales(values)):
        climb.sides.update({side: Side(part, None) for side, part in parts.items()})
        # Of opposite signs, the larger one bounds both together.
        climb.own = max(climb.own, *(side.error for side in climb.sides.values()))
        climb.exact, climb.apart = values, True


def _parts(search: Search, rung: Rung, last: Rung) -> dict[tuple[int, int], float]:
    """Return what each of two sides has changed; the rung between, finer along one of them only, tells it."""
    refined = [side for side in rung.sides() if _count(rung, side) > _count(last, side)]
    between = rung.scaled(refined[0], Fraction(1, 2)) if len(refined) == _PAIR else None
    values, coarse = search.values(rung), search.values(last)
    if between is None or values is None or coarse is None:
        return {}
    pilot = search.run(between, search.pilots.left / 2)
    if not pilot.ok:
        return {}
    scale = scales(values)
    return dict(
        zip(refined, (distance(values, pilot.values, scale), distance(pilot.values, coarse, scale)), strict=True)
    )


def _extrapolate(
    search: Search, climb: Climb, last: Rung, scale: Sequence[float], refined: list[tuple[int, int]]
) -> None:
    """Where the sides refined last converge at a known rate, take out the error that it tells of."""
    rates = [climb.sides[side].rate for side in refined]
    known = [rate for rate in rates if rate is not None]
    coarse = search.values(last)
    if coarse is None or len(known) < len(rates):
        return
    factor = 1.0 / (2.0 ** min(*known, RATES[1]) - 1.0)
    values = climb.exact
    climb.exact = [fine + factor * (fine - old) for fine, old in zip(values, coarse, strict=True)]
    removed = factor * distance(values, coarse, scale)
    climb.own = max(climb.own - (1 - _TRUST) * removed, _TRUST * climb.own)


def _agree(search: Search, climb: Climb, scale: Sequence[float]) -> None:
    """Trust an estimate more where the climb of another element comes to the same."""
    for other in search.climbs:
        if other.refined and other.family.element != climb.family.element:
            apart = distance(other.exact, climb.exact, scale)
            climb.own = min(climb.own, max(2 * apart, _TRUST * climb.own))


def _count(rung: Rung, side: tuple[int, int]) -> int:
    body, axis = side
    return rung.divisions[body][axis]
