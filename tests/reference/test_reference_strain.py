"""Strain measures: values on known surfaces, derivatives against differences."""

import numpy as np
import pytest

from ancf.reference.strain import MEMBRANE, SOLID, Curvature, StrainMeasure

RNG = np.random.default_rng(3)
MEASURES: list[tuple[StrainMeasure, int]] = [
    (MEMBRANE, 5),
    (Curvature(2, np.array(1.3)), 5),
    (Curvature(0, np.array(1.3)), 5),
    (SOLID, 3),
]


@pytest.mark.parametrize(("measure", "vectors"), MEASURES, ids=["membrane", "paper", "koiter", "solid"])
def test_derivatives(measure: StrainMeasure, vectors: int) -> None:
    g, h = RNG.normal(size=(vectors, 3)), 1e-6
    gradient, hessian = measure.gradient(g), measure.hessian(g)
    for v, i in np.ndindex(vectors, 3):
        step = np.zeros((vectors, 3))
        step[v, i] = h
        difference = (measure.value(g + step) - measure.value(g - step)) / (2 * h)
        np.testing.assert_allclose(gradient[:, v, i], difference, rtol=1e-6, atol=1e-8)
        difference = (measure.gradient(g + step) - measure.gradient(g - step)) / (2 * h)
        np.testing.assert_allclose(hessian[..., v, i], difference, rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(hessian, hessian.transpose(0, 3, 4, 1, 2), rtol=1e-12, atol=1e-12)


def test_membrane_of_a_stretch() -> None:
    g = np.zeros((5, 3))
    g[0], g[1] = [1.2, 0, 0], [0.1, 0, 0.9]
    np.testing.assert_allclose(MEMBRANE.value(g), [1.2**2 / 2, (0.1**2 + 0.9**2) / 2, 1.2 * 0.1])


@pytest.mark.parametrize(("m", "expected"), [(0, -1 / 2), (2, -1 / 2 / 1.1**2)])
def test_curvature_of_a_stretched_cylinder(m: int, expected: float) -> None:
    """A unit square rolled with arc length in x to the radius 2, stretched by 1.1 along its axis."""
    s = 0.3
    g = np.zeros((5, 3))
    g[0] = [np.cos(s / 2), 0, -np.sin(s / 2)]
    g[1] = [0, 1.1, 0]
    g[2] = [-np.sin(s / 2) / 2, 0, -np.cos(s / 2) / 2]
    np.testing.assert_allclose(Curvature(m, np.array(1.0)).value(g), [expected, 0, 0], atol=1e-15)


def test_twist_is_doubled() -> None:
    """Where r = (x, y, x y) is flat, at the origin, r_xy . n = 1."""
    g = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0], [0, 0, 1.0]])
    np.testing.assert_allclose(Curvature(2, np.array(1.0)).value(g), [0, 0, 2])


def test_strain_of_a_solid() -> None:
    """Half of F^T F - I with doubled shear, in the order xx, yy, zz, yz, xz, xy, for r = F R."""
    F = RNG.normal(size=(3, 3))
    strain = (F.T @ F - np.eye(3)) / 2
    expected = [strain[0, 0], strain[1, 1], strain[2, 2], 2 * strain[1, 2], 2 * strain[0, 2], 2 * strain[0, 1]]
    np.testing.assert_allclose(SOLID.value(F.T) - SOLID.value(np.eye(3)), expected, atol=1e-15)
