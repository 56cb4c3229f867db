"""Moments and shear forces converge as docs/stresses.md says, with numbers that the script prints."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


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
