"""Bodies of any shape: a smooth map from two parameters to space."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator

from ancf import _core
from ancf.bodies import Plate
from ancf.errors import InputError, Mistake
from ancf.inputs import Point

FloatArray = NDArray[np.float64]

_STENCIL = 7
_STEP = float(np.finfo(np.float64).eps) ** (1 / _STENCIL)
"""Step of the differences relative to the range: their error of sixth order is then that of rounding."""
_WRONG = 0.05
"""Distance of derivatives that are given from differences, relative to the largest, that is a mistake: differences of
positions that are interpolated in a table may be off, too."""


class Surface(Plate):
    """Any smooth surface: the image of a rectangle of parameters x, y, which are its natural coordinates.

    Parameters
    ----------
    domain : pair of pairs of float
        Ranges of x and y, in any unit.
    position : callable
        ``position(x, y)`` returns the three components of the position, m, for arrays x, y of equal shape. It is called
        inside the domain only.
    derivatives : callable, optional
        ``derivatives(x, y)`` returns the triple r_x, r_y, r_xy, each with three components as `position`. If it is
        left out they are taken from differences of `position`, of sixth order.
    divisions, thickness, material, element, membrane, curvature
        As for `Rectangle`.

    Raises
    ------
    InputError
        If a value is impossible, a function fails, at a node r_x and r_y are zero or parallel, or derivatives are far
        from those of the position.

    Examples
    --------
    >>> from ancf import Material
    >>> steel = Material(E=2.1e11, nu=0.3)
    >>> saddle = Surface(
    ...     domain=((-1, 1), (-1, 1)),
    ...     position=lambda x, y: (x, y, x * y / 2),
    ...     divisions=(8, 8),
    ...     thickness=0.01,
    ...     material=steel,
    ... )
    """

    shape: ClassVar[str] = "surface"

    domain: tuple[Point, Point]
    position: Callable[..., Any]
    derivatives: Callable[..., Any] | None = None

    @field_validator("domain")
    @classmethod
    def _increasing(cls, domain: tuple[Point, Point]) -> tuple[Point, Point]:
        if any(low >= high for low, high in domain):
            raise ValueError("must be two pairs of increasing numbers")
        return domain

    def document(self) -> dict[str, Any]:
        """Raise `InputError`: a scene file cannot hold a function."""
        raise InputError(Mistake(("position",), "a scene file cannot hold a function of Python"))

    def reference(self) -> _core.Shape:
        """Return the reference surface."""
        sides = [np.linspace(*ends, number + 1) for ends, number in zip(self.domain, self.divisions, strict=True)]
        x, y = (grid.ravel() for grid in np.meshgrid(*sides))
        r = _components(self._call("position", x, y), x, "position")
        if self.derivatives is None:
            vectors = [r, *self._differences(x, y)]
        else:
            given = self._call("derivatives", x, y)
            if not isinstance(given, Sequence | np.ndarray) or len(given) != 3:
                raise InputError(Mistake(("derivatives",), "must return r_x, r_y and r_xy"))
            vectors = [r, *(_components(vector, x, "derivatives") for vector in given)]
            self._compare(x, y, vectors[1:])
        try:
            return _core.Shape.nodes(self.domain, self.divisions, np.concatenate(vectors, axis=1))
        except _core.InputError as error:
            problem = f"{error.value}: must give {error.allowed}"
            raise InputError(Mistake(("position" if self.derivatives is None else "derivatives",), problem)) from None

    def _call(self, name: str, x: FloatArray, y: FloatArray) -> Any:
        """Return what a function of the user gives."""
        try:
            return getattr(self, name)(x, y)
        except Exception as error:
            told = (
                f"fails: {error}; it is called with arrays x, y, which functions of NumPy take and those of math do not"
            )
            raise InputError(Mistake((name,), told)) from error

    def _compare(self, x: FloatArray, y: FloatArray, given: list[FloatArray]) -> None:
        """Refuse derivatives that are far from differences of the positions."""
        known = self._differences(x, y)
        ranges = [high - low for low, high in self.domain]
        # In units in which all of them are lengths.
        units = [ranges[0], ranges[1], ranges[0] * ranges[1]]
        size = max(float(np.abs(unit * vector).max()) for unit, vector in zip(units, known, strict=True))
        for name, unit, vector, found in zip(("r_x", "r_y", "r_xy"), units, given, known, strict=True):
            off = np.abs(unit * (vector - found)).max(axis=1)
            if off.max() > _WRONG * size:
                node = int(off.argmax())
                told, due = (value[node].round(6).tolist() for value in (vector, found))
                problem = f"{name} at [{x[node]:.6g}, {y[node]:.6g}] is {told}, where position has {due}"
                raise InputError(Mistake(("derivatives",), problem))

    def _differences(self, x: FloatArray, y: FloatArray) -> list[FloatArray]:
        """Return r_x, r_y, r_xy, each (points, 3), from positions at 7 x 7 points about each point."""
        (xs, value_x, slope_x), (ys, value_y, slope_y) = map(_stencil, (x, y), self.domain)
        X, Y = np.broadcast_arrays(xs[:, :, None], ys[:, None, :])
        r = _components(self._call("position", X, Y), X, "position")
        pairs = [(slope_x, value_y), (value_x, slope_y), (slope_x, slope_y)]
        return [np.asarray(np.einsum("pa,pb,pabi->pi", along_x, along_y, r)) for along_x, along_y in pairs]


def _stencil(x: FloatArray, ends: tuple[float, float]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points in the range about each x, and the weights of value and derivative at x, each (points, 7)."""
    low, high = ends
    step = _STEP * (high - low)
    first = np.clip(x - step * (_STENCIL // 2), low, high - step * (_STENCIL - 1))
    places = np.arange(_STENCIL)
    at = (x - first) / step
    # Weights that are exact for the first seven powers of the distance from x, in steps.
    powers = (places - at[:, None])[:, None, :] ** places[:, None]
    value, slope = (np.linalg.solve(powers, np.eye(_STENCIL)[:, [k]])[..., 0] for k in (0, 1))
    return first[:, None] + step * places, value, slope / step


def _components(given: Any, like: FloatArray, name: str) -> FloatArray:
    """Return three components, each a number or an array as `like`, as an array (..., 3)."""
    try:
        x, y, z = given
        if any(map(np.iscomplexobj, (x, y, z))):
            raise TypeError
        parts = [np.broadcast_to(np.asarray(part, dtype=np.float64), like.shape) for part in (x, y, z)]
    except (TypeError, ValueError):
        problem = "must return three components, each a number or an array of the shape of x and y"
        raise InputError(Mistake((name,), problem)) from None
    return np.stack(parts, axis=-1)
