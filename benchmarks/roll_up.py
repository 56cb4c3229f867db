"""Print by how much a strip that an end moment rolls up turns too far, and why: a table of docs/shells.md.

The strip is that of `examples/shells/cantilever_moment.toml`. Run it from any folder: ``python benchmarks/roll_up.py``
prints, ``--write`` puts the table into the page. It takes some seconds.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any

import numpy as np
from page import print_or_write
from shells import SCENES, solve

import ancf

SCENE = tomllib.loads((SCENES / "cantilever_moment.toml").read_text(encoding="utf-8"))
STRIP = SCENE["body"]["strip"]

CHANGES: list[dict[str, Any]] = [
    {},
    {"divisions": [64, 1]},
    {"divisions": [32, 4]},
    {"element": "thin48", "divisions": [16, 1]},
    {"element": "thin48", "divisions": [32, 4]},
]
"""What is changed in the body of the scene."""


def excess(changes: dict[str, Any]) -> float:
    """Return by what share of 2 pi the middle of the loaded edge turns too far."""
    result = solve(ancf.Scene.of(SCENE | {"body": {"strip": STRIP | changes}}))
    length, width = STRIP["size"]
    place = (length, width / 2)
    # The last half a percent of the strip is straight to 1e-4 of the angle that it has turned by.
    near = (length * (1 - 1e-3), width / 2)
    end, before = result.positions("strip", [place, near])[-1]
    turned = np.arctan2(*(end - before)[[2, 0]])
    return float((turned + np.pi * 1e-3) / (2 * np.pi))


def table() -> Iterator[str]:
    """Lines of the table."""
    length, _ = STRIP["size"]
    strain = STRIP["thickness"] ** 2 / 12 * (2 * np.pi / length) ** 2
    yield (
        "| curvature | of the law | "
        + " | ".join(
            f"`{changes.get('element', 'thin36')}` {' x '.join(map(str, changes.get('divisions', STRIP['divisions'])))}"
            for changes in CHANGES
        )
        + " |"
    )
    yield "|---|---|" + "---|" * len(CHANGES)
    for curvature, multiple in (("paper", 10), ("koiter", 2)):
        found = " | ".join(f"{excess(changes | {'curvature': curvature}):+.3%}" for changes in CHANGES)
        yield f"| {curvature} | {multiple * strain:+.3%} | {found} |"


if __name__ == "__main__":
    print_or_write("how far a rolled strip turns", "shells.md", roll_up=table())
