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
Curvature: TypeAlias = Literal["paper", "koiter"]

LENGTH, WIDTH, THICKNESS, E = 1.0, 0.1, 1e-3, 1e7


def bend(
    element: Element,
    load_factors: list[float],
    *,
    thickness: float = THICKNESS,
    divisions: tuple[int, int] = (16, 1),
    curvature: Curvature | None = None,
) -> ancf.Result:
    strip = ancf.Rectangle(
        size=(LENGTH, WIDTH),
        divisions=divisions,
        thickness=thickness,
        material=ancf.Material(E=E, nu=0.0),
        element=element,
        curvature=curvature,
    )
    moment = 2 * np.pi * E * thickness**3 / 12 / LENGTH
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


@pytest.mark.parametrize(("curvature", "multiple"), [("paper", 10), ("koiter", 2)])
def test_a_thicker_strip_turns_too_far_by_what_its_law_says(curvature: Curvature, multiple: int) -> None:
    """By multiples of e = h^2 k^2 / 12, k = M / (E I), to first order in e.

    A line of the strip that turns by t and is stretched by s, lines across by c, has the energy
    E h (e_x^2 + e_y^2) / 2 + E I K^2 / 2 per area, e_x = (s^2 - 1) / 2, e_y = (c^2 - 1) / 2.
    Koiter's K = s t: s^2 = 1 - 2 e, c = 1 and M = E I s^2 t, so t = k (1 + 2 e).
    The paper's K = s t / (s c)^2: s^2 = 1 + 2 e, c^2 = 1 + 4 e and M = E I t / (s^2 c^4), so t = k (1 + 10 e).
    The clamp keeps a short piece from widening: the middle half is measured.
    """
    thickness = LENGTH / 120
    result = bend("thin36", [0.5, 0.95], thickness=thickness, divisions=(32, 4), curvature=curvature)
    assert result.reached == 0.95
    angle = 0.95 * 2 * np.pi
    gradient = result.q[-1].reshape(-1, 3, 3)[[2 * 33 + 8, 2 * 33 + 24], 1]
    first, last = np.arctan2(gradient[:, 2], gradient[:, 0])
    turned = np.mod(last - first, 2 * np.pi) / (angle / 2)
    strain = thickness**2 / 12 * (angle / LENGTH) ** 2
    assert turned - 1 == pytest.approx(multiple * strain, rel=0.02)
