"""The pictures of the study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from ancf.reproduce.dufva_shabana.paper import TABLE_1, TABLE_2, Seconds, pendulum
from ancf.reproduce.dufva_shabana.runs import BEST_MOTION, BEST_STATIC, EXPLICIT, MODELS, SOLID, THIN, Runs
from ancf.result import Result
from ancf.scene import Scene
from ancf.stage import Stage
from ancf.sweep import Variant
from ancf.text import plain_text

_STYLES: dict[str, dict[str, Any]] = {
    name: {"color": colour, "marker": marker, "linewidth": 1.6, "markersize": 6}
    for name, colour, marker in zip(
        [*MODELS, BEST_STATIC, BEST_MOTION],
        ["#0b6bcb", "#d1495b", "#8e5ea2", "#e08e0b", "#2a9d5c", "#2a9d5c"],
        "os^vDD",
        strict=True,
    )
}
_PAPER = {"linestyle": ":", "alpha": 0.75, "markerfacecolor": "white"}
_FACETS = 1200


def draw_deflections(runs: Runs) -> Figure:
    """Draw Fig. 3: the deflection of the cantilever over the number of elements."""
    figure, (axes,) = _panels(1, (8, 4.6))
    for name in (*MODELS, BEST_STATIC):
        rows = [
            (n, outcome) for (kind, model, n), outcome in runs.outcomes.items() if (kind, model) == ("cantilever", name)
        ]
        well = [(n, outcome.probes["corner"].value[-1, 2]) for n, outcome in rows if outcome.status == "ok"]
        axes.plot(*zip(*well, strict=True), label=name, **_STYLES[name])
    _finish(axes, "elements along the plate", "deflection of the corner / m", log_y=False)
    axes.set_title("Fig. 3: steel cantilever under 30 N", loc="left")
    axes.legend(frameon=False, fontsize=9)
    return figure


def draw_times(runs: Runs) -> Figure:
    """Draw Tables 1 and 2: simulation times, ours and the paper's."""
    figure, panels = _panels(2, (12.5, 5))
    tables: list[tuple[Axes, str, Mapping[Any, Seconds]]]
    tables = [(panels[0], "mesh", TABLE_1), (panels[1], "thickness", TABLE_2)]
    for axes, example, printed in tables:
        for name in (THIN, SOLID, BEST_MOTION):
            rows = [(v, runs.seconds((k, m, v))) for k, m, v in runs.outcomes if (k, m) == (example, name)]
            well = [(value, seconds) for value, seconds in rows if seconds is not None]
            axes.plot(*zip(*well, strict=True), label=name, **_STYLES[name])
        _draw_printed(axes, printed)
        label = "elements along each side" if example == "mesh" else "thickness / m"
        _finish(axes, label, "simulation time / s", log_y=True)
        axes.set_title("Table 1: finer meshes" if example == "mesh" else "Table 2: thinner plates", loc="left")
    panels[1].invert_xaxis()
    panels[0].legend(frameon=False, fontsize=9)
    return figure


def _draw_printed(axes: Axes, printed: Mapping[Any, Seconds]) -> None:
    for name, key in ((THIN, "thin"), (SOLID, "solid")):
        values = [getattr(row, key) for row in printed.values()]
        axes.plot(list(printed), values, label=f"{name}, paper", **{**_STYLES[name], **_PAPER})


def draw_steps(runs: Runs) -> Figure:
    """Draw what Table 2 is about: steps over thickness."""
    figure, (axes,) = _panels(1, (8, 4.4))
    for example, method, line in (("thickness", "tr_bdf2", "-"), (EXPLICIT, "rk", "--")):
        for name in (THIN, SOLID):
            rows = [(v, o.counts.get("steps")) for (k, m, v), o in runs.outcomes.items() if (k, m) == (example, name)]
            well = [(value, count) for value, count in rows if count]
            axes.plot(*zip(*well, strict=True), label=f"{name}, {method}", **{**_STYLES[name], "linestyle": line})
    _finish(axes, "thickness / m", "steps", log_y=True)
    axes.invert_xaxis()
    axes.set_title("Steps over thickness, 2 x 2 elements", loc="left")
    axes.legend(frameon=False, fontsize=9)
    return figure


def solve_shapes(number: int) -> dict[str, Result]:
    """Run the pendulum of both models with 60 outputs, `number` x `number` elements."""
    outputs = np.linspace(0.005, 0.3, 60).tolist()
    results = {}
    for name in (THIN, SOLID):
        document = Variant.of(pendulum(), **MODELS[name], divisions=[number, number], outputs=outputs).scene
        result = Scene.of(document).solve(throw=False)
        results[name] = result
    return results


def draw_paths(results: Mapping[str, Result]) -> Figure:
    """Draw Fig. 4 and 5: the positions of A and B over time."""
    figure, panels = _panels(2, (12.5, 4.8))
    for axes, probe in zip(panels, "AB", strict=True):
        for name, result in results.items():
            record = result.probes[probe]
            colour = _STYLES[name]["color"]
            axes.plot(record.t, record.value[:, 2], color=colour, label=f"{name}: z")
            axes.plot(record.t, record.value[:, 0], color=colour, linestyle="--", label=f"{name}: x = y")
        _finish(axes, "t / s", f"position of {probe} / m", log_y=False, log_x=False)
        axes.set_title(f"Fig. {4 if probe == 'A' else 5}: point {probe}", loc="left")
    panels[0].legend(frameon=False, fontsize=9)
    return figure


def draw_shapes(results: Mapping[str, Result]) -> Figure:
    """Draw Fig. 6: the deformed shapes at three times."""
    with plain_text():
        figure = Figure(figsize=(15, 9), dpi=100, layout="constrained", facecolor="white")
        parts = iter(figure.subfigures(len(results), 3, squeeze=False).flat)
        for name, result in results.items():
            for t in (0.1, 0.2, 0.3):
                part, state = next(parts), int(np.abs(result.t - t).argmin())
                part.suptitle(f"{name}, t = {result.t[state]:.2g} s")
                Stage(part, result.model, result.q, _FACETS).draw(state)
        return figure


def _panels(number: int, size: tuple[float, float]) -> tuple[Figure, list[Axes]]:
    with plain_text():
        figure = Figure(figsize=size, dpi=110, layout="constrained", facecolor="white")
        return figure, [figure.add_subplot(1, number, index + 1) for index in range(number)]


def _finish(axes: Axes, x: str, y: str, *, log_y: bool, log_x: bool = True) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    if log_x:
        axes.set_xscale("log")
        axes.set_xticks(np.unique(np.concatenate([np.asarray(line.get_xdata()) for line in axes.lines])))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.minorticks_off()
    if log_y:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.grid(color="#e3e7ec", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
