"""The picture of a plan."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from ancf.plan.report import Plan
from ancf.probes import QUANTITIES
from ancf.text import plain_text

_STYLES = ("-", "--", ":")
_DECADES = 100.0
"""Longer axes have labels at powers of ten only."""
_ROUNDING = 1e-16
"""Errors that are smaller, or none, are drawn here: the axis is logarithmic."""


def draw(plan: Plan) -> Figure:
    """Draw errors over costs of what was tried, and what is wanted of the choice.

    Parameters
    ----------
    plan : Plan
        What to draw.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels.
    """
    with plain_text():
        figure = Figure(figsize=(9, 3.6), dpi=130, layout="constrained")
        left, right = figure.subplots(1, 2)
        tried: dict[str, list[tuple[float, float]]] = {}
        for row in plan.rows:
            if row.error is not None:
                error = max(row.error, _ROUNDING)
                tried.setdefault(" ".join(row.settings.split()[:2]), []).append((row.seconds, error))
        for name, points in tried.items():
            left.loglog(*zip(*points, strict=True), "o", markersize=4, label=name)
        row = plan.rows[plan.chosen]
        if row.error is not None:
            error = max(row.error, _ROUNDING)
            left.loglog(row.seconds, error, "o", markersize=11, fillstyle="none", color="black", label="chosen")
        left.axhline(plan.tol, color="gray", linewidth=1, label="tolerance")
        for axis in (left.xaxis, left.yaxis):
            low, high = axis.get_view_interval()
            subs = (1.0, 2.0, 5.0) if high < _DECADES * low else (1.0,)
            axis.set_major_locator(LogLocator(subs=subs, numticks=8))
            axis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.set_minor_locator(NullLocator())
        left.set_xlabel("time of the run / s")
        left.set_ylabel("estimated error, relative")
        left.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
        probes = [probe for probe in plan.scene.model.probes if probe.name in plan.scale]
        for index, probe in enumerate(probes):
            record = plan.result.probes[probe.name]
            change = (record.value - record.value[0]) / plan.scale[probe.name]
            for values, component, style in zip(change.T, QUANTITIES[probe.quantity].components, _STYLES, strict=False):
                right.plot(record.t, values, style, color=f"C{index}", label=f"{probe.name} {component}")
        run = plan.result.run
        right.set_xlabel(" / ".join(part for part in (run.parameter, run.unit) if part))
        right.set_ylabel("change, relative to its largest")
        right.legend(fontsize="small", frameon=False)
        for axes in (left, right):
            axes.grid(alpha=0.25)
            axes.spines[["top", "right"]].set_visible(False)
    return figure
