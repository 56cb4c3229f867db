"""Print what the differences of the pulled cylinder in docs/shells.md come from: its mesh, its measure of curvature.

Run it from any folder: ``python benchmarks/pulled_cylinder.py`` prints the tables, ``--write`` puts them into the page.
It takes half a minute.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from page import print_or_write
from shells import SCENES, SZE, solve

import ancf

FloatArray = NDArray[np.float64]
Law: TypeAlias = Literal["paper", "koiter"]

LAWS: tuple[Law, Law] = ("paper", "koiter")
SCENE = tomllib.loads((SCENES / "pulled_cylinder.toml").read_text(encoding="utf-8"))
SHELL = SCENE["body"]["shell"]
CASES = [case for case in SZE if case.scene == "pulled_cylinder"]

PATH = {
    0.4: (2.376, -3.443, -3.632),
    0.5: (2.473, -3.653, -3.718),
    0.525: (2.543, -4.061, -3.580),
    0.55: (2.577, -4.171, -3.518),
    0.6: (2.618, -4.274, -3.452),
    0.8: (2.710, -4.455, -3.332),
}
"""Published displacements of A, B and C at fractions of the load; Sze, Liu and Lo (2004)."""


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


def displacements(result: ancf.Result) -> FloatArray:
    """Return the displacements of A, B and C, shape (states, 3)."""
    return np.stack([result.probes[case.probe].value[:, case.component] for case in CASES], axis=1)


def cells(found: FloatArray, published: Sequence[float]) -> str:
    """Cells of relative differences."""
    return " | ".join(f"{value / of - 1:+.2%}" for value, of in zip(found, published, strict=True))


def meshes() -> Iterator[str]:
    """Lines of the table of meshes, at full load."""
    yield "| curvature | mesh | shorter at A by | A, y | B, x | C, x |"
    yield "|---|---|---|---|---|---|"
    for curvature in LAWS:
        for divisions, graded in (((24, 16), 0.0), ((24, 16), 0.4), ((24, 16), 0.6), ((48, 32), 0.0), ((48, 32), 0.5)):
            result = ancf.solve_static(model(curvature, divisions, graded))
            found = cells(displacements(result)[-1], [case.published for case in CASES])
            yield f"| {curvature} | {divisions[0]} x {divisions[1]} | {graded:.0%} | {found} |"


def path() -> Iterator[str]:
    """Lines of the table of the path, on the mesh of the scene."""
    yield f"| load | {' | '.join(f'A, {law} | B, {law} | C, {law}' for law in LAWS)} |"
    yield f"|---|{'---|' * 3 * len(LAWS)}"
    run = SCENE["run"] | {"load_factors": list(PATH)}
    found = {}
    for law in LAWS:
        body = {"shell": SHELL | {"curvature": law}}
        result = solve(ancf.Scene.of(SCENE | {"body": body, "run": run}))
        found[law] = displacements(result)[np.searchsorted(result.t, list(PATH))]
    for row, (factor, published) in enumerate(PATH.items()):
        yield f"| {factor:g} | {' | '.join(cells(found[law][row], published) for law in LAWS)} |"


if __name__ == "__main__":
    print_or_write("the pulled cylinder", "shells.md", pulled_meshes=meshes(), pulled_path=path())
