"""Families: which of each element is refined."""

from __future__ import annotations

import numpy as np

from ancf.plan.asked import changes
from ancf.plan.errors import Values, distance, scales
from ancf.plan.ladder import Family, Rung
from ancf.plan.search import Search


def to_refine(search: Search) -> list[Family]:
    """Return of each element the family that changes least when a coarse mesh is refined and agrees with others.

    Agreement matters because what locks hardly changes either.
    """
    fine = _of_families(search, 2, 3.0 * search.pilots.left / 8)
    if not fine:
        return []
    # A coarse mesh that takes longer than a fine one has trouble on its way, and tells little.
    done = (search.pilots.known(search.choice(_rung(search, family, 2))) for family in fine)
    coarse = _of_families(search, 1, min((pilot.seconds for pilot in done if pilot), default=np.inf))
    # On one element between clamped edges nothing moves.
    for values in fine.values():
        changes(values, search.pilots.want)
    scale = [max(sizes) for sizes in zip(*(scales(values) for values in fine.values()), strict=True)]
    doubts = {family: _doubt(family, coarse, fine, scale) for family in fine}
    elements = dict.fromkeys(family.element for family in fine)
    return [
        min((family for family in fine if family.element == element), key=doubts.__getitem__) for element in elements
    ]


def _of_families(search: Search, factor: int, limit: float) -> dict[Family, Values]:
    """Return the wanted quantities of all families on one mesh that reach their end in time."""
    found: dict[Family, Values] = {}
    for family in search.families:
        pilot = search.run(_rung(search, family, factor), limit + 0.02)
        if pilot.ok:
            found[family] = pilot.values
            limit = min(limit, 3 * pilot.seconds)
    return found


def _rung(search: Search, family: Family, factor: int) -> Rung:
    return Rung(family, tuple((factor * x, factor * y) for x, y in search.base))


def _doubt(family: Family, coarse: dict[Family, Values], fine: dict[Family, Values], scale: list[float]) -> float:
    """Return how far a family is from its coarse mesh and, together, from the nearest other family, relative."""
    change = distance(coarse[family], fine[family], scale) if family in coarse else 1.0
    others = [distance(fine[family], values, scale) for other, values in fine.items() if other != family]
    return change + min(others, default=0.0)
