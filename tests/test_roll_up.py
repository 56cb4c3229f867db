"""Pure bending into a full circle: a moment M = 2 pi E I / L about the end of a clamped strip of the length L.

The curvature is M / (E I) everywhere, so the strip closes. Thin, because in a thick one the measure of curvature and
the stretch of the middle surface matter, both of the order of (2 pi h / L)^2; without Poisson's effect, because that
would bend the strip across. Nothing but the clamp holds it: in its own plane too it has to stay by itself.
"""

from typing import Literal, TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

import ancf

FloatArray = NDArray[np.float64]
Element: TypeAlias = Literal["thin36", "thin48", "full48a", "full48b"]

LENGTH, WIDTH, THICKNESS, E = 1.0, 0.1, 1e-3, 1e7


def bend(element: Element, load_factors: list[float]) -> ancf.Result:
    strip = ancf.Rectangle(
        size=(LENGTH, WIDTH),
        divisions=(16, 1),
        thickness=THICKNESS,
        material=ancf.Material(E=E, nu=0.0),
        element=element,
    )
    moment = 2 * np.pi * E * THICKNESS**3 / 12 / LENGTH
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Moment(at="edge:x1", per_length=moment)],
    )
    return ancf.solve_static(model, load_factors=load_factors)


def energy(load_factor: FloatArray) -> FloatArray:
    """E I (2 pi f / L)^2 L / 2 at the load factor f."""
    I = WIDTH * THICKNESS**3 / 12
    return E * I * (2 * np.pi * load_factor / LENGTH) ** 2 * LENGTH / 2


@pytest.fixture(scope="module")
def rolled() -> ancf.Result:
    return bend("thin36", np.linspace(0.1, 1.0, 10).tolist())


def test_the_circle_closes(rolled: ancf.Result) -> None:
    y = [0.0, WIDTH / 2, WIDTH]
    end = rolled.positions("strip", [(LENGTH, y) for y in y])[-1]
    np.testing.assert_allclose(end, [(0.0, y, 0.0) for y in y], rtol=0, atol=1e-3 * LENGTH)


def test_on_the_way_it_is_an_arc(rolled: ancf.Result) -> None:
    """Of the angle 2 pi f: the end is at L (sin 2 pi f, 1 - cos 2 pi f) / (2 pi f)."""
    angle = 2 * np.pi * rolled.t[1:]
    end = rolled.positions("strip", [(LENGTH, WIDTH / 2)])[1:, 0]
    arc = LENGTH * np.stack(
        [np.sin(angle) / angle, np.full_like(angle, WIDTH / 2), (1 - np.cos(angle)) / angle], axis=1
    )
    np.testing.assert_allclose(end, arc, rtol=0, atol=1e-3 * LENGTH)


def test_the_energy_is_that_of_bending(rolled: ancf.Result) -> None:
    expected = energy(rolled.t)
    np.testing.assert_allclose(rolled.energy.bending, expected, rtol=0, atol=1e-4 * expected[-1])
    np.testing.assert_allclose(rolled.energy.membrane, 0, rtol=0, atol=1e-4 * expected[-1])


@pytest.mark.parametrize("element", ["thin36", "thin48", "full48a", "full48b"])
def test_a_small_moment_bends_exactly(element: Element) -> None:
    """Constant curvature is in the space of every element, and edge moments are in equilibrium with it.

    Up to the square of the rotation in an element, which the fibres of a solid resist.
    """
    result = bend(element, [1e-5])
    found = (result.energy.bending + result.energy.membrane)[-1]
    assert found == pytest.approx(energy(result.t)[-1], rel=1e-8)
