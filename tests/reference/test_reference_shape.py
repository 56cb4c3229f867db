"""Shape functions against printed formulas and against what defines them."""

import numpy as np
import pytest

from ancf.reference.arrays import FloatArray
from ancf.reference.shape import BICUBIC, BILINEAR, CORNERS, DERIVATIVES, QUARTIC, ShapeFunctions

L, W = 0.7, 0.4
RNG = np.random.default_rng(4)


def printed(x: float, y: float) -> FloatArray:
    """Dufva and Shabana (2005), Appendix 2, its slips corrected; x, y are xi, eta."""
    return np.array(
        [
            -(x - 1) * (y - 1) * (2 * y**2 - y + 2 * x**2 - x - 1),
            -L * x * (x - 1) ** 2 * (y - 1),
            -W * y * (y - 1) ** 2 * (x - 1),
            x * (2 * y**2 - y - 3 * x + 2 * x**2) * (y - 1),
            -L * x**2 * (x - 1) * (y - 1),
            W * x * y * (y - 1) ** 2,
            -x * y * (1 - 3 * x - 3 * y + 2 * y**2 + 2 * x**2),
            L * x**2 * y * (x - 1),
            W * x * y**2 * (y - 1),
            y * (x - 1) * (2 * x**2 - x - 3 * y + 2 * y**2),
            L * x * (x - 1) ** 2 * y,
            -W * y**2 * (x - 1) * (y - 1),
        ]
    )


def test_printed_formulas() -> None:
    points = np.random.default_rng(1).uniform(size=(20, 2))
    expected = [printed(x, y) for x, y in points]
    np.testing.assert_allclose(QUARTIC.table(points, L, W)[:, 0], expected, atol=1e-15)


@pytest.mark.parametrize(
    ("shape", "rows"), [(QUARTIC, [0, 1, 2]), (BICUBIC, [0, 1, 2, 5]), (BILINEAR, [0])], ids=["12", "16", "4"]
)
def test_dual_to_nodal_coordinates(shape: ShapeFunctions, rows: list[int]) -> None:
    """Each function is 1 at its own nodal coordinate and 0 at all others."""
    table = shape.table(CORNERS, L, W)[:, rows]
    size = 4 * len(rows)
    np.testing.assert_allclose(table.reshape(size, size), np.eye(size), atol=1e-15)


def test_products_of_hermite_functions() -> None:
    """Functions of r, r_x, r_y, r_xy at the first node: products of 1 - 3 s**2 + 2 s**3 and s (1 - s)**2."""
    (x, y), value, slope = (points := RNG.uniform(size=(20, 2))).T, _value, _slope
    expected = [value(x) * value(y), L * slope(x) * value(y), value(x) * W * slope(y), L * slope(x) * W * slope(y)]
    np.testing.assert_allclose(BICUBIC.table(points, L, W)[:, 0, :4].T, expected, atol=1e-15)


def _value(s: FloatArray) -> FloatArray:
    return 1 - 3 * s**2 + 2 * s**3


def _slope(s: FloatArray) -> FloatArray:
    return s * (1 - s) ** 2


@pytest.mark.parametrize("row", range(6))
def test_derivatives(row: int) -> None:
    """Central differences of the printed formulas; exact for their degree but for rounding and O(d**2)."""
    d, (ox, oy) = 1e-3, DERIVATIVES[row]
    stencil = {0: {0: 1.0}, 1: {1: 0.5 / d, -1: -0.5 / d}, 2: {1: d**-2, 0: -2 * d**-2, -1: d**-2}}
    for xi, eta in [(0.2, 0.9), (0.0, 0.35), (1.0, 1.0)]:
        difference = sum(
            a * b * printed(xi + i * d, eta + j * d) for i, a in stencil[ox].items() for j, b in stencil[oy].items()
        )
        table = QUARTIC.table(np.array([[xi, eta]]), L, W)[0, row]
        np.testing.assert_allclose(table, difference / (L**ox * W**oy), atol=1e-4)


def test_complete_cubics() -> None:
    """Every cubic polynomial is interpolated exactly; a quartic outside the space is not."""
    nodes, points = CORNERS * [L, W], np.random.default_rng(2).uniform(size=(10, 2))
    N = QUARTIC.table(points, L, W)[:, 0]

    def error(i: int, j: int) -> float:
        nodal = np.array(
            [[x**i * y**j, i * x ** max(i - 1, 0) * y**j, j * x**i * y ** max(j - 1, 0)] for x, y in nodes]
        )
        x, y = (points * [L, W]).T
        return float(np.abs(N @ nodal.ravel() - x**i * y**j).max())

    assert max(error(i, j) for i in range(4) for j in range(4 - i)) < 1e-15
    assert max(error(3, 1), error(1, 3)) < 1e-15
    assert error(2, 2) > 1e-4
