"""Moments and shear forces converge as docs/stresses.md says, with numbers that the script prints."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ancf
from ancf.places import EDGES
from ancf.probes import Quantity

ROOT = Path(__file__).parents[1]
GAUSS = 0.5 - 3**-0.5 / 2


@pytest.fixture(scope="module")
def printed() -> str:
    script = ROOT / "benchmarks" / "stresses.py"
    return subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True).stdout


def rows(printed: str, table: int) -> dict[tuple[str, str], list[float]]:
    """Percentages of each quantity and element in a table."""
    lines = printed.strip().split("\n\n")[table].splitlines()[2:]
    cells = [[cell.strip(" `") for cell in line.split("|")[1:-1]] for line in lines]
    element = 2 if table == 0 else 1
    return {(row[0], row[element]): [abs(float(cell.rstrip("%"))) for cell in row[element + 1 :]] for row in cells}


def test_the_page_shows_what_the_script_prints(printed: str, assert_shown: Callable[[Path, str, str], None]) -> None:
    for mark, table in zip(("convergence", "places"), printed.strip().split("\n\n"), strict=True):
        assert_shown(ROOT / "docs" / "stresses.md", mark, table)


def test_everything_is_of_second_order(printed: str) -> None:
    """A halved mesh leaves a quarter, or at least a third, of the error; one digit is printed."""
    for name, (_, coarse, fine, finest) in rows(printed, 0).items():
        assert fine <= coarse / 3 + 0.05, name
        assert finest <= fine / 3 + 0.05, name
        assert finest <= 0.3, name


def test_moments_are_best_at_gauss_points_and_shear_in_the_middles(printed: str) -> None:
    for (name, element), (nodes, middles, gauss, samples) in rows(printed, 1).items():
        if name.endswith((": Mx", ": M")):
            assert gauss < min(nodes, samples) / 3, (name, element)
        elif name.endswith(": Qx"):
            assert middles <= 0.1, (name, element)
            assert nodes < 1.5, (name, element)


@pytest.mark.parametrize("element", ["thin36", "thin48", "full48a"])
@pytest.mark.parametrize("edge", EDGES)
def test_signs_under_a_moment_at_an_edge(edge: str, element: Any) -> None:
    """A plate without lateral contraction, clamped opposite: E h^3 / 12 kappa = M, stress -+6 M / h^2 at the faces."""
    h, E, M = 0.02, 2e9, 30.0
    across, end = "xy".index(edge[5]), int(edge[6])
    body = ancf.Rectangle(
        size=(1.0, 1.0),
        divisions=(8, 8),
        thickness=h,
        material=ancf.Material(E=E, nu=0.0),
        element=element,
    )
    model = ancf.Model(
        bodies={"plate": body},
        supports=[ancf.Support(at=f"edge:{edge[5]}{1 - end}", clamp=True)],
        loads=[ancf.Moment(at=edge, per_length=M)],
    )
    result = ancf.solve_static(model)
    points = [(0.375 + 0.125 * GAUSS, 0.375 + 0.125 * GAUSS)]

    def found(quantity: Quantity) -> float:
        return float(result.evaluate("plate", points, quantity)[-1, 0, across])

    # Towards the normal, Z at rest: the free edge goes up.
    assert (
        result.evaluate("plate", [(0.5 + (end - 0.5) * (1 - across), 0.5 + (end - 0.5) * across)], "displacement")[
            -1, 0, 2
        ]
        > 0
    )
    if element != "full48a":  # which locks
        assert found("curvature") == pytest.approx(12 * M / (E * h**3), rel=5e-3)
    assert found("moment") == pytest.approx(M, rel=5e-3)
    assert found("stress_top") == pytest.approx(-6 * M / h**2, rel=5e-3)
    assert found("stress_bottom") == pytest.approx(6 * M / h**2, rel=5e-3)


@pytest.mark.parametrize(
    ("element", "membrane"), [("thin36", "full"), ("thin48", "full"), ("full48a", None), ("full48b", None)]
)
def test_membrane_forces_away_from_a_clamp_are_in_equilibrium(element: Any, membrane: Any) -> None:
    """Cuts through a strip under tension; the gradients of the clamp leave no strain at its nodes."""
    body = ancf.Rectangle(
        size=(1.0, 0.4),
        divisions=(8, 2),
        thickness=0.01,
        material=ancf.Material(E=2e11, nu=0.3),
        element=element,
        membrane=membrane,
    )
    model = ancf.Model(
        bodies={"strip": body},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(5000.0, 0.0, 0.0))],
    )
    result = ancf.solve_static(model)
    at, weight = np.polynomial.legendre.leggauss(3)
    y = np.concatenate([0.1 + 0.1 * at, 0.3 + 0.1 * at])

    def carried(x: float) -> float:
        forces = result.evaluate("strip", [(x, place) for place in y], "membrane_force")[-1, :, 0]
        return float(np.tile(0.1 * weight, 2) @ forces)

    assert abs(carried(0.0)) < 0.01 * 2000.0
    for row in range(2, 8):
        assert carried((row + 0.5) / 8) == pytest.approx(2000.0, rel=5e-3)
