"""Loads, each through its virtual work: int f . (dr, dr_x, dr_y) over points, an edge or the surface.

The density f, of shape (p, 3, 3), holds at every point the vectors that do work on dr, dr_x and dr_y. It depends on
the current r_x, r_y, of shape (p, 2, 3), when the load follows the body.
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
    table : ndarray, shape (p, 3, a)
        N, N_x, N_y of the element's shape functions.
    weights : ndarray, shape (p,)
        Quadrature weights.
    density : callable
        f(r_x, r_y) at the points.
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
        """Factor of the load at the time, or load factor, t; a table is linear between its rows, constant outside."""
        if self.history == "constant":
            return 1.0
        if self.history == "ramp":
            return t
        times, factors = np.array(self.history, dtype=np.float64).T
        return float(np.interp(t, times, factors))

    def force(self, e: FloatArray) -> FloatArray:
        """Nodal forces of each point at factor 1, shape (p, a, 3), for nodal coordinates e of (elements, a, 3)."""
        return einsum("p,pva,pvi->pai", self.weights, self.table, self.density(self._vectors(e)), optimize=True)

    def stiffness(self, e: FloatArray) -> FloatArray:
        """Symmetric part of the derivative of `force`, shape (p, a, 3, b, 3).

        The density is differentiated by complex steps, which is exact to rounding; Squire and Trapp (1998).
        """
        vectors = self._vectors(e)
        derivative = np.empty((len(vectors), 3, 3, 2, 3))
        for u, j in np.ndindex(2, 3):
            shifted = vectors.astype(np.complex128)
            shifted[:, u, j] += 1j * COMPLEX_STEP
            derivative[..., u, j] = self.density(shifted).imag / COMPLEX_STEP
        full = einsum("p,pva,pviuj,pub->paibj", self.weights, self.table, derivative, self.table[:, 1:], optimize=True)
        return (full + full.transpose(0, 3, 4, 1, 2)) / 2

    def _vectors(self, e: FloatArray) -> FloatArray:
        """Evaluate the current r_x, r_y at the points, shape (p, 2, 3)."""
        return einsum("pva,pai->pvi", self.table[:, 1:], e[self.cells])


def dead(force: ArrayLike) -> Density:
    """Constant force on dr: per point (N), length (N/m) or area (N/m2)."""
    f = np.zeros((3, 3))
    f[0] = force
    return lambda vectors: np.broadcast_to(f, (len(vectors), 3, 3))


def pressure(p: float) -> Density:
    """Pressure p (Pa) along the current normal: p n dA = p (r_x x r_y) dx dy."""

    def density(vectors: NDArray[Any]) -> NDArray[Any]:
        f = np.zeros((len(vectors), 3, 3), dtype=vectors.dtype)
        f[:, 0] = p * np.cross(vectors[:, 0], vectors[:, 1])
        return f

    return density


def edge_moment(M: float, edge: str) -> Density:
    """Moment M (N m/m) that turns the outward direction of an edge towards the normal n = r_x x r_y.

    Its virtual work is M dtheta, dtheta = n/|n| . dnu with nu = c^x r_x + c^y r_y the unit outward conormal: in the
    tangent plane, orthogonal to the edge. Changes of c^x and c^y do no work, since n . r_x = n . r_y = 0.
    """
    across = "xy".index(edge[0])
    sign = 1 if edge[1] == "1" else -1

    def density(vectors: NDArray[Any]) -> NDArray[Any]:
        outward, along = vectors[:, across], vectors[:, 1 - across]
        n = np.cross(vectors[:, 0], vectors[:, 1])
        overlap = np.sum(outward * along, axis=-1, keepdims=True) / np.sum(along * along, axis=-1, keepdims=True)
        length = _norm(outward - overlap * along)
        f = np.zeros((len(vectors), 3, 3), dtype=vectors.dtype)
        f[:, 1 + across] = sign * M * n / (_norm(n) * length)
        f[:, 2 - across] = -overlap * f[:, 1 + across]
        return f

    return density


def _norm(v: NDArray[Any]) -> NDArray[Any]:
    """Length of vectors, analytic in complex components."""
    return np.asarray(np.sqrt(np.sum(v * v, axis=-1, keepdims=True)))
