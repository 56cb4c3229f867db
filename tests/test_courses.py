"""Loads and moved supports that change between two steps, and curves that leave their rows."""

from typing import Any, get_args

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import ancf
from ancf import _core
from ancf.courses import course_warnings
from ancf.run import Method

SIZE, THICKNESS, DENSITY, FORCE = (0.5, 0.3), 0.003, 7850.0, 3000.0
MASS = SIZE[0] * SIZE[1] * THICKNESS * DENSITY
STEEL = ancf.Material(E=2.1e11, nu=0.3, density=DENSITY)
PLATE = ancf.Rectangle(size=SIZE, divisions=(1, 1), thickness=THICKNESS, material=STEEL)


def free_plate(history: Any) -> ancf.Model:
    push = ancf.Force(at=(SIZE[0] / 2, SIZE[1] / 2), force=(0.0, 0.0, FORCE), history=history)
    return ancf.Model(
        bodies={"p": PLATE}, loads=[push], probes=[ancf.Probe(name="A", at=SIZE, quantity="displacement")]
    )


def pulse(duration: float) -> list[tuple[float, float]]:
    return [(0.0, 0.0), (0.33, 0.0), (0.33 + duration / 2, 1.0), (0.33 + duration, 0.0)]


@pytest.mark.parametrize("method", [method for method in get_args(Method) if method not in ("verlet", "rk")])
def test_error_control_meets_a_short_force(method: Method) -> None:
    """A free plate that is pushed for 2 ms goes on with the impulse over its mass.

    Explicit methods need 1e5 steps for this plate of steel; the tests of the core push a soft one.
    """
    duration, rtol = 0.002, 1e-4
    result = ancf.simulate(free_plate(pulse(duration)), until=0.4, every=0.1, rtol=rtol, method=method)
    momentum = FORCE * duration / 2
    np.testing.assert_allclose(result.momentum[-1], [0.0, 0.0, momentum], rtol=1e-4, atol=1e-6)
    speed = momentum / MASS
    # The plate vibrates, about as a free beam: speed over angular frequency, twice that at most at a corner.
    omega = 22.37 * THICKNESS / SIZE[0] ** 2 * (2.1e11 / (12 * DENSITY)) ** 0.5
    way = speed * (0.4 - 0.33 - duration / 2)
    assert result.probes["A"].value[-1][2] == pytest.approx(way, abs=1e-9 if method == "rigid" else 2 * speed / omega)
    assert result.warnings == ()


def test_fixed_steps_that_miss_a_force_say_so() -> None:
    with pytest.warns(ancf.CourseWarning, match=r"loads\.0\.history: .* off by 100%"):
        result = ancf.simulate(free_plate(pulse(0.002)), until=1.0, step=0.02)
    assert len(result.warnings) == 1
    assert np.abs(result.q - result.q[0]).max() < 1e-9


@pytest.mark.parametrize(
    "history",
    [
        "constant",
        [(0.0, 0.0), (1e-6, 1.0)],
        [(0.1, 1.0), (0.1 + 1e-9, 0.0)],
        pulse(0.03),
        [(t, np.sin(2 * np.pi * 20 * t)) for t in np.linspace(0, 0.5, 997)],
    ],
)
def test_usual_histories_are_not_told(history: Any) -> None:
    """Steps of 4 ms: 12 a period of 20 Hz."""
    assert course_warnings(free_plate(history), ancf.Dynamic(until=0.5, step=4e-3)) == ()


def supported(rows: Any) -> ancf.Model:
    wall = ancf.Support(at="edge:x0", clamp=True, translation=[(t, 0.0, 0.0, z) for t, z in rows])
    return ancf.Model(bodies={"p": PLATE}, supports=[wall])


def test_a_curve_that_leaves_its_rows_is_told() -> None:
    """Rows of a short pulse with none between it and the ends: the spline swings to twenty times the pulse."""
    model = supported([(0.0, 0.0), (0.33, 0.0), (0.34, 0.01), (0.35, 0.0), (1.0, 0.0)])
    with pytest.warns(ancf.CourseWarning, match=r"supports\.0\.translation, z: .* goes to -0\.186 m"):
        ancf.simulate(model, until=1.0, rtol=1e-2, every=0.5)


def test_a_support_that_moves_within_a_step_is_told() -> None:
    rows = [(0.05 * k, 0.01 if k == 3 else 0.0) for k in range(11)]
    (told,) = course_warnings(supported(rows), ancf.Dynamic(until=0.5, step=0.1))
    assert "at t = 0.15 s, the support is 0.01 m off the straight way" in told


def test_usual_curves_are_not_told() -> None:
    """Eight rows a period of a sine; it begins at rest with its trough."""
    rows = [(t, 1e-3 * (1 - np.cos(2 * np.pi * 2 * t))) for t in np.arange(0, 1, 1 / 16)]
    assert course_warnings(supported(rows), ancf.Dynamic(until=1.0, step=0.05)) == ()


@pytest.mark.parametrize(("times", "lowest"), [([0, 0.33, 0.34, 0.35, 1], -0.186), ([0, 1, 2, 3, 4, 5, 6], -0.14)])
def test_curves_are_splines_that_begin_at_rest(times: list[float], lowest: float) -> None:
    """SciPy finds the same, clamped at the start and natural at the end."""
    t = np.array(times, dtype=float)
    value = np.where(np.arange(len(t)) == len(t) // 2, 0.01 if lowest < -0.15 else 1.0, 0.0)
    fine = np.linspace(t[0], t[-1], 1001)
    found = _core.curve(np.column_stack((t, value)), fine)
    expected = CubicSpline(t, value, bc_type=((1, np.array(0.0)), (2, np.array(0.0))))(fine)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    assert found.min() == pytest.approx(lowest, abs=2e-3)
