"""Published shells, solved by their scene files with nothing set by hand.

K. Y. Sze, X. H. Liu, S. H. Lo, Popular benchmark problems for geometric nonlinear analysis of shells, Finite Elem.
Anal. Des. 40 (2004) 1551-1569: displacements of shear-flexible elements at full load. The last number of a case is how
far off it may be: 0.005, but where a thin shell converges to another value or this mesh has not converged
(docs/shells.md).
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk

import ancf

SCENES = Path(__file__).parent.parent / "examples" / "shells"

CASES = {
    "cantilever_shear": [("end", 2, 6.698, 0.005), ("end", 0, -3.286, 0.005)],
    "cantilever_moment": [("end", 0, -12.0, 0.005)],
    "slit_annulus": [("A", 2, 13.891, 0.005), ("B", 2, 17.528, 0.005)],
    "pinched_hemisphere": [("outwards", 0, 4.067, 0.005), ("inwards", 1, -8.178, 0.005)],
    "pulled_cylinder": [("A", 1, 2.768, 0.010), ("B", 0, -4.551, 0.005), ("C", 0, -3.269, 0.013)],
}


@pytest.mark.parametrize("name", list(CASES))
def test_a_published_shell_takes_few_steps(name: str) -> None:
    result = ancf.load_scene(SCENES / f"{name}.toml").solve()
    assert isinstance(result, ancf.Result)
    assert result.reached == 1.0
    assert result.counts["steps"] < 12
    assert result.negative_pivots[-1] == 0
    for probe, component, published, tolerance in CASES[name]:
        found = result.probes[probe].value[-1, component]
        np.testing.assert_allclose(found, published, rtol=tolerance, err_msg=f"{probe} {'xyz'[component]}")


def test_the_pulled_cylinder_tells_that_it_snaps() -> None:
    """Between 0.5 and 0.525 in the table, by the displacements there."""
    result = ancf.load_scene(SCENES / "pulled_cylinder.toml").solve()
    assert isinstance(result, ancf.Result)
    np.testing.assert_allclose(result.jumps, [0.4967], atol=0.005)


@pytest.mark.parametrize("ratio", [1.5, 4.0])
def test_a_leaning_column_is_followed_past_its_critical_load(ratio: float) -> None:
    """From its first, stiff direction into bending: the elastica, 2 k / K(k) with K(k) = pi / 2 sqrt(P / P_c)."""
    length, width, thickness, young = 1.0, 0.1, 0.01, 2.1e11
    critical = np.pi**2 / 4 * young * width * thickness**3 / 12 / length**2
    strip = ancf.Rectangle(
        size=(length, width), divisions=(16, 1), thickness=thickness, material=ancf.Material(E=young, nu=0.0)
    )
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(-ratio * critical / width, 0.0, 1e-3 * critical / width))],
        probes=[ancf.Probe(name="tip", at=(length, width / 2), quantity="displacement")],
    )
    result = ancf.solve_static(model)
    k = brentq(lambda k: ellipk(k**2) - np.pi / 2 * np.sqrt(ratio), 0.01, 0.999999)
    np.testing.assert_allclose(result.probes["tip"].value[-1, 2], 2 * k / ellipk(k**2) * length, rtol=2e-3)
    assert result.counts["steps"] < 20
    assert len(result.jumps) == 0


def test_all_scenes_are_valid() -> None:
    for path in SCENES.glob("*.toml"):
        assert ancf.load_scene(path).title


def test_a_load_that_cannot_get_on_ends() -> None:
    """A saddle, pinned at two sides and pressed far beyond its first snap: what is told is consistent."""
    model = ancf.Model(
        bodies={
            "saddle": ancf.Surface(
                position=lambda x, y: (x, y, 0.05 * (9 - x * x) - 0.05 * (9 - y * y)),
                domain=((-3, 3), (-3, 3)),
                divisions=(5, 5),
                thickness=0.02384,
                material=ancf.Material(E=2e7, nu=0.3),
            )
        },
        supports=[ancf.Support(at="edge:x0", fix=["r"]), ancf.Support(at="edge:x1", fix=["r"])],
        loads=[ancf.Force(at=(0, 0), force=(0, 0, -855.5))],
    )
    result = ancf.solve_static(model, throw=False)
    assert len(result.jumps) >= 1
    assert result.reached >= max(result.jumps)
    if result.status == "failed":
        assert "unstable" in result.reason
