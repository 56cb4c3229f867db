"""The files of a chart: pictures, a table, a report and a page in which each point tells its settings."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import tomli_w

from ancf.chart.labels import Label
from ancf.chart.measure import Chart
from ancf.chart.picture import PALETTE, draw
from ancf.chart.points import Point, front, percent, winners
from ancf.output import replacing
from ancf.pages import Block, Fold, Heading, Picture, Points, Script, Table, Text
from ancf.pages.markdown import to_markdown
from ancf.pages.page import to_html

FILES = ("chart.png", "chart.svg", "chart.csv", "chart.md", "chart.html")
_COUNTS = ("elements", "dofs", "steps", "rejected", "iterations", "factorizations", "forces")
_OF_BODIES = ("divisions", "element", "membrane", "curvature")
_OF_RUN = ("method", "alpha", "rho_inf", "lumped", "step", "rtol", "newton", "tolerance")


def write_chart(folder: Path, chart: Chart) -> list[Path]:
    """Write chart.png, chart.svg, chart.csv, chart.md and chart.html.

    Parameters
    ----------
    folder : Path
        Where to; it exists.
    chart : Chart
        What was measured.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OSError
        If a file cannot be written; an earlier chart is left as it was.
    """
    paths = [folder / name for name in FILES]
    with replacing(*paths) as (png, svg, table, report, page):
        figure = draw(chart)
        figure.savefig(png, format="png")
        figure.savefig(svg, format="svg")
        _write_csv(table, chart)
        report.write_text(to_markdown(_blocks(chart, Picture("chart.png", "The chart"))), encoding="utf-8")
        title = f"{chart.scene.title or 'Scene'}: what accuracy costs"
        page.write_text(to_html(title, _blocks(chart, _interactive(chart)), folder), encoding="utf-8")
    return paths


def describe(chart: Chart) -> str:
    """Return the reference and the winners in a few lines, for a terminal."""
    lines = [_about_reference(chart)]
    for row in _winner_rows(chart):
        lines.append("  " + "  ".join(cell for cell in row if cell))
    return "\n".join(lines)


def _blocks(chart: Chart, shown: Block) -> list[Block]:
    lost = f"{len(chart.lost)} runs without a point" if chart.lost else "Every run has a point"
    best = [_row(point) for point in front(chart.points)]
    head = ["element", "mesh", "method", "accuracy", "seconds", "error", "in space", "in time"]
    return [
        Heading(f"{chart.scene.title or 'Scene'}: what accuracy costs", 1),
        Text(_about_reference(chart)),
        Table(["within", "settings", "seconds", "error", ""], _winner_rows(chart)),
        shown,
        Heading("Faster or more accurate"),
        Text("No run is both faster and more accurate than one of these."),
        Table(head, best),
        Heading(lost),
        Table(["how it ended", "runs", "which", "why"], _lost_rows(chart)) if chart.lost else Text(""),
        Heading("How it was measured"),
        Points(_about_measuring(chart)),
        Fold(f"All {len(chart.points)} points", [Table(head, [_row(point) for point in chart.points])]),
    ]


def _about_reference(chart: Chart) -> str:
    reference = chart.reference
    text = f"Reference: {Label.of(reference.variant.scene)}."
    if reference.other is None:
        text += " No other element confirms it."
    else:
        text += f" {Label.of(reference.other.scene)} differs from it by {percent(reference.disagreement)}."
    if not math.isnan(reference.refinement):
        text += f" The same element on the mesh half as fine differs by {percent(reference.refinement)}."
    return f"{text} So errors below {percent(reference.trust)} cannot be told apart."


def _about_measuring(chart: Chart) -> list[str]:
    scale = ", ".join(f"{name} {size:.4g}" for name, size in chart.reference.scale.items())
    fewest, most = chart.repeats
    times = f"{fewest} to {most} times" if fewest != most else f"{most} times" if most > 1 else "once"
    return [
        "Error: the largest distance of a probe from the reference at any output, relative to the largest distance of "
        f"that probe from its start in the reference ({scale}); the worst probe counts.",
        "Error in space: that of the same element and mesh with `esdirk` and a tolerance ten times tighter than the "
        "tightest of the chart. Error in time: the distance from that run."
        if any(point.time > 0 for point in chart.points)
        else "In statics all error is in space.",
        f"Wall time: one thread, each run alone on the machine, all runs in random order, {times}; the shortest "
        "counts. Set-up and results are included, the start of the process is not.",
        "Errors and counts come from an earlier run, several at a time.",
        *chart.remarks,
    ]


def _winner_rows(chart: Chart) -> list[list[str]]:
    rows = []
    for winner in winners(chart.points, chart.reference.trust):
        point = winner.point
        cells = ["", "", ""]
        if point is not None:
            cells = [str(point.label), f"{point.timing.best:.3g} s", percent(point.error)]
        rows.append([percent(winner.level), *cells, winner.remark])
    return rows


def _row(point: Point) -> list[str]:
    label = point.label
    cells = [label.element, label.mesh, label.method, label.accuracy, f"{point.timing.best:.3g} s"]
    return [*cells, percent(point.error), percent(point.space), percent(point.time)]


def _lost_rows(chart: Chart) -> list[list[str]]:
    """Return the runs without a point, those with equal reasons in one row."""
    groups: dict[tuple[str, str], list[Label]] = {}
    for run in chart.lost:
        groups.setdefault((run.status, run.reason), []).append(run.label)
    return [[status, str(len(labels)), _summary(labels), reason] for (status, reason), labels in groups.items()]


def _summary(labels: list[Label]) -> str:
    if len(labels) <= 3:
        return "; ".join(map(str, labels))
    kinds = (Counter(getattr(label, key) for label in labels) for key in ("element", "mesh", "method", "accuracy"))
    return "; ".join(", ".join(f"{name} ({number})" for name, number in kind.items()) for kind in kinds)


def _write_csv(path: Path, chart: Chart) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        counts = [name for name in _COUNTS if any(name in point.counts for point in chart.points)]
        head = ("status", "element", "mesh", "method", "accuracy", "seconds", "median_seconds", "repeats")
        writer.writerow([*head, "error", "error_space", "error_time", *counts, "reason"])
        for point in chart.points:
            label, timing = point.label, point.timing
            settings = (label.element, label.mesh, label.method, label.accuracy)
            times = (timing.best, timing.median, len(timing.seconds))
            errors = (point.error, _blank(point.space), _blank(point.time))
            writer.writerow(["ok", *settings, *times, *errors, *(point.counts.get(name, "") for name in counts), ""])
        for run in chart.lost:
            label = run.label
            settings = (label.element, label.mesh, label.method, label.accuracy)
            writer.writerow([run.status, *settings, *[""] * (6 + len(counts)), run.reason])


def _blank(value: float) -> float | str:
    return "" if math.isnan(value) else value


def _interactive(chart: Chart) -> Script:
    points = sorted(chart.points, key=lambda point: point.elements)
    elements = dict.fromkeys(point.label.element for point in chart.points)
    wins: dict[int, list[str]] = {}
    for winner in winners(chart.points, chart.reference.trust):
        wins.setdefault(id(winner.point), []).append(percent(winner.level))
    data = {
        "trust": None if math.isnan(chart.reference.trust) else chart.reference.trust,
        "colours": {name: PALETTE[index % len(PALETTE)] for index, name in enumerate(elements)},
        "methods": list(dict.fromkeys(point.label.method for point in chart.points)),
        "meshes": list(dict.fromkeys(point.label.mesh for point in points)),
        "points": [_datum(point, wins.get(id(point), [])) for point in points],
    }
    # Inside a script element "</" would end it.
    text = json.dumps(data, allow_nan=False).replace("</", "<\\/")
    return Script(
        files("ancf.chart").joinpath("interactive.html").read_text(encoding="utf-8").replace("/*DATA*/", text)
    )


def _datum(point: Point, wins: list[str]) -> dict[str, Any]:
    label = point.label
    return {
        "label": str(label),
        "element": label.element,
        "mesh": label.mesh,
        "method": label.method,
        "accuracy": label.accuracy,
        "own": point.own,
        "wins": wins,
        "error": point.error,
        "space": _null(point.space),
        "time": _null(point.time),
        "seconds": point.timing.best,
        "repeats": len(point.timing.seconds),
        **{name: point.counts[name] for name in _COUNTS if name in point.counts},
        "toml": _excerpt(point.scene) if point.scene else None,
    }


def _null(value: float) -> float | None:
    return None if math.isnan(value) else value


def _excerpt(scene: Mapping[str, Any]) -> str:
    """Return the lines of the scene file that the settings are in."""
    bodies = {name: _only(body, _OF_BODIES) for name, body in scene["body"].items()}
    run = _only(scene["run"], _OF_RUN)
    text = tomli_w.dumps({"body": bodies} | ({"run": run} if run else {}))
    # A run has one of both.
    for name, other in (("step", "rtol"), ("rtol", "step")):
        text = text.replace(f"\n{name} = ", f"\n# instead of {other}:\n{name} = ")
    # Short lists read better in one line.
    return text.replace("[\n    ", "[").replace(",\n    ", ", ").replace(",\n]", "]")


def _only(table: Mapping[str, Any], keys: Iterable[str]) -> dict[str, Any]:
    return {key: table[key] for key in keys if key in table}
