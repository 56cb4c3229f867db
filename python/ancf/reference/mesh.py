"""Rectangles divided into equal elements: nodes, cells, and where supports and loads are."""

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from .arrays import BoolArray, FloatArray, IndexArray
from .quadrature import Rule
from .shape import CORNERS

At: TypeAlias = str | tuple[float, float]


class Points(NamedTuple):
    """Material points: cell numbers (p,), unit coordinates (p, 2), and weights (p,) in units of the parameters."""

    cells: IndexArray
    unit: FloatArray
    weights: FloatArray


@dataclass(frozen=True)
class RectangleMesh:
    """Elements nx by ny over a rectangle of the given size and first corner; node (i, j) is number i + (nx + 1) j."""

    size: tuple[float, float]
    divisions: tuple[int, int]
    origin: tuple[float, float] = (0.0, 0.0)

    @property
    def sides(self) -> FloatArray:
        """Sides (l, w) of an element."""
        return np.array(self.size) / self.divisions

    @property
    def nodes(self) -> FloatArray:
        """Natural coordinates of the nodes, shape (nodes, 2)."""
        y, x = np.meshgrid(*(np.linspace(0, self.size[k], self.divisions[k] + 1) for k in (1, 0)), indexing="ij")
        return np.stack([x.ravel(), y.ravel()], axis=1) + self.origin

    @property
    def cells(self) -> IndexArray:
        """Numbers of the nodes A, B, C, D of each element, shape (elements, 4)."""
        i, j = np.moveaxis(self._cell_grid()[:, None, :] + CORNERS.astype(np.intp), -1, 0)
        return np.asarray(i + (self.divisions[0] + 1) * j)

    def select(self, at: At) -> IndexArray:
        """Numbers of the nodes at "corner:x0y0", "edge:x1", "all", or nearest to a point (x, y)."""
        if at == "all":
            return np.arange(len(self.nodes))
        if not isinstance(at, str):
            return np.array([np.argmin(np.linalg.norm(self.nodes - at, axis=1))])
        kind, _, where = at.partition(":")
        if kind not in ("corner", "edge") or len(where) != (4 if kind == "corner" else 2):
            raise ValueError(f"no part of a rectangle: {at!r}")
        chosen = [self._on_side(where[k : k + 2]) for k in range(0, len(where), 2)]
        return np.flatnonzero(np.all(chosen, axis=0))

    def locate(self, point: tuple[float, float]) -> Points:
        """One material point with the weight 1; ValueError if (x, y) is outside the rectangle."""
        place = np.array(point) - self.origin
        if not np.all((place >= 0) & (place <= self.size)):
            raise ValueError(f"the point {point} is outside the rectangle of {self.size} from {self.origin}")
        scaled = place / self.sides
        ij = np.minimum(scaled.astype(np.intp), np.array(self.divisions) - 1)
        return Points(np.array([ij[0] + self.divisions[0] * ij[1]]), (scaled - ij)[None, :], np.ones(1))

    def on_edge(self, edge: str, rule: Rule) -> Points:
        """Quadrature points along one of the edges "x0", "x1", "y0", "y1"; `rule` is on [0, 1]."""
        across = "xy".index(edge[0])
        end = int(edge[1])
        grid = self._cell_grid()[:, across]
        cells = np.flatnonzero(grid == end * (self.divisions[across] - 1))
        unit = np.insert(rule.points, across, end, axis=1)
        return _on_cells(cells, Rule(unit, self.sides[1 - across] * rule.weights))

    def on_area(self, rule: Rule) -> Points:
        """Quadrature points over the whole rectangle; `rule` is on the unit square."""
        return _on_cells(np.arange(len(self.cells)), Rule(rule.points, np.prod(self.sides) * rule.weights))

    def _cell_grid(self) -> IndexArray:
        """Place (i, j) of each element, shape (elements, 2), i fastest."""
        j, i = np.indices(self.divisions[::-1])
        return np.stack([i.ravel(), j.ravel()], axis=1)

    def _on_side(self, side: str) -> BoolArray:
        if side not in ("x0", "x1", "y0", "y1"):
            raise ValueError(f"no side of a rectangle: {side!r}")
        across = "xy".index(side[0])
        x = self.nodes[:, across] - self.origin[across]
        return np.isclose(x, int(side[1]) * self.size[across], rtol=0, atol=1e-9 * self.size[across])


def _on_cells(cells: IndexArray, rule: Rule) -> Points:
    """Repeat the points of a rule in each of some cells."""
    return Points(
        np.repeat(cells, len(rule.weights)),
        np.tile(rule.points, (len(cells), 1)),
        np.tile(rule.weights, len(cells)),
    )
