"""The picture of a chart, as PNG and SVG."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from textwrap import wrap

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, NullFormatter

from ancf.chart.measure import Chart
from ancf.chart.points import LEVELS, Point, Winner, front, percent, winners
from ancf.text import plain_text

PALETTE = ("#0b6bcb", "#d1495b", "#2a9d5c", "#8e5ea2", "#e08e0b", "#1aa6b7", "#7a6a58", "#b0489a")
"""Colours of elements."""
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
_INK, _SOFT, _GOLD = "#1c2430", "#5d6b7c", "#ffc53d"
_LEAST = 1e-6
"""Smaller errors, of a run against itself, are drawn there."""

_COUNTS = {"factorizations": "factorisations", "forces": "force evaluations"}

Value = Callable[[Point], float]
Panel = Callable[[Axes, Chart, "Style"], None]


def draw(chart: Chart) -> Figure:
    """Draw a chart.

    Parameters
    ----------
    chart : Chart
        What was measured.

    Returns
    -------
    matplotlib.figure.Figure
        To be saved with its ``savefig``.
    """
    with plain_text(), mpl.rc_context({"axes.edgecolor": _SOFT, "axes.labelcolor": _INK, "font.size": 10}):
        return _draw(chart)


def _draw(chart: Chart) -> Figure:
    style = Style(chart.points)
    figure = Figure(figsize=(15.5, 9.2), dpi=120, layout="constrained", facecolor="white")
    title = chart.scene.title or "Scene"
    figure.suptitle(f"{title}: what accuracy costs", fontsize=17, color=_INK, x=0.01, ha="left")
    grid = figure.add_gridspec(2, 4, width_ratios=(1, 1, 1, 1), height_ratios=(1.65, 1))
    _draw_main(figure.add_subplot(grid[0, :3]), chart, style)
    _draw_legend(figure.add_subplot(grid[0, 3]), chart, style)
    panels: list[Panel] = [
        _draw_space,
        _draw_time,
        partial(_draw_counts, "factorizations"),
        partial(_draw_counts, "forces"),
    ]
    if not any(point.time > 0 for point in chart.points):
        panels.remove(_draw_time)
    below = grid[1, :].subgridspec(1, len(panels))
    for column, panel in enumerate(panels):
        panel(figure.add_subplot(below[column]), chart, style)
    return figure


class Style:
    """Colours of elements, markers of methods, sizes of meshes.

    Parameters
    ----------
    points : sequence of Point
        What is drawn.
    """

    def __init__(self, points: Sequence[Point]) -> None:
        self.elements = {name: _pick(PALETTE, i) for i, name in enumerate(_unique(p.label.element for p in points))}
        self.methods = {name: _pick(_MARKERS, i) for i, name in enumerate(_unique(p.label.method for p in points))}
        numbers = sorted({point.elements for point in points})
        self.meshes = {
            mesh: 22.0 + 70.0 * rank / max(1, len(numbers) - 1)
            for rank, number in enumerate(numbers)
            for mesh in _unique(p.label.mesh for p in points if p.elements == number)
        }

    def scatter(self, axes: Axes, points: Sequence[Point], x: Value, y: Value, scale: float = 1.0) -> None:
        """Draw points."""
        # Small ones on top of large ones.
        for point in sorted(points, key=lambda point: -self.meshes[point.label.mesh]):
            axes.scatter(
                x(point),
                max(y(point), _LEAST),
                s=scale * self.meshes[point.label.mesh],
                marker=self.methods[point.label.method],
                color=self.elements[point.label.element],
                alpha=0.75,
                edgecolors="white",
                linewidths=0.5,
                zorder=3,
            )


def _draw_main(axes: Axes, chart: Chart, style: Style) -> None:
    style.scatter(axes, chart.points, _seconds, _error)
    best = front(chart.points)
    axes.plot(
        [p.timing.best for p in best],
        [max(p.error, _LEAST) for p in best],
        color=_INK,
        linewidth=1.3,
        drawstyle="steps-post",
        zorder=2,
        label="front",
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    axes.set_xlim(left * 0.8, right * 1.1)
    if not math.isnan(chart.reference.trust):
        axes.axhspan(bottom * 0.5, chart.reference.trust, color="#8a93a0", alpha=0.13, linewidth=0, zorder=0)
        axes.text(
            0.005,
            chart.reference.trust * 0.97,
            f"the reference is known to {percent(chart.reference.trust)}",
            transform=axes.get_yaxis_transform(),
            ha="left",
            va="top",
            color=_SOFT,
            fontsize=9,
        )
    axes.set_ylim(bottom * 0.8, top * 1.2)
    for winner in winners(chart.points, chart.reference.trust):
        if winner.point is not None:
            _mark_winner(axes, winner.point, winner.level)
    for own in (point for point in chart.points if point.own):
        axes.scatter(own.timing.best, own.error, s=260, facecolors="none", edgecolors=_INK, linewidths=1.4, zorder=4)
    for level in LEVELS:
        axes.axhline(level, color=_SOFT, linewidth=0.7, linestyle=(0, (4, 4)), zorder=1)
    _finish(axes, "wall time, one thread / s", "error / size of the motion")
    axes.set_title("Error against wall time", loc="left", color=_INK, fontsize=12)


def _mark_winner(axes: Axes, point: Point, level: float) -> None:
    place = (point.timing.best, max(point.error, _LEAST))
    axes.scatter(*place, s=260, marker="*", color=_GOLD, edgecolors=_INK, zorder=5)
    halo = [withStroke(linewidth=3, foreground="white")]
    axes.annotate(
        percent(level),
        place,
        xytext=(-9, -12),
        textcoords="offset points",
        ha="right",
        fontsize=10,
        weight="bold",
        color=_INK,
        path_effects=halo,
        zorder=6,
    )


def _draw_legend(axes: Axes, chart: Chart, style: Style) -> None:
    axes.axis("off")
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1)
    elements = [Line2D([], [], marker="o", linestyle="", color=c, label=name) for name, c in style.elements.items()]
    methods = [
        Line2D([], [], marker=m, linestyle="", color=_SOFT, label=name.replace("_", " "))
        for name, m in style.methods.items()
    ]
    meshes = [
        Line2D([], [], marker="o", linestyle="", color=_SOFT, markersize=math.sqrt(size), label=name)
        for name, size in style.meshes.items()
    ]
    marks = [
        Line2D([], [], color=_INK, linewidth=1.3, label="nothing is faster and more accurate"),
        Line2D([], [], marker="o", markersize=14, fillstyle="none", linestyle="", color=_INK, label="scene as it is"),
    ]
    top = 1.0
    for title, handles in (("Element, membrane", elements), ("Method", methods), ("Mesh", meshes), ("", marks)):
        rows = len(handles) + bool(title)
        legend = axes.legend(
            handles=handles, title=title or None, loc="upper left", bbox_to_anchor=(0.0, top), frameon=False, fontsize=9
        )
        legend.set_alignment("left")
        legend.get_title().set_fontweight("bold")
        axes.add_artist(legend)
        top -= 0.0385 * rows + 0.03
    for winner in winners(chart.points, chart.reference.trust):
        axes.text(0.02, top, f"{percent(winner.level)}:", weight="bold", color=_INK, va="top", fontsize=9)
        axes.text(0.17, top, _told(winner), color=_INK, va="top", fontsize=9, linespacing=1.25)
        top -= 0.08


def _told(winner: Winner) -> str:
    if winner.point is None:
        return "\n".join(wrap(winner.remark, 40))
    label = winner.point.label
    return f"{label.space}\n{label.time}: {winner.point.timing.best:.2g} s"


def _draw_space(axes: Axes, chart: Chart, style: Style) -> None:
    lines: dict[str, dict[int, float]] = {}
    for point in chart.points:
        if not math.isnan(point.space):
            lines.setdefault(point.label.element, {})[point.elements] = max(point.space, _LEAST)
    for name, values in lines.items():
        numbers = sorted(values)
        axes.plot(numbers, [values[n] for n in numbers], "o-", color=style.elements[name], markersize=5, linewidth=1.3)
    axes.set_xscale("log")
    axes.set_yscale("log")
    _finish(axes, "elements", "error / size of the motion")
    axes.set_title("Error in space: element and mesh", loc="left", color=_INK, fontsize=11)


def _draw_time(axes: Axes, chart: Chart, style: Style) -> None:
    """Draw the error in time on the mesh with the most points, of these the finest."""
    numbers = Counter(point.label.space for point in chart.points if point.time > 0)
    finest = {point.label.space: point.elements for point in chart.points}
    space = max(numbers, key=lambda name: (numbers[name], finest[name]))
    colour = style.elements[next(p.label.element for p in chart.points if p.label.space == space)]
    for method, marker in style.methods.items():
        points = [p for p in chart.points if (p.label.space, p.label.method) == (space, method) and p.time > 0]
        points.sort(key=lambda point: point.time)
        times = [point.timing.best for point in points]
        axes.plot(
            times, [p.time for p in points], marker=marker, color=colour, linewidth=0.8, markersize=5.5, alpha=0.8
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    _finish(axes, "wall time / s", "")
    axes.set_title(f"Error in time: {space}", loc="left", color=_INK, fontsize=11)


def _draw_counts(key: str, axes: Axes, chart: Chart, style: Style) -> None:
    name = _COUNTS[key]
    points = [point for point in chart.points if key in point.counts]
    style.scatter(axes, points, lambda point: point.counts[key], _error, scale=0.5)
    # Explicit methods factorise nothing.
    explicit = any(point.counts[key] == 0 for point in points)
    axes.set_xscale("symlog", linthresh=10) if explicit else axes.set_xscale("log")
    axes.set_yscale("log")
    _finish(axes, name, "")
    if explicit:
        axes.set_xlim(left=-1.5)
    axes.set_title(f"Error against {name}", loc="left", color=_INK, fontsize=11)


def _finish(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(which="major", color="#e3e7ec", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(colors=_SOFT, which="both")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g} %"))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())


def _seconds(point: Point) -> float:
    return point.timing.best


def _error(point: Point) -> float:
    return point.error


def _unique(names: object) -> list[str]:
    return list(dict.fromkeys(names))  # type: ignore[call-overload]


def _pick(values: Sequence[str], index: int) -> str:
    return values[index % len(values)]
