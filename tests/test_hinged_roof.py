"""A hinged cylindrical roof under a central force snaps through.

K. Y. Sze, X. H. Liu, S. H. Lo, Popular benchmark problems for geometric nonlinear analysis of shells, Finite Elem.
Anal. Des. 40 (2004) 1551-1569: R 2540, length 508, half angle 0.1 rad, thickness 12.7, E 3102.75, nu 0.3, force 3000
(mm, N); straight edges hinged, curved edges free. A quarter of it, 8 x 8 elements. The table is of shear-flexible ones:
on the last, steep branch a thin shell deflects 0.3 % less, with 16 x 16 elements as well.
"""

from typing import Any

import numpy as np
import pytest

import ancf

TOP = np.pi / 2
# Load factor and deflection in the middle.
TABLE = np.array(
    [
        (0.1980, 1.638),
        (0.4686, 4.477),
        (0.6908, 8.237),
        (0.7421, 11.293),
        (0.6649, 13.583),
        (0.4442, 15.676),
        (0.2272, 17.657),
        (0.1729, 19.852),
        (0.2950, 22.875),
        (0.5826, 25.940),
        (0.9643, 28.663),
    ]
)


def roof() -> ancf.Model:
    shell = ancf.Cylinder(
        radius=2540.0,
        angle=(TOP - 0.1, TOP),
        length=(0.0, 254.0),
        divisions=(8, 8),
        thickness=12.7,
        material=ancf.Material(E=3102.75, nu=0.3),
    )
    return ancf.Model(
        bodies={"roof": shell},
        supports=[
            ancf.Support(at="edge:x0", fix=["r", "r_y"]),
            # The planes of symmetry.
            ancf.Support(at="edge:x1", symmetry="x"),
            ancf.Support(at="edge:y0", symmetry="z"),
        ],
        loads=[ancf.Force(at="corner:x1y0", force=(0.0, -750.0, 0.0))],
        probes=[ancf.Probe(name="middle", at=(TOP, 0.0), quantity="displacement")],
    )


def deflection(result: ancf.Result) -> Any:
    return -result.probes["middle"].value[:, 1]


def test_arc_length_follows_the_whole_path() -> None:
    result = ancf.solve_static(roof(), load_factors=[0.1, 1.0], path="arc")
    assert result.t[-1] == 1.0
    w = deflection(result)
    assert np.all(np.diff(w) > 0)
    # The load at the deflections of the table, to 1 % of its largest.
    load = np.interp(TABLE[:-1, 1], w, result.t)
    np.testing.assert_allclose(load, TABLE[:-1, 0], rtol=0, atol=0.01)
    last = result.t[-20:]
    np.testing.assert_allclose(np.interp(TABLE[-1, 0], last, w[-20:]), TABLE[-1, 1], rtol=0.005)
    # Limit points are states; between them the equilibria are unstable, with one negative eigenvalue.
    upper, lower = np.argmax(result.t[w < 15]), np.flatnonzero(w > 15)[0] + np.argmin(result.t[w > 15])
    np.testing.assert_allclose(result.t[[upper, lower]], [0.7421, 0.1729], rtol=0.01)
    assert set(result.negative_pivots[upper + 1 : lower]) == {1}
    assert set(result.negative_pivots[:upper]) == set(result.negative_pivots[lower + 1 :]) == {0}
    assert len(result.jumps) == 0


def test_a_growing_load_makes_it_jump() -> None:
    result = ancf.solve_static(roof(), load_factors=[0.5, 1.0])
    np.testing.assert_allclose(result.jumps, [0.7421], rtol=0.01)
    np.testing.assert_array_equal(result.negative_pivots, 0)
    # Between 28.663 at 0.9643 and 29.374 at 1.0835.
    np.testing.assert_allclose(deflection(result)[-1], 28.876, rtol=0.01)
    # What the load has done is more than the strain energy: the rest has been set free.
    energy = result.energy
    assert energy.loads[-1] > 1.2 * (energy.membrane + energy.bending)[-1]


@pytest.mark.parametrize("load", [10.0, 100.0])
def test_the_snap_is_told_however_far_the_load_is(load: float) -> None:
    """The largest load of the table before the snap is 0.7421; a jump may be told 1 % late."""
    result = ancf.solve_static(roof(), load_factors=[load])
    np.testing.assert_allclose(result.jumps, [0.7421], rtol=0.011)


@pytest.mark.parametrize("force", [(0.0, 0.0, 0.0), None])
def test_arc_length_needs_a_load_that_grows(force: tuple[float, float, float] | None) -> None:
    model = roof()
    loads = [] if force is None else [ancf.Force(at="corner:x1y0", force=force)]
    with pytest.raises(ancf.SolveError, match="do not change with the load factor"):
        ancf.solve_static(ancf.Model(bodies=model.bodies, supports=model.supports, loads=loads), path="arc")


def test_arc_length_ends_after_so_many_steps() -> None:
    with pytest.warns(ancf.PathWarning, match="after 3 steps at load factor 0.0.*before 1"):
        result = ancf.solve_static(roof(), load_factors=[0.01, 1.0], path="arc", max_steps=3)
    assert result.status == "ok"
    assert len(result.t) == 4
    assert 0 < result.reached < 0.04


def test_an_unknown_path_is_refused() -> None:
    with pytest.raises(ancf.InputError, match="path"):
        ancf.solve_static(roof(), path="circle")  # type: ignore[arg-type]
