"""Modes of shells and of loaded structures: the page shows what the script prints, and it is near what is known."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# Largest differences in percent: thin36, thin48.
CLOSE = {
    "rotating beam": (0.02, 0.02),
    "loaded plate": (1.9, 0.02),
    "cylinder on diaphragms": (0.3, 0.12),
    "free cylinder": (0.05, 0.05),
}


@pytest.fixture(scope="module")
def printed() -> str:
    script = ROOT / "benchmarks" / "modes.py"
    return subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True).stdout


def test_the_page_shows_what_the_script_prints(printed: str, assert_shown: Callable[[Path, str, str], None]) -> None:
    assert_shown(ROOT / "docs" / "modes.md", "modes", printed)


@pytest.mark.parametrize("structure", list(CLOSE))
def test_frequencies_are_near_the_known_ones(structure: str, printed: str) -> None:
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in printed.splitlines()[2:]]
    found = {mode: differences for name, mode, _, *differences in rows if name == structure}
    assert len(found) >= 4
    for mode, differences in found.items():
        for difference, most in zip(differences, CLOSE[structure], strict=True):
            assert abs(float(difference.rstrip("%"))) <= most, mode
