"""The bodies of a result in space: at rest, deformed, with their supports and probes."""

from __future__ import annotations

import math
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LightSource, Normalize
from matplotlib.figure import FigureBase
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, Locator, MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.proj3d import proj_transform  # type: ignore[import-untyped]
from numpy.typing import NDArray

from ancf.errors import InputError, Mistake
from ancf.model import Model
from ancf.places import points_at
from ancf.surface import Grid, quads

FloatArray = NDArray[np.float64]

_STATES = 25
_LONG = 12
_WIDTH = 40
_COLOURS = mpl.colormaps["viridis"]
_LIGHT = LightSource(azdeg=225, altdeg=50)
_INK = "#202020"
_FAINT = "#8a93a0"
_SUPPORT = "#c1272d"


def short(name: str) -> str:
    """Return a name of a probe, cut to what a picture has room for."""
    return name if len(name) <= _WIDTH else f"{name[: _WIDTH - 2]} …"


class Stage:
    """Axes in space with equal scales, large enough for every state.

    Parameters
    ----------
    figure : Figure or SubFigure
        Where to draw.
    model : Model
        Whose bodies to draw.
    q : ndarray, shape (states, n)
        The states.
    facets : int
        About how many for each body.
    rest : ndarray, shape (n,), optional
        The state from which bodies have moved; the one at rest if left out.
    bar : bool, default True
        Show what the colours mean.

    Raises
    ------
    InputError
        If there are no states.
    """

    def __init__(
        self,
        figure: FigureBase,
        model: Model,
        q: FloatArray,
        facets: int,
        *,
        rest: FloatArray | None = None,
        bar: bool = True,
    ) -> None:
        if not len(q):
            raise InputError(Mistake(("result",), "must hold at least one state to be drawn"))
        self._model, self._q = model, q
        self._grids = [Grid.of(model, body, facets) for body in model.bodies]
        some = q[np.unique(np.linspace(0, len(q) - 1, _STATES).round().astype(int))]
        start = (model.nodal_coordinates() if rest is None else rest)[None]
        self._rest = [grid.positions(model, start)[0] for grid in self._grids]
        shapes = [grid.positions(model, some) for grid in self._grids]
        moved = [np.linalg.norm(shape - rest, axis=-1) for shape, rest in zip(shapes, self._rest, strict=True)]
        self._scale = Normalize(0, max(float(np.nanmax(distance)) for distance in moved) or 1)
        # Axes in space have no type stubs. Drawn in the order of zorder, marks stay visible in front of a surface.
        self._axes: Any = figure.add_subplot(projection="3d", computed_zorder=False)
        self._fit(np.concatenate([shape.reshape(-1, 3) for shape in (*shapes, *self._rest)]))
        if bar:
            figure.colorbar(
                ScalarMappable(self._scale, _COLOURS), ax=self._axes, label="displacement / m", shrink=0.5, pad=0.12
            )

    def _fit(self, points: FloatArray) -> None:
        low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
        extent = np.maximum(high - low, 0.1 * (high - low).max())
        middle = (low + high) / 2
        axes = self._axes
        for name, centre, length in zip("xyz", middle, extent, strict=True):
            getattr(axes, f"set_{name}lim")(centre - length / 2, centre + length / 2)
            getattr(axes, f"set_{name}label")(f"{name} / m", labelpad=8)
            ticks = round(5 * length / extent.max())
            if ticks > 1:
                locator: Locator = MaxNLocator(ticks)
            else:
                locator = FixedLocator([round(centre, 1 - math.floor(math.log10(length)))])
            if ticks <= 2:
                # Out of the way of the other axes.
                axes.tick_params(axis=name, pad=8)
            getattr(axes, f"{name}axis").set_major_locator(locator)
            getattr(axes, f"{name}axis").set_pane_color((1, 1, 1, 0))
        axes.set_box_aspect(extent, zoom=0.95)
        axes.view_init(elev=20, azim=-55)

    def draw(self, state: int, between: int = 0) -> list[Artist]:
        """Draw one state.

        Parameters
        ----------
        state : int
            Which.
        between : int, default 0
            How many of the earlier shapes to draw, too.

        Returns
        -------
        list of matplotlib.artist.Artist
            What was drawn, to be removed before another state is.
        """
        steps = np.unique(np.linspace(0, state, between + 2).round().astype(int))
        drawn = []
        for grid, rest in zip(self._grids, self._rest, strict=True):
            *earlier, current = grid.positions(self._model, self._q[steps])
            for shape in (rest, *earlier[1:]):
                drawn += self._draw_faint(shape)
            drawn += self._draw_solid(grid, current, rest)
        return [*drawn, *self._draw_supports(state), *self._draw_probes(state)]

    def _draw_faint(self, surface: FloatArray) -> list[Artist]:
        border = np.concatenate([surface[:, 0], surface[-1, 1:], surface[-2::-1, -1], surface[0, -2::-1]])
        return [
            self._axes.add_collection3d(
                Poly3DCollection(quads(surface), facecolor=_FAINT, alpha=0.13, linewidth=0, zorder=1)
            ),
            *self._axes.plot(*border.T, color=_FAINT, linewidth=0.9, zorder=1),
        ]

    def _draw_solid(self, grid: Grid, surface: FloatArray, rest: FloatArray) -> list[Artist]:
        moved = quads(np.linalg.norm(surface - rest, axis=-1, keepdims=True)).mean(axis=1)[:, 0]
        colours = _COLOURS(self._scale(moved))
        # Edges in the colour of the facet close the gaps that antialiasing leaves between facets.
        style: dict[str, Any] = {"edgecolors": colours, "linewidth": 0.4, "shade": True, "lightsource": _LIGHT}
        faces = Poly3DCollection(quads(surface), facecolors=colours, zorder=2, **style)
        lines = Line3DCollection(grid.lines(surface), color=_INK, linewidth=0.5, alpha=0.45, zorder=3)
        return [self._axes.add_collection3d(faces), self._axes.add_collection3d(lines)]

    def _draw_supports(self, state: int) -> list[Artist]:
        model = self._model
        points = [
            model.evaluate(support.body, points_at(support.at, model.domain(support.body), 7), "position", q)[0]
            for q in [self._q[[state]]]
            for support in model.supports
        ]
        if not points:
            return []
        xyz = np.concatenate(points)
        return [self._axes.scatter(*xyz.T, marker="^", s=38, color=_SUPPORT, depthshade=False, zorder=4)]

    def _draw_probes(self, state: int) -> list[Artist]:
        model = self._model
        drawn: list[Artist] = []
        for index, probe in enumerate(model.probes):
            path = model.evaluate(probe.body, [probe.at], "position", self._q[: state + 1])[:, 0]
            drawn += self._axes.plot(*path.T, color=f"C{index}", linewidth=1.2, zorder=4)
            dot = {"color": f"C{index}", "markersize": 7, "markeredgecolor": "white"}
            drawn += self._axes.plot(*path[-1:].T, "o", zorder=5, **dot)
            halo = [withStroke(linewidth=2.5, foreground="white")]
            style: dict[str, Any] = {"color": _INK, "weight": "bold", "path_effects": halo, "zorder": 6}
            # A long name goes on towards the middle, not beyond the picture.
            left = len(probe.name) > _LONG and proj_transform(*path[-1], self._axes.get_proj())[0] > 0
            name = f"{short(probe.name)}  " if left else f"  {short(probe.name)}"
            drawn.append(self._axes.text(*path[-1], name, ha="right" if left else "left", **style))
        return drawn
