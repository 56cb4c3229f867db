"""Stability lost and found again along load paths: columns past Euler's load, shells that snap many times."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.sparse import coo_array
from scipy.special import ellipk

import ancf

LENGTH = 1.0


def column(ratio: float, lean: float) -> ancf.Model:
    """Clamped at its foot; pressed by so many times Euler's load, pushed aside by this share of it."""
    width, thickness, young = 0.1, 0.01, 2.1e11
    critical = np.pi**2 / 4 * young * width * thickness**3 / 12 / LENGTH**2
    strip = ancf.Rectangle(
        size=(LENGTH, width), divisions=(16, 1), thickness=thickness, material=ancf.Material(E=young, nu=0.0)
    )
    return ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(-ratio * critical / width, 0.0, lean * critical / width))],
        probes=[ancf.Probe(name="tip", at=(LENGTH, width / 2), quantity="displacement")],
    )


def assert_elastica(result: ancf.Result, ratio: float) -> None:
    """Deflection 2 k / K(k) with K(k) = pi / 2 sqrt(P / P_c)."""
    k = brentq(lambda k: ellipk(k**2) - np.pi / 2 * np.sqrt(ratio), 0.01, 0.999999)
    deflection = abs(result.probes["tip"].value[-1, 2])
    np.testing.assert_allclose(deflection, 2 * k / ellipk(k**2) * LENGTH, rtol=2e-3)


@pytest.mark.parametrize("ratio", [1.5, 4.0])
def test_a_leaning_column_is_followed_past_its_critical_load(ratio: float) -> None:
    """From its first, stiff direction into bending."""
    result = ancf.solve_static(column(ratio, 1e-3))
    assert_elastica(result, ratio)
    assert result.counts["steps"] < 20
    assert len(result.jumps) == 0


@pytest.mark.parametrize("ratio", [1.02, 1.5, 3.0])
def test_a_perfect_column_buckles_at_eulers_load(ratio: float) -> None:
    """Told to 1 %, however long the step that goes over it."""
    result = ancf.solve_static(column(ratio, 0.0))
    np.testing.assert_allclose(result.jumps * ratio, [1.0], rtol=0.01)
    assert_elastica(result, ratio)


@pytest.mark.parametrize("metre", [1.0, 2.0**20])
def test_a_column_buckles_under_its_own_weight(metre: float) -> None:
    """At rho g A L^3 / EI = 7.837, Greenhill (1881); in micrometres no number for the density is too small to count."""
    width, thickness, young, density = 0.1, 0.01, 1e8, 1000.0
    strip = ancf.Rectangle(
        size=(LENGTH * metre, width * metre),
        divisions=(16, 1),
        thickness=thickness * metre,
        material=ancf.Material(E=young / metre, nu=0.0, density=density / metre**3),
    )
    gravity = 12.0 * young * thickness**2 / 12 / density / LENGTH**3
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Gravity(acceleration=(-gravity * metre, 0.0, 0.0))],
    )
    result = ancf.solve_static(model)
    np.testing.assert_allclose(12.0 * result.jumps, [7.837], rtol=0.01)
    assert result.negative_pivots[-1] == 0
    tip = result.positions("strip", [(LENGTH * metre, 0.0)])[-1, 0] / metre
    assert 0.5 < abs(tip[2]) < 0.85


def test_arc_length_bends_with_a_column_that_is_all_but_perfect() -> None:
    """A step that ends straight, above Euler's load, would be on another branch, which is not stable."""
    result = ancf.solve_static(column(3.0, 1e-6), path="arc")
    np.testing.assert_array_equal(result.negative_pivots, 0)
    assert_elastica(result, 3.0)
    assert result.counts["steps"] < 40


def panel() -> ancf.Model:
    """Cylindrical, hinged at its straight edges, under a force in its middle."""
    shape = ancf.Cylinder(
        radius=5.0,
        angle=(-0.3, 0.3),
        length=(0.0, 1.0),
        divisions=(9, 9),
        thickness=0.0054,
        material=ancf.Material(E=3e9, nu=0.3),
    )
    return ancf.Model(
        bodies={"panel": shape},
        supports=[ancf.Support(at="edge:x0", fix=["r"]), ancf.Support(at="edge:x1", fix=["r"])],
        loads=[ancf.Force(at=(0.0, 0.5), force=(-2135.0, 0.0, 0.0))],
        probes=[ancf.Probe(name="middle", at=(0.0, 0.5), quantity="displacement")],
    )


