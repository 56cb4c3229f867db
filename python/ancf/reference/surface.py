"""Reference shapes: maps from two parameters to space, with the derivatives that nodes hold."""

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from .arrays import FloatArray


class SurfacePoints(NamedTuple):
    """r, r_x, r_y and r_xy at some points, each (p, 3)."""

    r: FloatArray
    r_x: FloatArray
    r_y: FloatArray
    r_xy: FloatArray

    def vectors(self, names: Sequence[str]) -> FloatArray:
        """Stack the named nodal vectors, shape (p, names, 3); r_z is the unit normal."""
        n = np.cross(self.r_x, self.r_y)
        named = {**self._asdict(), "r_z": n / np.linalg.norm(n, axis=-1, keepdims=True)}
        return np.stack([named[name] for name in names], axis=1)


Surface: TypeAlias = Callable[[FloatArray, FloatArray], SurfacePoints]
"""Points of a surface for parameters x, y of shape (p,)."""

Z_AXIS = np.array([0.0, 0.0, 1.0])


def _radial(angle: FloatArray) -> FloatArray:
    """(cos, sin, 0), shape (p, 3)."""
    return np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)


def _tangential(angle: FloatArray) -> FloatArray:
    """(-sin, cos, 0): the derivative of `_radial`, shape (p, 3)."""
    return np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=-1)


def plane(x: FloatArray, y: FloatArray) -> SurfacePoints:
    """Compute (x, y, 0)."""
    one, zero = np.ones_like(x), np.zeros_like(x)
    r = np.stack([x, y, zero], axis=-1)
    r_x, r_y = np.stack([one, zero, zero], axis=-1), np.stack([zero, one, zero], axis=-1)
    return SurfacePoints(r, r_x, r_y, 0 * r)


def annulus(x: FloatArray, y: FloatArray) -> SurfacePoints:
    """Compute x (cos y, sin y, 0)."""
    e, t = _radial(y), _tangential(y)
    return SurfacePoints(x[:, None] * e, e, x[:, None] * t, t)


def cylinder(R: float) -> Surface:
    """Make the map R (cos x, sin x, 0) + y (0, 0, 1)."""

    def points(x: FloatArray, y: FloatArray) -> SurfacePoints:
        e, t = R * _radial(x), R * _tangential(x)
        return SurfacePoints(e + y[:, None] * Z_AXIS, t, np.broadcast_to(Z_AXIS, e.shape), 0 * e)

    return points


def sphere(R: float) -> Surface:
    """Make the map R cos y (cos x, sin x, 0) + R sin y (0, 0, 1)."""

    def points(x: FloatArray, y: FloatArray) -> SurfacePoints:
        e, t = _radial(x), _tangential(x)
        cos, sin = R * np.cos(y)[:, None], R * np.sin(y)[:, None]
        return SurfacePoints(cos * e + sin * Z_AXIS, cos * t, cos * Z_AXIS - sin * e, -sin * t)

    return points
