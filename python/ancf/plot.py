"""Pictures of results: the bodies at rest and deformed, what the probes recorded, mode shapes."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase

from ancf.errors import InputError, Mistake
from ancf.inputs import whole
from ancf.modal import ModalResult
from ancf.probes import QUANTITIES, Probe, Quantity
from ancf.result import Result
from ancf.stage import Stage, short
from ancf.text import plain_text

_FACETS = 2500
_FACETS_OF_MODES = 900
_EARLIER_SHAPES = 3
_STYLES = ("-", "--", ":")


def plot(result: Result, title: str = "") -> Figure:
    """Draw the bodies at rest and deformed, and the records of the probes.

    Parameters
    ----------
    result : Result
        What to draw.
    title : str, optional
        Written above.

    Returns
    -------
    matplotlib.figure.Figure
        To be saved with its ``savefig``.
    """
    with plain_text():
        return _plot(result, title)


def _plot(result: Result, title: str) -> Figure:
    probes = result.model.probes
    figure = Figure(figsize=(12.5 if probes else 8, 6.5), dpi=130, layout="constrained")
    figure.suptitle(heading(result, -1, title), fontsize="x-large")
    columns = 2 if probes else 1
    parts = figure.subfigures(1, columns, squeeze=False, width_ratios=(1.3, 1)[:columns])[0]
    if probes:
        _draw_records(parts[1], result)
    Stage(parts[0], result.model, result.q, _FACETS).draw(len(result.t) - 1, between=_EARLIER_SHAPES)
    return figure


def plot_modes(result: ModalResult, title: str = "", count: int = 6) -> Figure:
    """Draw the shapes of the first modes that are not rigid, see `ModalResult.plot`."""
    with plain_text():
        return _plot_modes(result, title, count)


def _plot_modes(result: ModalResult, title: str, count: int) -> Figure:
    if not result.states:
        raise InputError(Mistake(("result",), "must hold at least one mode to be drawn"))
    shown = result.visible()[: whole("count", count, 1, 1000)]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    figure = Figure(figsize=(4.2 * columns, 3.6 * rows + 0.6), dpi=130, layout="constrained")
    figure.suptitle(title, fontsize="x-large")
    # Labels in space are not laid out: those of the last column need room beside it.
    widths = [*[1.0] * columns, 0.08]
    parts = figure.subfigures(rows, columns + 1, squeeze=False, width_ratios=widths)[:, :columns].ravel()
    for part, mode in zip(parts, shown, strict=False):
        part.suptitle(mode_name(result, mode))
        q = result.oscillation(mode, [np.pi / 2])
        Stage(part, result.model, q, _FACETS_OF_MODES, rest=result.q, bar=False).draw(0)
    return figure


def mode_name(result: ModalResult, mode: int) -> str:
    """Say which mode it is, counted from 1, and its frequency."""
    return f"mode {mode + 1}: {result.frequency[mode]:.4g} Hz"


def heading(result: Result, state: int, title: str) -> str:
    """Say what is drawn: the title, and the time or load factor of a state."""
    place = f"{result.run.parameter} = {result.t[state]:.4g} {result.run.unit}".rstrip()
    return f"{title}, {place}" if title else place


def _draw_records(figure: FigureBase, result: Result) -> None:
    """Draw the probes of each quantity into axes of their own."""
    groups: dict[Quantity, list[Probe]] = {}
    for probe in result.model.probes:
        groups.setdefault(probe.quantity, []).append(probe)
    panels = figure.subplots(len(groups), 1, sharex=True, squeeze=False)[:, 0]
    colours = {probe.name: f"C{index}" for index, probe in enumerate(result.model.probes)}
    for axes, (quantity, probes) in zip(panels, groups.items(), strict=True):
        _draw_quantity(axes, result, quantity, probes, colours)
    panels[-1].set_xlabel(" / ".join(part for part in (result.run.parameter, result.run.unit) if part))


def _draw_quantity(
    axes: Axes, result: Result, quantity: Quantity, probes: list[Probe], colours: dict[str, str]
) -> None:
    unit, components = QUANTITIES[quantity]
    marker = "o" if len(result.t) < 20 else ""
    for probe in probes:
        record = result.probes[probe.name]
        for values, component, style in zip(record.value.T, components, _STYLES, strict=False):
            label = f"{short(probe.name)} {component}".rstrip()
            axes.plot(record.t, values, style, marker=marker, markersize=3.5, color=colours[probe.name], label=label)
    axes.set_ylabel(" / ".join(part for part in (quantity.replace("_", " "), unit) if part))
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(ncols=len(probes), fontsize="small", frameon=False, loc="best")
