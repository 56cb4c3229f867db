"""Print how far two shells of docs/shells.md are from their published paths, not only at full load.

Run it from any folder: ``python benchmarks/paths.py`` prints the tables, ``--write`` puts them into the page. It takes
a minute.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from page import print_or_write
from shells import SCENES, SZE, solve

import ancf

PULLED = {
    0.4: (2.376, -3.443, -3.632),
    0.5: (2.473, -3.653, -3.718),
    0.525: (2.543, -4.061, -3.580),
    0.55: (2.577, -4.171, -3.518),
    0.6: (2.618, -4.274, -3.452),
    0.8: (2.710, -4.455, -3.332),
}
"""Displacements of A, B and C of the pulled cylinder at fractions of the load; Sze, Liu and Lo (2004)."""

HALF = {
    0.05: (-0.05421,),
    0.1: (-0.16100,),
    0.2: (-0.37582,),
    0.3: (-0.66410,),
    0.325: (-0.79810,),
    0.35: (-0.94669,),
    0.4: (-1.13704,),
    0.7: (-1.52863,),
}
"""Displacements of A of the pinched half cylinder; Sze, Liu and Lo (2004)."""

LAWS: list[dict[str, Any]] = [{}, {"curvature": "koiter"}]
BICUBIC: dict[str, Any] = {"curvature": "koiter", "element": "thin48"}


def table(name: str, published: Mapping[float, tuple[float, ...]], variants: list[dict[str, Any]]) -> Iterator[str]:
    """Lines of the table of one scene with changes in its body."""
    document = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
    ((body, keys),) = document["body"].items()
    cases = [case for case in SZE if case.scene == name]
    factors = list(published)
    columns, heads = [], []
    for changes in variants:
        run = document["run"] | {"load_factors": factors}
        result = solve(ancf.Scene.of(document | {"body": {body: keys | changes}, "run": run}))
        rows = np.searchsorted(result.t, factors)
        for case, of in zip(cases, np.transpose(list(published.values())), strict=True):
            columns.append(result.probes[case.probe].value[rows, case.component] / of - 1)
            heads.append(", ".join([case.probe, *(f"{key} {value}" for key, value in changes.items())]))
    yield f"| load | {' | '.join(heads)} |"
    yield f"|---|{'---|' * len(heads)}"
    for factor, row in zip(factors, np.transpose(columns), strict=True):
        yield f"| {factor:g} | {' | '.join(f'{difference:+.2%}' for difference in row)} |"


if __name__ == "__main__":
    print_or_write(
        "shells along their paths",
        "shells.md",
        pulled_path=table("pulled_cylinder", PULLED, LAWS),
        half_path=table("pinched_half_cylinder", HALF, [*LAWS, BICUBIC, BICUBIC | {"divisions": [64, 64]}]),
    )
