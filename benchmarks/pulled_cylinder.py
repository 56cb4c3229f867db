"""Print how the pulled cylinder of docs/shells.md depends on its mesh, which may be finer towards the force.

Run it from any folder: ``python benchmarks/pulled_cylinder.py`` prints the table, ``--write`` puts it into the page. It
takes half a minute.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any, Literal, TypeAlias

import numpy as np
from page import print_or_write
from shells import SCENES, SZE

import ancf

Law: TypeAlias = Literal["paper", "koiter"]

LAWS: tuple[Law, Law] = ("paper", "koiter")
SCENE = tomllib.loads((SCENES / "pulled_cylinder.toml").read_text(encoding="utf-8"))
SHELL = SCENE["body"]["shell"]
CASES = [case for case in SZE if case.scene == "pulled_cylinder"]


def model(curvature: Law, divisions: tuple[int, int], graded: float) -> ancf.Model:
    """Make the cylinder of the scene over two parameters in [0, 1].

    Beside the force the elements are shorter than the mean by the share `graded`, at the far edges longer.
    """
    (_, angle), (_, length) = SHELL["angle"], SHELL["length"]

    def along(s: Any) -> Any:
        return (1 - graded) * s + graded * s * s

    def position(x: Any, y: Any) -> tuple[Any, Any, Any]:
        turn = angle * (1 - along(1 - x))
        return SHELL["radius"] * np.cos(turn), SHELL["radius"] * np.sin(turn), length * along(y)

    shell = ancf.Surface(
        domain=((0.0, 1.0), (0.0, 1.0)),
        position=position,
        divisions=divisions,
        thickness=SHELL["thickness"],
        material=ancf.Material(**SCENE["material"]["shell"]),
        curvature=curvature,
    )
    places = {"A": (1.0, 0.0), "B": (0.0, 0.0), "C": (0.0, 1.0)}
    return ancf.Model(
        bodies={"shell": shell},
        supports=[ancf.Support(**support) for support in SCENE["support"]],
        loads=[ancf.Force(at="corner:x1y0", force=SCENE["load"][0]["force"])],
        probes=[ancf.Probe(name=name, at=at, quantity="displacement") for name, at in places.items()],
    )


def differences(result: ancf.Result) -> str:
    """Cells of what A, B and C differ by at full load."""
    found = [float(result.probes[case.probe].value[-1, case.component]) for case in CASES]
    return " | ".join(f"{value / case.published - 1:+.2%}" for value, case in zip(found, CASES, strict=True))


def meshes() -> Iterator[str]:
    """Lines of the table of meshes, at full load."""
    yield "| curvature | mesh | shorter at A by | A, y | B, x | C, x |"
    yield "|---|---|---|---|---|---|"
    for curvature in LAWS:
        for divisions, graded in (((24, 16), 0.0), ((24, 16), 0.4), ((24, 16), 0.6), ((48, 32), 0.0), ((48, 32), 0.5)):
            result = ancf.solve_static(model(curvature, divisions, graded))
            yield f"| {curvature} | {divisions[0]} x {divisions[1]} | {graded:.0%} | {differences(result)} |"


if __name__ == "__main__":
    print_or_write("the pulled cylinder", "shells.md", pulled_meshes=meshes())
