"""Print how moments and shear forces converge, and where in an element they are accurate: docs/stresses.md.

Run it from any folder: ``python benchmarks/stresses.py`` prints the tables, ``--write`` puts them into the page. It
takes some seconds.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from page import print_or_write

import ancf

ROOT = Path(__file__).resolve().parents[1]
ROLL_UP = ROOT / "examples" / "shells" / "cantilever_moment.toml"

Element: TypeAlias = Literal["thin36", "thin48"]
FloatArray = NDArray[np.float64]
ELEMENTS: tuple[Element, ...] = ("thin36", "thin48")
MESHES = (4, 8, 16, 32)
NU = 0.3
FACTOR = 1e-5
"""Of the load: the answer is the linear one."""


@cache
def plate(element: Element, divisions: int, *, clamped: bool) -> ancf.Result:
    """Solve a unit square under a load of 1 per area, bending stiffness 1, on hinges or clamped."""
    h = 1e-2
    body = ancf.Rectangle(
        size=(1.0, 1.0),
        divisions=(divisions, divisions),
        thickness=h,
        material=ancf.Material(E=12 * (1 - NU**2) / h**3, nu=NU, density=1 / h),
        element=element,
    )
    vectors = ["r", "r_x", "r_y", *(["r_xy"] if element == "thin48" else [])]
    supports = [ancf.Support(at="all", fix=[f"{vector}.{axis}" for vector in vectors for axis in "xy"])]
    for x, y in ("xy", "yx"):
        for edge in (f"edge:{x}0", f"edge:{x}1"):
            along = [vector for vector in vectors if clamped or vector in ("r", f"r_{y}")]
            supports.append(ancf.Support(at=edge, fix=[f"{vector}.z" for vector in along]))
    load = ancf.Gravity(acceleration=(0.0, 0.0, -1.0))
    model = ancf.Model(bodies={"plate": body}, supports=supports, loads=[load])
    return ancf.solve_static(model, load_factors=[FACTOR], tolerance=1e-12)


def found(
    result: ancf.Result, quantity: Literal["moment", "shear_force"], component: int, at: FloatArray
) -> FloatArray:
    """Return a component at points, per load."""
    values: FloatArray = result.evaluate("plate", at, quantity)[-1, :, component] / FACTOR
    return values


def navier(at: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return Mx, Mxy and Qx of the plate on hinges, up to their signs, by double sine series.

    S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells (1959), section 28.
    """
    m: FloatArray = np.pi * np.arange(1.0, 400.0, 2.0)
    p, q = m[:, None], m[None, :]
    amplitude = 16 / (p * q * (p**2 + q**2) ** 2)
    x, y = (np.outer(coordinate, m) for coordinate in at.T)

    def series(factor: NDArray[Any], along_x: FloatArray, along_y: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("kp,pq,kq->k", along_x, amplitude * factor, along_y))

    return (
        series(p**2 + NU * q**2, np.sin(x), np.sin(y)),
        series((1 - NU) * p * q, np.cos(x), np.cos(y)),
        series(p * (p**2 + q**2), np.cos(x), np.sin(y)),
    )


MIDDLE, SIDE, CORNER = (np.array([point]) for point in ((0.5, 0.5), (0.0, 0.5), (0.0, 0.0)))


def moment(*, clamped: bool, component: int, at: FloatArray) -> Callable[[Element, int], float]:
    """Make a function that returns a moment."""
    return lambda element, n: float(found(plate(element, n, clamped=clamped), "moment", component, at)[0])


def edge_shear(element: Element, n: int) -> float:
    """Return the shear force at the middle of a side."""
    return float(found(plate(element, n, clamped=False), "shear_force", 0, SIDE)[0])


