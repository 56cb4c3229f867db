"""Shells of linear theory against published displacements: the page shows what the script prints, the scenes hold."""

import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

import ancf

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "examples" / "linear_shells"

# Thin shell theory, where it is known to more digits than what is published (docs/linear-shells.md), and how far the
# scenes with 16 x 16 elements may be off.
SCENE = {
    "scordelis_lo_roof": (1, -0.3006, 0.002),
    "pinched_cylinder": (1, -1.8248e-5, 0.015),
    "pinched_hemisphere_hole": (0, 0.0935, 0.002),
    "pinched_hemisphere": (0, 0.0924, 0.005),
}

# How far the finest meshes may be off what is published, in percent: thin36 projected, thin48 koiter.
FINEST = {
    "Scordelis-Lo roof": (0.75, 0.65),
    "pinched cylinder": (1.0, 0.1),
    "hemisphere with a hole": (0.55, 0.55),
    "hemisphere": (0.1, 0.02),
    "twisted beam, in the plane": (0.5, 0.5),
    "twisted beam, out of it": (0.5, 0.5),
    "thin twisted beam, in the plane": (0.15, 0.15),
    "thin twisted beam, out of it": (0.1, 0.1),
    "saddle, 1/1000": (0.75, 0.6),
    "saddle, 1/10000": (6.0, 2.1),
    "Raasch's hook": (4.6, 4.6),
}


@pytest.mark.parametrize("name", list(SCENE))
def test_a_scene(name: str) -> None:
    result = ancf.load_scene(SCENES / f"{name}.toml").solve()
    component, published, tolerance = SCENE[name]
    assert result.probes["A"].value[-1, component] / result.reached == pytest.approx(published, rel=tolerance)


def test_every_scene_is_here() -> None:
    assert {path.stem for path in SCENES.iterdir()} == set(SCENE)


def test_the_page_shows_what_the_script_prints_and_it_is_near_what_is_published(
    assert_shown: Callable[[Path, str, str], None],
) -> None:
    script = ROOT / "benchmarks" / "linear_shells.py"
    printed = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True).stdout
    assert_shown(ROOT / "docs" / "linear-shells.md", "linear", printed)
    rows = [[cell.strip(" `") for cell in line.split("|")[1:-1]] for line in printed.splitlines()[2:]]
    finest = {(row[0], *row[2:5]): abs(float(row[-1].rstrip("%"))) for row in rows}
    for name, (thin36, thin48) in FINEST.items():
        assert finest[name, "thin36", "projected", "paper"] <= thin36, name
        assert finest[name, "thin48", "projected", "koiter"] <= thin48, name
    assert {name for name, *_ in finest} == set(FINEST)


def test_a_plane_of_symmetry_holds_the_twist_of_thin48() -> None:
    """Without it the slope across the edge is held at the nodes only, and the cylinder is far too soft."""
    document = tomllib.loads((SCENES / "pinched_cylinder.toml").read_text(encoding="utf-8"))
    document["body"]["shell"]["element"] = "thin48"
    held = ancf.Scene.of(document).solve()
    for support, axis in zip(document["support"], "yxz", strict=False):
        assert support.pop("symmetry") == axis
        others = [other for other in "xyz" if other != axis]
        across, along = ("r_x", "r_y") if support["at"][5] == "x" else ("r_y", "r_x")
        support["fix"] = [f"r.{axis}", f"{along}.{axis}", *(f"{across}.{other}" for other in others)]
    loose = ancf.Scene.of(document).solve()
    assert held.probes["A"].value[-1, 1] == pytest.approx(-1.8248e-5, rel=0.01)
    assert loose.probes["A"].value[-1, 1] < -2.2e-5
