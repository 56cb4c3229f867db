"""The short table that the command line prints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ancf.errors import show
from ancf.modal import AnyResult, ModalResult
from ancf.probes import QUANTITIES
from ancf.result import Result

_MODES = 20


def describe(title: str, result: AnyResult) -> str:
    """Say in a few lines how a run went and where it ended.

    Parameters
    ----------
    title : str
        Of the scene.
    result : Result or ModalResult
        What to describe.

    Returns
    -------
    str
        Several lines.
    """
    counts = ", ".join(f"{number} {name}" for name, number in result.counts.items())
    end = f"  {counts}; {result.seconds['total']:.3g} s"
    if isinstance(result, ModalResult):
        found = f"{len(result.frequency)} modes{_jumps(result)}"
        return "\n".join([f"{title or 'Run'}: {result.status}, {found}", *_modes(result), end])
    place = f"{result.run.parameter} = {result.reached:.6g} {result.run.unit}".rstrip() + _jumps(result)
    last = _last_state(result) if len(result.t) else []
    return "\n".join([f"{title or 'Run'}: {result.status}, {place}", *last, end])


def _jumps(result: AnyResult) -> str:
    return f", jumped at {', '.join(f'{t:.4g}' for t in result.jumps)}" if len(result.jumps) else ""


def _modes(result: ModalResult) -> list[str]:
    notes = {0: "  no stiffness", -1: "  unstable: grows, times 2 pi, at this rate"}
    rows = [
        f"  mode {number:<4} {frequency:13.6g} Hz{notes.get(int(np.sign(frequency)), '')}"
        for number, frequency in enumerate(result.frequency[:_MODES], 1)
    ]
    more = len(result.frequency) - _MODES
    return [*rows, f"  and {more} more"] if more > 0 else rows


def _last_state(result: Result) -> list[str]:
    rows = []
    for probe in result.model.probes:
        values = _numbers(result.probes[probe.name].value[-1])
        rows.append((f"{probe.name} {probe.quantity}", values, QUANTITIES[probe.quantity].unit))
    for reaction in result.reactions:
        body = f"{reaction.support.body} " if len(result.model.bodies) > 1 else ""
        at = f"support {body}{show(reaction.support.at)}"
        rows.append((f"{at} force", _numbers(reaction.force[-1]), "N"))
        rows.append((f"{at} moment", _numbers(reaction.moment[-1]), "N m"))
    for name in ("kinetic", "membrane", "bending", "loads", "dissipated"):
        rows.append((f"energy {name}", _numbers([getattr(result.energy, name)[-1]]), "J"))
    width = max(len(name) for name, _, _ in rows)
    return [f"  {name:{width}} {numbers} {unit}".rstrip() for name, numbers, unit in rows]


def _numbers(values: Sequence[float]) -> str:
    return "".join(f"{value:13.6g}" for value in values)
