"""Strain measures: value, gradient and Hessian with respect to the gradient vectors.

A sample sees the nodal coordinates only through its gradient vectors g, of shape (..., v, 3): r_x, r_y, r_xx, r_yy,
r_xy of a thin element, r_x, r_y, r_z of a solid. Shapes have component, vector and direction in this order.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .arrays import FloatArray, IndexArray, einsum

R_X, R_Y, R_XX, R_YY, R_XY = range(5)

LEVI_CIVITA = np.zeros((3, 3, 3))
LEVI_CIVITA[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1
LEVI_CIVITA[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1

BENDING_VECTORS = np.zeros((3, 5))
"""b_c = BENDING_VECTORS[c] @ g: the second derivative that component c of the curvature projects on the normal."""
BENDING_VECTORS[[0, 1, 2], [R_XX, R_YY, R_XY]] = 1, 1, 2

NORMAL_HESSIAN = np.zeros((3, 5, 3, 5, 3))
"""Second derivative of n = r_x x r_y with respect to g."""
NORMAL_HESSIAN[:, R_X, :, R_Y, :] = LEVI_CIVITA
NORMAL_HESSIAN[:, R_Y, :, R_X, :] = LEVI_CIVITA.transpose(0, 2, 1)


class StrainMeasure(Protocol):
    """A strain measure as a function of the v gradient vectors at its samples, with c components."""

    def value(self, g: FloatArray) -> FloatArray:
        """Strain, shape (..., c)."""
        ...

    def gradient(self, g: FloatArray) -> FloatArray:
        """Differentiate the strain, shape (..., c, v, 3)."""
        ...

    def hessian(self, g: FloatArray) -> FloatArray:
        """Differentiate the strain twice, shape (..., c, v, 3, v, 3)."""
        ...


@dataclass(frozen=True)
class GreenLagrange:
    """Half of the metric, r_a . r_b / 2, the sheared components doubled; the energy subtracts its reference value.

    Attributes
    ----------
    pairs : ndarray, shape (c, 2)
        The gradient vectors a, b of each component.
    """

    pairs: IndexArray

    def value(self, g: FloatArray) -> FloatArray:
        """Strain, shape (..., c)."""
        a, b = self.pairs.T
        return self._factors() * _dot(g[..., a, :], g[..., b, :])

    def gradient(self, g: FloatArray) -> FloatArray:
        """Differentiate the strain, shape (..., c, v, 3)."""
        gradient = np.zeros((*g.shape[:-2], len(self.pairs), *g.shape[-2:]))
        for c, ((a, b), factor) in enumerate(zip(self.pairs, self._factors(), strict=True)):
            gradient[..., c, a, :] += factor * g[..., b, :]
            gradient[..., c, b, :] += factor * g[..., a, :]
        return gradient

    def hessian(self, g: FloatArray) -> FloatArray:
        """Differentiate the strain twice, shape (..., c, v, 3, v, 3)."""
        hessian = np.zeros((*g.shape[:-2], len(self.pairs), *g.shape[-2:], *g.shape[-2:]))
        for c, ((a, b), factor) in enumerate(zip(self.pairs, self._factors(), strict=True)):
            hessian[..., c, a, :, b, :] += factor * np.eye(3)
            hessian[..., c, b, :, a, :] += factor * np.eye(3)
        return hessian

    def _factors(self) -> FloatArray:
        return np.where(self.pairs[:, 0] == self.pairs[:, 1], 0.5, 1.0)


MEMBRANE = GreenLagrange(np.array([(0, 0), (1, 1), (0, 1)]))
"""Membrane strain xx, yy, 2 xy; Dufva and Shabana (2005), (30), (31)."""

SOLID = GreenLagrange(np.array([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]))
"""Strain of a solid xx, yy, zz, 2 yz, 2 xz, 2 xy for g = (r_x, r_y, r_z); Dufva and Shabana (2005), (13)."""


@dataclass(frozen=True)
class Curvature:
    """Curvature J**-m (r_ab . n / |n|), n = r_x x r_y, J = |n| / |N|; Dufva and Shabana (2005), (32).

    A component is b . p(n) with b one of r_xx, r_yy, 2 r_xy and p(n) = |N|**m n / |n|**(m + 1).

    Attributes
    ----------
    m : int
        Power of the area stretch: 2 is the paper's r_ab . n / |n|**3 on a flat reference, 0 is Koiter's curvature.
    reference_area : ndarray, shape (...)
        |N| = |R_x x R_y| at the samples, in the shape of the samples in g.
    """

    m: int
    reference_area: FloatArray

    def value(self, g: FloatArray) -> FloatArray:
        """Curvature, shape (..., 3)."""
        n = normal(g)
        p = self._power(n, 1)[..., None] * n
        return einsum("cv,...vi,...i->...c", BENDING_VECTORS, g, p)

    def gradient(self, g: FloatArray) -> FloatArray:
        """Differentiate the curvature, shape (..., 3, 5, 3)."""
        n = normal(g)
        b = BENDING_VECTORS @ g
        p = self._power(n, 1)[..., None] * n
        through_b = einsum("cv,...j->...cvj", BENDING_VECTORS, p)
        through_n = einsum("...ci,...ik,...kvj->...cvj", b, self._first(n), normal_gradient(g))
        return through_b + through_n

    def hessian(self, g: FloatArray) -> FloatArray:
        """Differentiate the curvature twice, shape (..., 3, 5, 3, 5, 3)."""
        n, dn = normal(g), normal_gradient(g)
        b = BENDING_VECTORS @ g
        first = self._first(n)
        mixed = einsum("cv,...jk,...kui->...cvjui", BENDING_VECTORS, first, dn, optimize=True)
        through_n = einsum("...kvj,...ckl,...lui->...cvjui", dn, self._second(n, b), dn, optimize=True)
        curved_n = einsum("...ck,...kl,lvjui->...cvjui", b, first, NORMAL_HESSIAN, optimize=True)
        return mixed + einsum("...vjui->...uivj", mixed) + through_n + curved_n

    def _power(self, n: FloatArray, k: int) -> FloatArray:
        """|N|**m / |n|**(m + k)."""
        size: FloatArray = np.linalg.norm(n, axis=-1)
        return self.reference_area**self.m / size ** (self.m + k)

    def _first(self, n: FloatArray) -> FloatArray:
        """dp/dn, shape (..., 3, 3)."""
        nn = n[..., :, None] * n[..., None, :]
        return self._power(n, 1)[..., None, None] * np.eye(3) - (self.m + 1) * self._power(n, 3)[..., None, None] * nn

    def _second(self, n: FloatArray, b: FloatArray) -> FloatArray:
        """Contract b . d2p/dn2 for each component, shape (..., 3, 3, 3)."""
        m = self.m
        third, fifth = (self._power(n, k)[..., None, None, None] for k in (3, 5))
        nn = n[..., None, :, None] * n[..., None, None, :]
        bn = b[..., :, :, None] * n[..., None, None, :]
        b_n = einsum("...ci,...i->...c", b, n)[..., None, None]
        symmetric = bn + np.swapaxes(bn, -1, -2) + b_n * np.eye(3)
        return (m + 1) * ((m + 3) * fifth * b_n * nn - third * symmetric)


def normal(g: FloatArray) -> FloatArray:
    """Compute the normal n = r_x x r_y, not of unit length, shape (..., 3)."""
    return np.cross(g[..., R_X, :], g[..., R_Y, :])


def normal_gradient(g: FloatArray) -> FloatArray:
    """Differentiate n with respect to the gradient vectors, shape (..., 3, 5, 3)."""
    gradient = np.zeros((*g.shape[:-2], 3, 5, 3))
    gradient[..., R_X, :] = einsum("ijk,...k->...ij", LEVI_CIVITA, g[..., R_Y, :])
    gradient[..., R_Y, :] = einsum("ikj,...k->...ij", LEVI_CIVITA, g[..., R_X, :])
    return gradient


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return einsum("...i,...i->...", a, b)
