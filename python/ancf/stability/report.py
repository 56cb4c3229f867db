"""The files of a map."""

from __future__ import annotations

import csv
import math
from collections import Counter
from pathlib import Path

from ancf.output import replacing
from ancf.pages import Block, Heading, Picture, Points, Table, Text
from ancf.pages.markdown import to_markdown
from ancf.pages.page import to_html
from ancf.stability.cells import ACCURATE, BALANCED, KINDS
from ancf.stability.picture import draw
from ancf.stability.scan import Map


def write_map(folder: Path, found: Map) -> list[Path]:
    """Write stability.png, stability.svg, stability.csv, stability.md and stability.html.

    Parameters
    ----------
    folder : Path
        Where to; it exists.
    found : Map
        What was found.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    paths = [folder / f"stability.{kind}" for kind in ("png", "svg", "csv", "md", "html")]
    with replacing(*paths[:3]) as (png, svg, table):
        figure = draw(found)
        figure.savefig(png, format="png")
        figure.savefig(svg, format="svg")
        _write_csv(table, found)
    with replacing(*paths[3:]) as (text, page):
        blocks = _blocks(found)
        text.write_text(to_markdown(blocks), encoding="utf-8")
        page.write_text(to_html(_title(found), blocks, folder), encoding="utf-8")
    return paths


def describe(found: Map) -> str:
    """Return for each method how many runs went how, for a terminal."""
    lines = []
    for row in _summary(found):
        lines.append(
            f"  {row[0]:18}"
            + ", ".join(f"{n} {name}" for n, name in zip(row[1:], KINDS.values(), strict=True) if n != "0")
        )
    return "\n".join(lines)


def _title(found: Map) -> str:
    return f"{found.scene.title or 'Scene'}: where methods fail"


def _summary(found: Map) -> list[list[str]]:
    methods = list(dict.fromkeys(cell.method for cell in found.cells))
    rows = []
    for method in methods:
        counts = Counter(cell.kind for cell in found.cells if cell.method == method)
        rows.append([method, *(str(counts[kind]) for kind in KINDS)])
    return rows


def _blocks(found: Map) -> list[Block]:
    limits = [[f"{value:g}", "unknown" if math.isnan(step) else f"{step:.3g}"] for value, step in found.limits.items()]
    rows = [
        [cell.method, f"{cell.value:g}", f"{cell.step:g}", KINDS[cell.kind], cell.remark]
        for cell in found.cells
        if cell.kind != "accurate"
    ]
    blocks: list[Block] = [
        Heading(_title(found), 1),
        Text(f"Every method at every step and every value of {found.parameter}."),
        Picture("stability.png", "The map"),
        Table(["method", *KINDS.values()], _summary(found)),
        Heading("How it is told"),
        Points(
            [
                f"{KINDS['accurate']}: each probe stays within {ACCURATE:.0%} of the size of its motion of a run of "
                "the same mesh with `esdirk` and rtol = 1e-5.",
                f"{KINDS['growth']}: kinetic and strain energy and what damping took exceed the work of the loads by "
                f"more than {BALANCED:.0%} of the energy that moves; {KINDS['blow-up']}: tenfold, or not finite.",
                f"{KINDS['refused']}: an explicit step above its limit, or a scene that cannot be run.",
                f"{KINDS['newton']}: the equations of a step could not be solved.",
            ]
        ),
        Heading("Explicit limit"),
        Table([found.parameter, "longest stable step / s"], limits),
        Heading("What is not accurate"),
        Table(["method", found.parameter, "step / s", "", "why"], rows),
    ]
    if found.missing:
        values = ", ".join(f"{value:g}" for value in found.missing)
        problem = "no run with small steps ended well, so nothing is called accurate there."
        blocks.append(Text(f"For {found.parameter} = {values} {problem}"))
    return blocks


def _write_csv(path: Path, found: Map) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["method", "step", found.parameter, "kind", "error", "energy_gain", "explicit_limit", "remark"])
        for cell in found.cells:
            numbers = (cell.error, cell.gain, found.limits[cell.value])
            blanks = ["" if math.isnan(number) else number for number in numbers]
            writer.writerow([cell.method, cell.step, cell.value, cell.kind, *blanks, cell.remark])
