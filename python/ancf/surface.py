"""Bodies as facets and lines: what is drawn of their shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ancf.model import Model

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Grid:
    """Material points of a body in rows and columns, several in each element.

    Parameters
    ----------
    body : str
        Its name.
    per_element : int
        Facets along each side of an element.
    points : ndarray, shape (columns, rows, 2)
        Natural coordinates.
    """

    body: str
    per_element: int
    points: FloatArray

    @classmethod
    def of(cls, model: Model, body: str, facets: int) -> Grid:
        """Make a grid of about as many facets as wanted, from 1 to 12 along each side of an element."""
        divisions = model.bodies[body].divisions
        return cls.divided(model, body, int(np.clip(np.sqrt(facets / np.prod(divisions)), 1, 12)))

    @classmethod
    def divided(cls, model: Model, body: str, per_element: int) -> Grid:
        """Make a grid with so many facets along each side of an element."""
        sides = [
            np.linspace(low, high, number * per_element + 1)
            for (low, high), number in zip(model.domain(body), model.bodies[body].divisions, strict=True)
        ]
        return cls(body, per_element, np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1))

    def positions(self, model: Model, q: FloatArray) -> FloatArray:
        """Return the positions for nodal coordinates of shape (states, n): (states, columns, rows, 3), m."""
        values = model.evaluate(self.body, self.points.reshape(-1, 2), "position", q)
        return values.reshape(len(q), *self.points.shape[:2], 3)

    def lines(self, surface: FloatArray) -> list[FloatArray]:
        """Return the borders of the elements in a surface of shape (columns, rows, 3), each (points, 3)."""
        k = self.per_element
        return [*surface[::k], *surface.swapaxes(0, 1)[::k]]


def quads(surface: FloatArray) -> FloatArray:
    """Return the facets between the points of a surface.

    Parameters
    ----------
    surface : ndarray, shape (columns, rows, k)
        Values at the points.

    Returns
    -------
    ndarray, shape (facets, 4, k)
        Values at the corners of each facet, in turn.
    """
    corners = [surface[:-1, :-1], surface[1:, :-1], surface[1:, 1:], surface[:-1, 1:]]
    return np.stack(corners, axis=2).reshape(-1, 4, surface.shape[-1])