@pytest.mark.parametrize("load", [0.033, 0.05, 0.2])
def test_a_panel_snaps_at_the_same_load_in_any_steps(load: float) -> None:
    """At 0.0316 in a hundred steps to 0.05. The stretch that is not stable is short: a step may pass over it."""
    result = ancf.solve_static(panel(), load_factors=[load])
    np.testing.assert_allclose(result.jumps, [0.0316], rtol=0.012)


def arch() -> ancf.Model:
    """Shallow, pinned at both ends, under a force of 100 N in its middle, in its plane."""
    start = (np.pi - 0.3) / 2
    shape = ancf.Cylinder(
        radius=10.0,
        angle=(start, np.pi - start),
        length=(0.0, 0.1),
        divisions=(16, 1),
        thickness=0.01,
        material=ancf.Material(E=2e11, nu=0.0, density=7800.0),
    )
    ends = [ancf.Support(at=f"edge:{side}", fix=["r", "r_y"]) for side in ("x0", "x1")]
    return ancf.Model(
        bodies={"arch": shape},
        supports=[*ends, ancf.Support(at="all", fix=["r.z"])],
        loads=[ancf.Force(at=(np.pi / 2, 0.05), force=(0.0, -100.0, 0.0))],
    )


ARCH = 12.91
"""Load factor at which a frequency passes through zero: the arch sways before it snaps at 13.04."""


def test_the_frequency_of_an_arch_vanishes_where_it_loses_its_stability() -> None:
    lowest = [ancf.modes(arch(), count=1, load_factor=load).frequency[0] for load in (0.98 * ARCH, 0.999 * ARCH)]
    # Squares of frequencies fall in proportion to the load.
    assert lowest[1] ** 2 / lowest[0] ** 2 == pytest.approx(0.001 / 0.02, abs=0.06)


@pytest.mark.parametrize("factors", [[5.0, 10.0, 50.0], [1.0, 2.0, 3.0, 4.0, 5.0, 50.0], [20.0]])
def test_an_arch_jumps_at_the_same_load_however_far_the_next_one_is(factors: list[float]) -> None:
    """Where two branches leave the path close to each other."""
    result = ancf.solve_static(arch(), load_factors=factors)
    np.testing.assert_allclose(result.jumps, [ARCH], rtol=0.012)


def test_modes_tell_the_jumps_on_the_way_to_their_state() -> None:
    found = ancf.modes(arch(), count=1, load_factor=13.5)
    np.testing.assert_allclose(found.jumps, [ARCH], rtol=0.012)


@pytest.mark.parametrize(("young", "thickness", "pressure"), [(1e6, 1e-4, 0.3), (4e9, 1e-5, 0.1)])
def test_an_inflated_film_does_not_jump(young: float, thickness: float, pressure: float) -> None:
    """It is stable from first to last, though it has hardly any stiffness before it has moved by its thickness.

    Held at two edges it is a flat circular arc: the force p L^2 / (8 w) stretches it by 8/3 (w / L)^2.
    """
    strip = ancf.Rectangle(
        size=(LENGTH, 0.25), divisions=(16, 4), thickness=thickness, material=ancf.Material(E=young, nu=0.3)
    )
    held = [ancf.Support(at=f"edge:{side}", fix=["r"]) for side in ("x0", "x1")]
    model = ancf.Model(
        bodies={"film": strip},
        supports=[*held, *(ancf.Support(at=f"edge:{side}", symmetry="y") for side in ("y0", "y1"))],
        loads=[ancf.Pressure(pressure=pressure)],
        probes=[ancf.Probe(name="middle", at=(LENGTH / 2, 0.0), quantity="displacement")],
    )
    result = ancf.solve_static(model)
    assert len(result.jumps) == 0
    energy = result.energy
    np.testing.assert_allclose(energy.loads[-1], (energy.membrane + energy.bending)[-1], rtol=1e-2)
    deflection = (3 * pressure * LENGTH**4 * (1 - 0.3**2) / (64 * young * thickness)) ** (1 / 3)
    np.testing.assert_allclose(abs(result.probes["middle"].value[-1, 2]), deflection, rtol=0.01)


def test_a_strip_stretched_until_nothing_of_its_width_is_left_is_refused() -> None:
    """St. Venant-Kirchhoff's law leaves no width at a stretch of sqrt(1 + 1 / nu): 2.08, under 0.83 of this load."""
    strip = ancf.Rectangle(size=(1.0, 0.2), divisions=(8, 2), thickness=1e-3, material=ancf.Material(E=1e6, nu=0.3))
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(4000.0 / 0.83, 0.0, 0.0))],
    )
    with pytest.raises(ancf.SolveError, match=r"elements collapse at .* of body") as failed:
        ancf.solve_static(model)
    assert 0.5 < failed.value.result.reached < 1


