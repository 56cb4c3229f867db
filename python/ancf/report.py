"""The short table that the command line prints."""

from __future__ import annotations

from collections.abc import Sequence

from ancf.probes import QUANTITIES
from ancf.result import Result


def describe(title: str, result: Result) -> str:
    """Say in a few lines how a run went and where it ended.

    Parameters
    ----------
    title : str
        Of the scene.
    result : Result
        What to describe.

    Returns
    -------
    str
        Several lines.
    """
    place = f"{result.run.parameter} = {result.reached:.6g} {result.run.unit}".rstrip()
    if len(result.jumps):
        place += f", jumped at {', '.join(f'{t:.4g}' for t in result.jumps)}"
    counts = ", ".join(f"{number} {name}" for name, number in result.counts.items())
    last = _last_state(result) if len(result.t) else []
    return "\n".join(
        [f"{title or 'Run'}: {result.status}, {place}", *last, f"  {counts}; {result.seconds['total']:.3g} s"]
    )


def _last_state(result: Result) -> list[str]:
    rows = []
    for probe in result.model.probes:
        values = _numbers(result.probes[probe.name].value[-1])
        rows.append((f"{probe.name} {probe.quantity}", values, QUANTITIES[probe.quantity].unit))
    for name in ("kinetic", "membrane", "bending", "loads", "dissipated"):
        rows.append((f"energy {name}", _numbers([getattr(result.energy, name)[-1]]), "J"))
    width = max(len(name) for name, _, _ in rows)
    return [f"  {name:{width}} {numbers} {unit}".rstrip() for name, numbers, unit in rows]


def _numbers(values: Sequence[float]) -> str:
    return "".join(f"{value:13.6g}" for value in values)
