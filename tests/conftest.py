"""What several tests need."""

import os
import re
from collections.abc import Callable
from itertools import chain
from pathlib import Path

import pytest

# Before NumPy: its matrices are small here, and its threads only wait for each other on a busy machine.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import ancf


@pytest.fixture
def scenes() -> Path:
    """The folder of scene files."""
    return Path(__file__).parent / "scenes"


@pytest.fixture
def edit(scenes: Path, tmp_path: Path) -> Callable[..., Path]:
    """Copy a scene file with some of its text replaced."""

    def copy(name: str, *replacements: tuple[str, str]) -> Path:
        text = (scenes / name).read_text(encoding="utf-8")
        for old, new in replacements:
            assert text.count(old) == 1
            text = text.replace(old, new)
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return copy


@pytest.fixture
def rubber() -> ancf.Material:
    return ancf.Material(E=1e5, nu=0.3, density=7810.0)


@pytest.fixture
def pendulum(rubber: ancf.Material) -> ancf.Model:
    """The scene pendulum.toml in Python."""
    plate = ancf.Rectangle(
        size=(0.3, 0.3), divisions=(2, 2), thickness=0.01, material=rubber, membrane="full", curvature="paper"
    )
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
        probes=[ancf.Probe(name="A", at=(0.3, 0.3))],
    )


@pytest.fixture
def assert_shown() -> Callable[[Path, str, str], None]:
    """Compare the table between the marks of a page with what a script prints, up to the last digit of percentages.

    Instruction sets round differently.
    """

    def cells(text: str) -> list[list[str]]:
        return [[cell.strip() for cell in line.split("|")] for line in text.strip().splitlines()]

    def compare(page: Path, mark: str, printed: str) -> None:
        match = re.search(rf"<!-- {mark} -->\n(.*?)<!-- /{mark} -->", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        assert match is not None
        shown, found = cells(match[1]), cells(printed)
        assert [len(row) for row in shown] == [len(row) for row in found]
        for known, new in zip(chain(*shown), chain(*found), strict=True):
            if known.endswith("%"):
                digit = 10.0 ** -len(known[:-1].partition(".")[2])
                assert abs(float(known[:-1]) - float(new[:-1])) < 1.5 * digit, f"{new}, shown {known}"
            else:
                assert new == known

    return compare
