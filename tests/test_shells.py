"""Published shells, solved by their scene files with nothing set by hand.

K. Y. Sze, X. H. Liu, S. H. Lo, Popular benchmark problems for geometric nonlinear analysis of shells, Finite Elem.
Anal. Des. 40 (2004) 1551-1569: displacements of shear-flexible elements at full load. The last number of a case is how
far off it may be: 0.005, but where a thin shell converges to another value or this mesh has not converged
(docs/shells.md).
"""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ancf

SCENES = Path(__file__).parent.parent / "examples" / "shells"

CASES = {
    "cantilever_shear": [("end", 2, 6.698, 0.005), ("end", 0, -3.286, 0.005)],
    "cantilever_moment": [("end", 0, -12.0, 0.005)],
    "slit_annulus": [("A", 2, 13.891, 0.005), ("B", 2, 17.528, 0.005)],
    "pinched_hemisphere": [("outwards", 0, 4.067, 0.005), ("inwards", 1, -8.178, 0.005)],
    "pinched_half_cylinder": [("A", 1, -1.71505, 0.005)],
    "pulled_cylinder": [("A", 1, 2.768, 0.010), ("B", 0, -4.551, 0.005), ("C", 0, -3.269, 0.013)],
}


@pytest.mark.parametrize("name", list(CASES))
def test_a_published_shell_takes_few_steps(name: str) -> None:
    result = ancf.load_scene(SCENES / f"{name}.toml").solve()
    assert result.reached == 1.0
    assert result.counts["steps"] < 12
    assert result.negative_pivots[-1] == 0
    for probe, component, published, tolerance in CASES[name]:
        found = result.probes[probe].value[-1, component]
        np.testing.assert_allclose(found, published, rtol=tolerance, err_msg=f"{probe} {'xyz'[component]}")


@pytest.mark.parametrize(
    ("curvature", "divisions", "load"),
    [("paper", [24, 16], 0.498), ("koiter", [24, 16], 0.517), ("paper", [16, 8], 0.496)],
)
def test_the_pulled_cylinder_tells_that_it_snaps(curvature: str, divisions: list[int], load: float) -> None:
    """Between 0.5 and 0.525 in the table, by the displacements there; long steps do not pass over it."""
    document = tomllib.loads((SCENES / "pulled_cylinder.toml").read_text(encoding="utf-8"))
    document["body"]["shell"] |= {"curvature": curvature, "divisions": divisions}
    result = ancf.Scene.of(document).solve()
    assert isinstance(result, ancf.Result)
    np.testing.assert_allclose(result.jumps, [load], atol=0.005)


def test_the_pulled_cylinder_tells_that_it_snaps_whichever_load_factors_are_wanted() -> None:
    """The one at 0.5 is just beyond the snap."""
    document = tomllib.loads((SCENES / "pulled_cylinder.toml").read_text(encoding="utf-8"))
    document["run"]["load_factors"] = [tenth / 10 for tenth in range(1, 11)]
    result = ancf.Scene.of(document).solve()
    assert isinstance(result, ancf.Result)
    np.testing.assert_allclose(result.jumps, [0.498], atol=0.005)


def test_koiters_curvature_follows_the_published_path_of_the_pulled_cylinder() -> None:
    """B and C of Sze, Liu and Lo (2004) before and after the snap."""
    published = {0.5: (-3.653, -3.718), 0.525: (-4.061, -3.580), 0.6: (-4.274, -3.452), 1.0: (-4.551, -3.269)}
    document = tomllib.loads((SCENES / "pulled_cylinder.toml").read_text(encoding="utf-8"))
    document["body"]["shell"]["curvature"] = "koiter"
    document["run"]["load_factors"] = list(published)
    result = ancf.Scene.of(document).solve()
    assert isinstance(result, ancf.Result)
    for k, probe in enumerate("BC"):
        found = result.probes[probe].value[np.searchsorted(result.t, list(published)), 0]
        np.testing.assert_allclose(found, [values[k] for values in published.values()], rtol=0.005)


def test_the_peak_under_the_force_on_the_pulled_cylinder_needs_short_elements_there() -> None:
    """A is within 0.5 % on a mesh of 24 x 16 whose elements are 60 % shorter there."""
    R, L = 4.953, 5.175

    def along(s: Any) -> Any:
        return 0.4 * s + 0.6 * s * s

    shell = ancf.Surface(
        domain=((0.0, 1.0), (0.0, 1.0)),
        position=lambda x, y: (
            R * np.sin(np.pi / 2 * along(1 - x)),
            R * np.cos(np.pi / 2 * along(1 - x)),
            L * along(y),
        ),
        divisions=(24, 16),
        thickness=0.094,
        material=ancf.Material(E=10.5e6, nu=0.3125),
    )
    model = ancf.Model(
        bodies={"shell": shell},
        supports=[
            ancf.Support(at="edge:x0", symmetry="y"),
            ancf.Support(at="edge:x1", symmetry="x"),
            ancf.Support(at="edge:y0", symmetry="z"),
        ],
        loads=[ancf.Force(at="corner:x1y0", force=(0.0, 10000.0, 0.0))],
        probes=[ancf.Probe(name="A", at=(1.0, 0.0), quantity="displacement")],
    )
    result = ancf.solve_static(model)
    assert result.counts["steps"] < 12
    assert result.probes["A"].value[-1, 1] == pytest.approx(2.768, rel=0.005)


def test_buckled_skins_do_not_lead_newtons_method_astray() -> None:
    """With extrapolated stress alone a step over a quarter of the load fails: its tangent has negative pivots."""
    result = ancf.load_scene(SCENES / "pinched_hemisphere.toml").solve()
    assert result.counts["steps"] <= 3
    assert result.counts["rejected"] <= 1
    assert result.counts["iterations"] <= 25


def test_all_scenes_are_valid() -> None:
    for path in SCENES.glob("*.toml"):
        assert ancf.load_scene(path).title