def test_a_sheet_is_not_pushed_through_itself() -> None:
    """In its plane St. Venant-Kirchhoff's law carries no more than E h / sqrt(27) per length."""
    sheet = ancf.Rectangle(
        size=(1.0, 1.0), divisions=(8, 4), thickness=1e-3, membrane="full", material=ancf.Material(E=1e6, nu=0.0)
    )
    model = ancf.Model(
        bodies={"sheet": sheet},
        supports=[ancf.Support(at="edge:x0", clamp=True), ancf.Support(at="all", fix=["r.z", "r_x.z", "r_y.z"])],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(-250.0, 0.0, 0.0))],
    )
    with pytest.raises(ancf.SolveError, match=r"elements collapse at .* of body") as failed:
        ancf.solve_static(model)
    assert failed.value.result.reached < 1e3 / np.sqrt(27) / 250


def bulge(across: float, divisions: int, thickness: float, sides: list[str], force: float) -> ancf.Model:
    """A paraboloid over a square, pinned at some sides, under a force in its middle."""
    shape = ancf.Surface(
        position=lambda x, y: (x, y, 0.05 * (9 - x * x) + across * (9 - y * y)),
        domain=((-3, 3), (-3, 3)),
        divisions=(divisions, divisions),
        thickness=thickness,
        material=ancf.Material(E=2e7, nu=0.3),
    )
    return ancf.Model(
        bodies={"bulge": shape},
        supports=[ancf.Support(at=f"edge:{side}", fix=["r"]) for side in sides],
        loads=[ancf.Force(at=(0, 0), force=(0, 0, -force))],
    )


def cap(force: float) -> ancf.Model:
    """A part of a sphere, pinned all around."""
    shape = ancf.Sphere(
        radius=10.0,
        longitude=(-0.5, 0.5),
        latitude=(-0.5, 0.5),
        divisions=(4, 4),
        thickness=0.0333,
        material=ancf.Material(E=2e7, nu=0.3),
    )
    return ancf.Model(
        bodies={"cap": shape},
        supports=[ancf.Support(at=f"edge:{side}", fix=["r"]) for side in ("x0", "x1", "y0", "y1")],
        loads=[ancf.Force(at=(0, 0), force=(-force, 0, 0))],
    )


ALL = ["x0", "x1", "y0", "y1"]


@pytest.mark.parametrize(
    "model",
    [
        lambda: bulge(-0.05, 5, 0.02384, ALL[:2], 855.5),
        lambda: bulge(-0.05, 5, 0.01275, ALL[:2], 850.5),
        lambda: bulge(-0.05, 4, 0.09365, ALL[:2], 75103.4),
        lambda: bulge(0.05, 6, 0.01811, ALL, 451.2),
        lambda: cap(20000.0),
        lambda: cap(117467.0),
    ],
)
def test_shells_jump_on_to_the_whole_load(model: Callable[[], ancf.Model]) -> None:
    """Pressed far beyond their first snap: every motion comes to rest in a stable state and sets energy free."""
    result = ancf.solve_static(model())
    assert result.status == "ok"
    assert len(result.jumps) >= 1
    np.testing.assert_array_equal(result.negative_pivots, 0)
    energy = result.energy
    strain = energy.membrane + energy.bending
    assert energy.loads[-1] - strain[-1] > 0.01 * strain[-1]


def pressed() -> ancf.Model:
    """A part of a cylinder, clamped at one straight edge, under a pressure: it has no potential at the free edges."""
    shape = ancf.Cylinder(
        radius=1.4,
        angle=(0.0, 2.1665),
        length=(0.0, 3.74),
        divisions=(4, 4),
        thickness=0.0367,
        material=ancf.Material(E=2.0755e9, nu=0.45, density=1000.0),
    )
    return ancf.Model(
        bodies={"shell": shape},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Pressure(pressure=26765.0)],
    )