CASES: tuple[tuple[str, float, Callable[[Element, int], float]], ...] = (
    ("clamped: Mx in the middle", 0.0229051, moment(clamped=True, component=0, at=MIDDLE)),
    ("clamped: Mx in the middle of a side", 0.0513338, moment(clamped=True, component=0, at=SIDE)),
    ("hinges: Mx in the middle", float(navier(MIDDLE)[0][0]), moment(clamped=False, component=0, at=MIDDLE)),
    ("hinges: Mxy in a corner", float(navier(CORNER)[1][0]), moment(clamped=False, component=2, at=CORNER)),
    ("hinges: Qx in the middle of a side", float(navier(SIDE)[2][0]), edge_shear),
)
"""Clamped: R. L. Taylor, S. Govindjee, Commun. Numer. Meth. Eng. 20 (2004) 757-765."""


def convergence() -> Iterator[str]:
    """Lines of the table over meshes."""
    yield f"| plate | known | element | {' | '.join(f'{n} x {n}' for n in MESHES)} |"
    yield "|---|---|---" + "|---" * len(MESHES) + "|"
    for name, known, solve in CASES:
        for element in ELEMENTS:
            differences = " | ".join(f"{abs(solve(element, n)) / known - 1:+.1%}" for n in MESHES)
            yield f"| {name} | {known:.5g} | `{element}` | {differences} |"


GAUSS = [(1 + sign / np.sqrt(3)) / 2 for sign in (-1, 1)]
PLACES = {"nodes": [(0.0, 0.0)], "middles": [(0.5, 0.5)], "2 x 2 Gauss points": [(a, b) for a in GAUSS for b in GAUSS]}
"""Places in an element, in its sides."""


def all_places(model: ancf.Model, body: str, divisions: tuple[int, int]) -> Iterator[FloatArray]:
    """Return the natural coordinates of these places in all elements, and those of the samples."""
    low, high = np.array(model.domain(body)).T
    side = (high - low) / divisions
    corner = np.stack(np.meshgrid(*map(np.arange, divisions)), axis=-1).reshape(-1, 1, 2)
    for at in PLACES.values():
        yield (low + (corner + np.array(at)) * side).reshape(-1, 2)
    yield model.samples(body).reshape(-1, 2)


def places() -> Iterator[str]:
    """Lines of the table over places in an element: root of the mean square of all errors, by the largest value."""
    yield f"| quantity | element | {' | '.join(PLACES)} | `Model.samples` |"
    yield "|---" * (len(PLACES) + 3) + "|"
    quantities: tuple[tuple[str, Literal["moment", "shear_force"], int, int], ...] = (
        ("hinges, 16 x 16: Mx", "moment", 0, 0),
        ("hinges, 16 x 16: Mxy", "moment", 2, 1),
        ("hinges, 16 x 16: Qx", "shear_force", 0, 2),
    )
    for name, quantity, component, series in quantities:
        for element in ELEMENTS:
            result = plate(element, 16, clamped=False)
            errors = []
            for at in all_places(result.model, "plate", (16, 16)):
                known, values = navier(at)[series], found(result, quantity, component, at)
                # Signs are a matter of definition.
                values *= np.sign(np.dot(values, known))
                errors.append(np.sqrt(np.mean((values - known) ** 2)) / np.abs(known).max())
            yield f"| {name} | `{element}` | {' | '.join(f'{error:.2%}' for error in errors)} |"
    for element in ELEMENTS:
        document = tomllib.loads(ROLL_UP.read_text(encoding="utf-8"))
        document["body"]["strip"] |= {"element": element, "divisions": [12, 1]}
        rolled = ancf.Scene.of(document).solve()
        known = document["load"][0]["per_length"]
        moments = [rolled.evaluate("strip", at, "moment")[-1] for at in all_places(rolled.model, "strip", (12, 1))]
        errors = [np.sqrt(np.mean((np.abs(moment[:, 0]) / known - 1) ** 2)) for moment in moments]
        yield f"| roll-up, 12 x 1: M | `{element}` | {' | '.join(f'{error:.2%}' for error in errors)} |"


if __name__ == "__main__":
    print_or_write(
        "moments and shear forces of plates against their series",
        "stresses.md",
        convergence=convergence(),
        places=places(),
    )
