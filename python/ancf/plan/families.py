"""Families: which of each element is refined."""

from __future__ import annotations

from ancf.plan.asked import changes
from ancf.plan.errors import Values, distance, scales
from ancf.plan.ladder import Family, Rung
from ancf.plan.search import Search


def to_refine(search: Search) -> list[Family]:
    """Return of each element the family that changes least when a coarse mesh is refined and agrees with others.

    Agreement matters because what locks hardly changes either.
    """
    coarse, fine = (_of_families(search, factor) for factor in (1, 2))
    if not fine:
        return []
    # On one element between clamped edges nothing moves.
    for values in fine.values():
        changes(values, search.pilots.want)
    scale = [max(sizes) for sizes in zip(*(scales(values) for values in fine.values()), strict=True)]
    doubts = {family: _doubt(family, coarse, fine, scale) for family in fine}
    elements = dict.fromkeys(family.element for family in fine)
    return [
        min((family for family in fine if family.element == element), key=doubts.__getitem__) for element in elements
    ]


def _of_families(search: Search, factor: int) -> dict[Family, Values]:
    """Return the wanted quantities of all families on one mesh that reach their end in time."""
    found: dict[Family, Values] = {}
    cheapest = search.pilots.left / 8
    rungs = [Rung(family, tuple((factor * x, factor * y) for x, y in search.base)) for family in search.families]
    for rung in rungs:
        pilot = search.run(rung, 3 * cheapest + 0.02)
        if pilot.ok:
            found[rung.family] = pilot.values
            cheapest = min(cheapest, pilot.seconds)
    return found


def _doubt(family: Family, coarse: dict[Family, Values], fine: dict[Family, Values], scale: list[float]) -> float:
    """Return how far a family is from its coarse mesh and, together, from the nearest other family, relative."""
    change = distance(coarse[family], fine[family], scale) if family in coarse else 1.0
    others = [distance(fine[family], values, scale) for other, values in fine.items() if other != family]
    return change + min(others, default=0.0)