def whole_tangent(model: ancf.Model, q: NDArray[np.float64], t: float) -> NDArray[np.float64]:
    """Minus the derivative of all forces, by differences."""
    core = model.assemble("ramp")
    free = core.free()

    def force(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return (core.internal_force(at) - core.external_force(at, t))[free]

    step = 1e-6
    unit = step * np.eye(len(q))
    return np.stack([(force(q + unit[i]) - force(q - unit[i])) / (2 * step) for i in free], axis=1)


@pytest.mark.parametrize("factors", [[0.75, 0.9], list(np.linspace(0.05, 0.9, 18))])
def test_a_pressure_at_free_edges_snaps_a_shell_where_its_whole_tangent_is_lost(factors: list[float]) -> None:
    """At 0.762 in any steps. The symmetric half of the tangent is not definite before, from 0.70 of the load on."""
    model = pressed()
    result = ancf.solve_static(model, load_factors=factors)
    np.testing.assert_allclose(result.jumps, [0.762], rtol=3e-3)
    np.testing.assert_array_equal(result.negative_pivots, 0)
    before = int(np.argmin(np.abs(result.t - 0.75)))
    for state in (before, -1):
        tangent = whole_tangent(model, result.q[state], result.t[state])
        assert np.linalg.eigvals(tangent).real.min() > 0
        if state == before:
            assert np.linalg.eigvalsh(tangent + tangent.T)[0] < 0


def test_a_jump_ends_where_a_damped_motion_does() -> None:
    """`M dq/dtau = Q_e - Q_k`, disturbed before the jump, by SciPy: to the same equilibrium or its mirror image."""
    model, t = pressed(), 0.77
    result = ancf.solve_static(model, load_factors=[0.75, t])
    assert len(result.jumps) == 1
    core = model.assemble("ramp")
    free, before = core.free(), result.q[1]
    rows, columns, values = core.mass()
    mass = coo_array((values, (rows, columns)), shape=(len(before), len(before))).toarray()[np.ix_(free, free)]

    def at(x: NDArray[np.float64]) -> NDArray[np.float64]:
        q: NDArray[np.float64] = before.copy()
        q[free] = x
        return q

    def force(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return (core.external_force(at(x), t) - core.internal_force(at(x)))[free]

    start = before[free] + 1e-3 * np.random.default_rng(0).standard_normal(len(free))
    motion = solve_ivp(
        lambda _, x: np.linalg.solve(mass, force(x)),
        (0.0, 1e10),
        start,
        method="BDF",
        jac=lambda _, x: -np.linalg.solve(mass, whole_tangent(model, at(x), t)),
        rtol=1e-3,
        atol=1e-5,
    )
    end = motion.y[:, -1]
    for _ in range(3):
        end = end + np.linalg.solve(whole_tangent(model, at(end), t), force(end))
    strain = result.energy.membrane + result.energy.bending
    np.testing.assert_allclose(sum(core.energy(at(end))), strain[-1], rtol=1e-9)
    np.testing.assert_allclose(np.abs(at(end) - before).max(), np.abs(result.q[-1] - before).max(), rtol=1e-6)
    assert np.abs(result.q[-1] - before).max() > 0.2


def test_arc_length_tells_where_a_cap_under_pressure_is_lost() -> None:
    """Where it jumps under a growing load. Bifurcations of the unstable path beyond do not shorten steps."""
    cap = ancf.Sphere(
        radius=10.0,
        longitude=(-0.2, 0.2),
        latitude=(-0.2, 0.2),
        divisions=(4, 4),
        thickness=0.1,
        material=ancf.Material(E=2e7, nu=0.3),
    )
    model = ancf.Model(
        bodies={"cap": cap},
        supports=[ancf.Support(at=f"edge:{side}", fix=["r"]) for side in ALL],
        loads=[ancf.Pressure(pressure=-2420.0)],
    )
    result = ancf.solve_static(model, path="arc")
    unstable = int(np.argmax(result.negative_pivots > 0))
    np.testing.assert_allclose(result.t[unstable - 1], ancf.solve_static(model).jumps[0], rtol=0.015)
    assert result.status == "ok"
    assert result.counts["steps"] < 25


def test_a_deep_arch_snaps_at_its_published_load() -> None:
    """Hinged at one end, clamped at the other, 215 degrees: P R^2 / EI = 8.97, DaDeppo and Schmidt (1975)."""
    half = np.deg2rad(107.5)
    arch = ancf.Cylinder(
        radius=100.0,
        angle=(np.pi / 2 - half, np.pi / 2 + half),
        length=(0.0, 1.0),
        divisions=(48, 1),
        thickness=1.0,
        material=ancf.Material(E=12e6, nu=0.0),
    )
    planes = [ancf.Support(at=f"edge:{side}", symmetry="z") for side in ("y0", "y1")]
    model = ancf.Model(
        bodies={"arch": arch},
        supports=[ancf.Support(at="edge:x0", clamp=True), ancf.Support(at="edge:x1", fix=["r"]), *planes],
        loads=[ancf.Force(at=(np.pi / 2, 0.5), force=(0.0, -1000.0, 0.0))],
    )
    result = ancf.solve_static(model)
    np.testing.assert_allclose(10 * result.jumps, [8.97], rtol=5e-3)
    assert result.counts["steps"] < 12
