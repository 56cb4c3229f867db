"""The picture of a map: a panel for each method."""

from __future__ import annotations

import math

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from ancf.stability.cells import ACCURATE, KINDS, Kind
from ancf.stability.scan import Map
from ancf.text import plain_text

COLOURS: dict[Kind, str] = {
    "accurate": "#3a9d68",
    "wrong": "#f2c14e",
    "unknown": "#f7e3ae",
    "growth": "#e8743b",
    "newton": "#8a6bbf",
    "blow-up": "#b3202c",
    "refused": "#c9d0d8",
    "time limit": "#6b7785",
}
_INK, _SOFT = "#1c2430", "#5d6b7c"
_UNITS = {"E": "Pa", "thickness": "m", "viscosity": "s", "mass_damping": "1/s", "mesh": "times the divisions"}


def draw(found: Map) -> Figure:
    """Draw a map.

    Parameters
    ----------
    found : Map
        What was found.

    Returns
    -------
    matplotlib.figure.Figure
        To be saved with its ``savefig``.
    """
    with plain_text(), mpl.rc_context({"axes.edgecolor": _SOFT}):
        return _draw(found)


def _draw(found: Map) -> Figure:
    methods = list(dict.fromkeys(cell.method for cell in found.cells))
    columns = min(3, len(methods))
    rows = math.ceil(len(methods) / columns)
    figure = Figure(figsize=(4.6 * columns + 0.6, 3.6 * rows + 1.4), dpi=120, layout="constrained", facecolor="white")
    figure.suptitle(f"{found.scene.title or 'Scene'}: where methods fail", fontsize=16, color=_INK, x=0.01, ha="left")
    steps = sorted({cell.step for cell in found.cells})
    values = sorted({cell.value for cell in found.cells})
    panels = np.atleast_1d(figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)).ravel()
    for axes, method in zip(panels, methods, strict=False):
        _draw_panel(axes, found, method, steps, values)
    for axes in panels[len(methods) :]:
        axes.axis("off")
    for axes in panels[-columns:]:
        axes.set_xlabel("step / s", color=_INK)
    unit = _UNITS.get(found.parameter, "")
    for axes in panels[::columns]:
        axes.set_ylabel(f"{found.parameter} / {unit}" if unit else found.parameter, color=_INK)
    _draw_legend(figure, found)
    return figure


def _draw_panel(axes: Axes, found: Map, method: str, steps: list[float], values: list[float]) -> None:
    for cell in found.cells:
        if cell.method == method:
            corner = (steps.index(cell.step) - 0.5, values.index(cell.value) - 0.5)
            axes.add_patch(Rectangle(corner, 1, 1, facecolor=COLOURS[cell.kind], edgecolor="white", linewidth=1.5))
            if not math.isnan(cell.error):
                percent = 100 * cell.error
                text = "< 0.01" if percent < 0.01 else f"{percent:.2g}" if percent < 999.5 else "> 999"
                middle = (corner[0] + 0.5, corner[1] + 0.5)
                axes.text(*middle, text, ha="center", va="center", fontsize=8, color=_INK)
    known = [(_place(found.limits[value], steps), row) for row, value in enumerate(values)]
    line = [(x, row) for x, row in known if not math.isnan(x)]
    if line:
        x = np.repeat([place for place, _ in line], 2)
        y = np.array([(row - 0.5, row + 0.5) for _, row in line]).ravel()
        axes.plot(np.clip(x, -0.5, len(steps) - 0.5), y, color=_INK, linewidth=1.6, linestyle="--")
    if method != "newmark":
        _draw_trapezoidal(axes, found, steps, values)
    axes.set_xlim(-0.5, len(steps) - 0.5)
    axes.set_ylim(-0.5, len(values) - 0.5)
    axes.set_xticks(range(len(steps)), [f"{step:.2g}" for step in steps])
    axes.set_yticks(range(len(values)), [f"{value:.2g}" for value in values])
    axes.tick_params(length=0, labelsize=8.5, colors=_SOFT)
    axes.spines[:].set_visible(False)
    axes.set_title(method.replace("_", " "), loc="left", fontsize=12, color=_INK)


def _draw_trapezoidal(axes: Axes, found: Map, steps: list[float], values: list[float]) -> None:
    """Outline where the trapezoidal rule gains energy or fails."""
    bad = {
        (steps.index(cell.step), values.index(cell.value))
        for cell in found.cells
        if cell.method == "newmark" and cell.kind in ("growth", "newton", "blow-up")
    }
    for x, y in bad:
        for (dx, dy), ends in (
            ((-1, 0), ((-0.5, -0.5), (-0.5, 0.5))),
            ((1, 0), ((0.5, 0.5), (-0.5, 0.5))),
            ((0, -1), ((-0.5, 0.5), (-0.5, -0.5))),
            ((0, 1), ((-0.5, 0.5), (0.5, 0.5))),
        ):
            if (x + dx, y + dy) not in bad:
                axes.plot([x + end for end in ends[0]], [y + end for end in ends[1]], color=_INK, linewidth=1.6)


def _place(step: float, steps: list[float]) -> float:
    """Return where a step lies on the axis, whose cells are as wide as the ratios of its steps."""
    if math.isnan(step) or len(steps) < 2:
        return math.nan
    return float(
        np.interp(math.log(step), np.log(steps), range(len(steps)))
        if steps[0] <= step <= steps[-1]
        else (-1.0 if step < steps[0] else len(steps))
    )


def _draw_legend(figure: Figure, found: Map) -> None:
    seen = [kind for kind in KINDS if any(cell.kind == kind for cell in found.cells)]
    handles: list[Patch | Line2D] = [Patch(facecolor=COLOURS[kind], label=KINDS[kind]) for kind in seen]
    if any(not math.isnan(limit) for limit in found.limits.values()):
        handles.append(Line2D([], [], color=_INK, linestyle="--", label="explicit limit, 2 / highest frequency"))
    if any(cell.method == "newmark" for cell in found.cells):
        handles.append(Line2D([], [], color=_INK, label="the trapezoidal rule fails inside"))
    title = f"numbers: error in percent of the motion, accurate up to {100 * ACCURATE:g}"
    figure.legend(
        handles=handles, loc="outside lower left", ncols=5, frameon=False, fontsize=9.5, title=title, alignment="left"
    )
