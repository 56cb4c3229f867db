"""Loads, each through its virtual work: int f . (dr, da, db) over points, an edge, the surface or the volume.

The density f, of shape (p, v, 3), holds at every point the vectors that do work on dr and on further vectors a, b of
the element. It depends on them, of shape (p, v - 1, 3), when the load follows the body: on r_x, r_y for a pressure, on
the vector that is turned and the tangent of the edge for a moment.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import FloatArray, IndexArray, einsum

History: TypeAlias = Literal["constant", "ramp"] | Sequence[tuple[float, float]]
Density: TypeAlias = Callable[[NDArray[Any]], NDArray[Any]]

COMPLEX_STEP = 1e-30


@dataclass(frozen=True)
class Load:
    """A density of force at weighted material points.

    Attributes
    ----------
    cells : ndarray, shape (p,)
        Element of each point.
    table : ndarray, shape (p, v, a)
        Tables of r and of the further vectors.
    weights : ndarray, shape (p,)
        Quadrature weights.
    density : callable
        f at the points, as a function of the further vectors.
    follows : bool
        Whether the density changes with the configuration.
    history : "constant", "ramp" or a table of (t, factor)
    """

    cells: IndexArray
    table: FloatArray
    weights: FloatArray
    density: Density
    follows: bool
    history: History

    def factor(self, t: float) -> float:
        """Factor of the load at the time, or load factor, t."""
        return factor(self.history, t)

    def force(self, e: FloatArray) -> FloatArray:
        """Nodal forces of each point at factor 1, shape (p, a, 3), for nodal coordinates e of (elements, a, 3)."""
        return einsum("p,pva,pvi->pai", self.weights, self.table, self.density(self._vectors(e)), optimize=True)

    def stiffness(self, e: FloatArray) -> FloatArray:
        """Symmetric part of the derivative of `force`, shape (p, a, 3, b, 3).

        The density is differentiated by complex steps, which is exact to rounding; Squire and Trapp (1998).
        """
        vectors = self._vectors(e)
        points, further, _ = vectors.shape
        derivative = np.empty((points, 1 + further, 3, further, 3))
        for u, j in np.ndindex(further, 3):
            shifted = vectors.astype(np.complex128)
            shifted[:, u, j] += 1j * COMPLEX_STEP
            derivative[..., u, j] = self.density(shifted).imag / COMPLEX_STEP
        full = einsum("p,pva,pviuj,pub->paibj", self.weights, self.table, derivative, self.table[:, 1:], optimize=True)
        return (full + full.transpose(0, 3, 4, 1, 2)) / 2

    def _vectors(self, e: FloatArray) -> FloatArray:
        """Evaluate the further vectors at the points, shape (p, v - 1, 3)."""
        return einsum("pva,pai->pvi", self.table[:, 1:], e[self.cells])


def factor(history: History, t: float) -> float:
    """Factor of a history at the time, or load factor, t; a table is linear between its rows, constant outside."""
    if history == "constant":
        return 1.0
    if history == "ramp":
        return t
    times, factors = np.array(history, dtype=np.float64).T
    return float(np.interp(t, times, factors))


def dead(force: ArrayLike) -> Density:
    """Constant force on dr: per point (N) or length (N/m)."""

    def density(vectors: NDArray[Any]) -> NDArray[Any]:
        points, further, _ = vectors.shape
        f = np.zeros((points, 1 + further, 3))
        f[:, 0] = force
        return f

    return density


def pressure(p: float) -> Density:
    """Pressure p (Pa) along the current normal: p n dA = p (r_x x r_y) dx dy."""

    def density(vectors: NDArray[Any]) -> NDArray[Any]:
        f = np.zeros((len(vectors), 3, 3), dtype=vectors.dtype)
        f[:, 0] = p * np.cross(vectors[:, 0], vectors[:, 1])
        return f

    return density


def edge_moment(M: float, edge: str) -> Density:
    """Moment M (N m/m) about an edge that turns the outward direction towards the normal r_x x r_y.

    It turns a vector d, r_x or r_y across the edge or r_z, about the unit tangent a of the edge, outward x normal. Its
    virtual work is M dtheta, dtheta = m . dnu with nu = (d - c s)/|d - c s| the unit part of d normal to the tangent s
    and m = a x nu; changes of c and of the length do no work, since m . d = m . s = 0.
    """
    sign = 1 if edge in ("x0", "y1") else -1

    def density(vectors: NDArray[Any]) -> NDArray[Any]:
        d, s = vectors[:, 0], vectors[:, 1]
        c = np.sum(d * s, axis=-1, keepdims=True) / np.sum(s * s, axis=-1, keepdims=True)
        nu = d - c * s
        m = sign * np.cross(s, nu) / (_norm(s) * _norm(nu))
        f = np.zeros((len(vectors), 3, 3), dtype=vectors.dtype)
        f[:, 1] = M * m / _norm(nu)
        f[:, 2] = -c * f[:, 1]
        return f

    return density


def _norm(v: NDArray[Any]) -> NDArray[Any]:
    """Length of vectors, analytic in complex components."""
    return np.asarray(np.sqrt(np.sum(v * v, axis=-1, keepdims=True)))
