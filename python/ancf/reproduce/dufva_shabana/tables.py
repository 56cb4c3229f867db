"""The tables of the study: ours beside the figures of the paper."""

from __future__ import annotations

from collections.abc import Mapping

from ancf.pages import Table
from ancf.reproduce.dufva_shabana.paper import TABLE_1, TABLE_2, Seconds
from ancf.reproduce.dufva_shabana.runs import (
    BEST_MOTION,
    BEST_STATIC,
    EXPLICIT,
    MODELS,
    SOLID,
    THIN,
    Key,
    Runs,
)
from ancf.reproduce.dufva_shabana.velocities import Steps

_MISSING = "-"


def deflections(runs: Runs) -> Table:
    """Return the deflection of the cantilever, m, for Fig. 3."""
    names = [*MODELS, BEST_STATIC]
    rows = []
    for number in _values(runs, "cantilever"):
        cells = [_position(runs, ("cantilever", name, number), "corner", digits=5)[-1] for name in names]
        rows.append([f"{number:g}", *cells])
    return Table(["elements", *names], rows)


def times(runs: Runs, example: str) -> Table:
    """Return simulation times over mesh or thickness, beside Table 1 or Table 2, s."""
    first, printed = ("elements", TABLE_1) if example == "mesh" else ("thickness / m", TABLE_2)
    head = [first, "Model I", "Model II", "ratio", "paper: Model I", "Model II", "ratio", "our ratio / paper's"]
    rows = []
    for value in _values(runs, example):
        paper = _of_paper(printed, value)
        thin, solid = (runs.seconds((example, name, value)) for name in (THIN, SOLID))
        ratio = solid / thin if thin and solid else None
        rows.append(
            [
                f"{value:g} x {value:g}" if example == "mesh" else f"{value:g}",
                _seconds(thin),
                _seconds(solid),
                _ratio(ratio),
                f"{paper.thin:g} s",
                f"{paper.solid:g} s",
                f"{paper.ratio:g}",
                _ratio(ratio / paper.ratio if ratio else None),
            ]
        )
    return Table(head, rows)


def further_times(runs: Runs, example: str) -> Table:
    """Return simulation times of the other elements and of the best settings, s."""
    names = ["thin48", "full48b", BEST_MOTION]
    rows = []
    for value in _values(runs, example):
        label = f"{value:g} x {value:g}" if example == "mesh" else f"{value:g}"
        rows.append([label, *(_seconds(runs.seconds((example, name, value))) for name in names)])
    return Table(["elements" if example == "mesh" else "thickness / m", *names], rows)


def steps(runs: Runs) -> Table:
    """Return steps over thickness: of TR-BDF2, and of an explicit method with error control."""
    head = ["thickness / m"]
    head += [f"{method}, {name.partition(',')[0]}" for method in ("tr_bdf2", "rk") for name in (THIN, SOLID)]
    head += ["rk: Model I", "Model II", "ratio", "paper's ratio"]
    rows = []
    for value in _values(runs, EXPLICIT):
        counts = [
            str(runs.outcomes[key].counts.get("steps", _MISSING)) if key in runs.outcomes else _MISSING
            for example in ("thickness", EXPLICIT)
            for key in ((example, THIN, value), (example, SOLID, value))
        ]
        thin, solid = (runs.seconds((EXPLICIT, name, value)) for name in (THIN, SOLID))
        ratio = solid / thin if thin and solid else None
        rows.append(
            [
                f"{value:g}",
                *counts,
                _seconds(thin),
                _seconds(solid),
                _ratio(ratio),
                f"{_of_paper(TABLE_2, value).ratio:g}",
            ]
        )
    return Table(head, rows)


def velocities(found: Mapping[tuple[float, str, float], Steps]) -> Table:
    """Return steps and iterations over thickness where all coordinates and velocities keep the tolerance."""
    rows = []
    for rtol in dict.fromkeys(rtol for rtol, _, _ in found):
        for thickness in dict.fromkeys(thickness for _, _, thickness in found):
            both = [found[rtol, name, thickness] for name in (THIN, SOLID)]
            rows.append([f"{rtol:g}", f"{thickness:g}", *(f"{run.steps}" for run in both)])
            rows[-1] += [f"{run.iterations}" for run in both]
    head = ["rtol", "thickness / m", "Model I: steps", "Model II: steps", "Model I: iterations", "Model II: iterations"]
    return Table(head, rows)


def positions(runs: Runs) -> Table:
    """Return the positions of A and B at the end, m, for Fig. 4 and 5."""
    head = ["elements", "model", "A: x = y", "A: z", "B: x = y", "B: z"]
    rows = []
    for number in _values(runs, "mesh"):
        for name in (*MODELS, BEST_MOTION):
            a, b = (_position(runs, ("mesh", name, number), probe) for probe in "AB")
            rows.append([f"{number:g} x {number:g}", name, a[0], a[-1], b[0], b[-1]])
    return Table(head, rows)


def lost(runs: Runs) -> Table | None:
    """Return the runs that did not end well, with their reasons."""
    rows = [
        [f"{name}, {example} {value:g}", outcome.status, outcome.reason]
        for (example, name, value), outcome in runs.outcomes.items()
        if outcome.status != "ok"
    ]
    return Table(["run", "how it ended", "why"], rows) if rows else None


def _values(runs: Runs, example: str) -> list[float]:
    return list(dict.fromkeys(value for kind, _, value in runs.outcomes if kind == example))


def _of_paper(printed: dict[int, Seconds] | dict[float, Seconds], value: float) -> Seconds:
    return dict(printed.items())[value]


def _position(runs: Runs, key: Key, probe: str, digits: int = 4) -> list[str]:
    outcome = runs.outcomes.get(key)
    if outcome is None or outcome.status != "ok":
        return [_MISSING] * 3
    return [f"{component:.{digits}f}" for component in outcome.probes[probe].value[-1]]


def _seconds(value: float | None) -> str:
    return _MISSING if value is None else f"{value:.3g} s"


def _ratio(value: float | None) -> str:
    return _MISSING if value is None else f"{value:.3g}"
