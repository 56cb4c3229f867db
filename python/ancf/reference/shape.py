"""Shape functions on the unit square, and their derivatives with respect to an element's parameters.

A set of shape functions is a space of monomials xi**i eta**j together with the nodal coordinates (position and
gradients at the corners A, B, C, D); the functions are the basis of the space dual to these coordinates: each is 1 at
its own nodal coordinate and 0 at all others. The tests compare `QUARTIC` with the paper's printed formulas.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import perm

from .arrays import FloatArray, IndexArray

CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float64)
"""Unit coordinates (xi, eta) of the nodes A, B, C, D."""

DERIVATIVES = np.array([[0, 0], [1, 0], [0, 1], [2, 0], [0, 2], [1, 1]], dtype=np.intp)
"""Orders (in x, in y) of the rows of a shape table: N, N_x, N_y, N_xx, N_yy, N_xy."""


@dataclass(frozen=True)
class ShapeFunctions:
    """Shape functions of a four-node element.

    Attributes
    ----------
    exponents : ndarray, shape (n, 2)
        Exponents (i, j) of the monomials that span the space.
    vectors : ndarray, shape (n / 4, 2)
        Orders of differentiation (in x, in y) of the vectors at a node; (0, 0) is the position r.
    """

    exponents: IndexArray
    vectors: IndexArray

    @cached_property
    def coefficients(self) -> FloatArray:
        """Coefficients of the functions, shape (monomials, functions); all are integers."""
        conditions = np.stack([_monomials(self.exponents, CORNERS, order) for order in self.vectors], axis=1)
        return np.asarray(np.rint(np.linalg.inv(conditions.reshape(-1, len(self.exponents)))))

    def table(self, points: FloatArray, l: float, w: float) -> FloatArray:
        """Values and derivatives of all functions at some points.

        Parameters
        ----------
        points : ndarray, shape (points, 2)
            Unit coordinates (xi, eta) = (x / l, y / w).
        l, w : float
            Ranges of the parameters x and y in the element.

        Returns
        -------
        ndarray, shape (points, 6, functions)
            N, N_x, N_y, N_xx, N_yy, N_xy of each function; the functions node after node, vector after vector.
        """
        sides = np.array([l, w])
        nodal_scale = np.tile(np.prod(sides**self.vectors, axis=1), len(CORNERS))
        rows = [
            _monomials(self.exponents, points, order) @ self.coefficients * nodal_scale / np.prod(sides**order)
            for order in DERIVATIVES
        ]
        return np.stack(rows, axis=1)


def _monomials(exponents: IndexArray, points: FloatArray, order: IndexArray) -> FloatArray:
    """Differentiate all monomials to one order in unit coordinates, shape (points, monomials)."""
    factors = perm(exponents, order) * points[:, None, :] ** np.maximum(exponents - order, 0)
    return np.asarray(np.prod(factors, axis=-1), dtype=np.float64)


def _shape_functions(exponents: Sequence[tuple[int, int]], vectors: Sequence[tuple[int, int]]) -> ShapeFunctions:
    return ShapeFunctions(np.array(exponents, dtype=np.intp), np.array(vectors, dtype=np.intp))


QUARTIC = _shape_functions(
    exponents=[(i, j) for i in range(4) for j in range(4) if i + j <= 3] + [(3, 1), (1, 3)],
    vectors=[(0, 0), (1, 0), (0, 1)],
)
"""S_C: incomplete quartic with 12 functions, for r, r_x, r_y; Dufva and Shabana (2005), Appendix 2."""

BICUBIC = _shape_functions(
    exponents=[(i, j) for i in range(4) for j in range(4)], vectors=[(0, 0), (1, 0), (0, 1), (1, 1)]
)
"""Products of cubic Hermite functions, 16, for r, r_x, r_y, r_xy; Dmitrochenko and Pogorelov (2003)."""

BILINEAR = _shape_functions(exponents=[(0, 0), (1, 0), (0, 1), (1, 1)], vectors=[(0, 0)])
"""Bilinear functions, 4, for one vector at each node."""
