"""How a run went: its kind, told from its energy, its probes and the way it ended."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from ancf.records import Energy
from ancf.sweep import Outcome

Kind: TypeAlias = Literal["accurate", "wrong", "unknown", "growth", "newton", "blow-up", "refused", "time limit"]

KINDS: dict[Kind, str] = {
    "accurate": "stable and accurate",
    "wrong": "stable but wrong",
    "unknown": "stable, not judged",
    "growth": "energy grows",
    "newton": "Newton fails",
    "blow-up": "blow-up",
    "refused": "refused",
    "time limit": "too slow",
}
"""What each kind is called in pictures."""

ACCURATE = 0.05
"""Largest error of a probe, relative to the size of its motion."""
BALANCED = 0.05
"""Largest gain or loss of energy, relative to the energy that moves."""
_EXPLODED = 10.0
_LIMIT = re.compile(r"above the limit (\S+) s")


@dataclass(frozen=True)
class Cell:
    """A run of the map.

    Parameters
    ----------
    method : str
        The method.
    step : float
        s.
    value : float
        Of the stiffness parameter.
    kind : str
        One of `KINDS`.
    error : float
        The largest distance of a probe from that of a run with small steps, relative to the size of its motion; nan if
        either is not known.
    gain : float
        The energy that came from nowhere, relative to the energy that moves; negative where it was lost.
    remark : str
        In words.
    """

    method: str
    step: float
    value: float
    kind: Kind
    error: float
    gain: float
    remark: str


def classify(method: str, step: float, value: float, outcome: Outcome, exact: Outcome | None) -> Cell:
    """Tell how a run went.

    Parameters
    ----------
    method, step, value
        What was run, as in `Cell`.
    outcome : Outcome
        How the run ended.
    exact : Outcome or None
        The same with small steps, if that ended well.
    """
    gain = energy_gain(outcome.energy) if outcome.energy is not None else np.nan
    error = _error(outcome, exact) if outcome.status == "ok" else np.nan
    kind, remark = _judge(outcome, gain, error)
    return Cell(method, step, value, kind, error, gain, remark)


def _judge(outcome: Outcome, gain: float, error: float) -> tuple[Kind, str]:
    if outcome.status != "ok":
        return _failed(outcome, gain), outcome.reason
    if not np.isfinite(gain) or gain > _EXPLODED:
        return "blow-up", f"energy grows {gain:.1g} times"
    if gain > BALANCED:
        return "growth", f"{gain:.0%} more energy than it should have"
    if np.isnan(error):
        return "unknown", "no run with small steps to compare with"
    if error <= ACCURATE:
        return "accurate", f"error {error:.1%}"
    why = f"{-gain:.0%} of the energy is damped away" if gain < -BALANCED else "its energy is right"
    return "wrong", f"error {error:.0%}, {why}"


def _failed(outcome: Outcome, gain: float) -> Kind:
    if outcome.status == "refused" or _LIMIT.search(outcome.reason):
        return "refused"
    if outcome.status == "time limit":
        return "time limit"
    if gain > _EXPLODED or "infinite or not a number in the step" in outcome.reason:
        return "blow-up"
    return "growth" if gain > BALANCED else "newton"


def energy_gain(energy: Energy) -> float:
    """Return the largest gain, or if there is none the largest loss, relative to the energy that moves.

    That is the largest of kinetic energy, strain energy and the work of the loads; nan if there are no states.
    """
    if not len(energy.t):
        return np.nan
    strain = energy.membrane + energy.bending
    surplus = energy.kinetic + strain + energy.dissipated - energy.loads
    surplus = surplus - surplus[0]
    size = max(np.abs(part).max() for part in (energy.kinetic, strain, energy.loads))
    if not np.isfinite(surplus).all():
        return float(np.inf)
    if size == 0:
        return 0.0
    most, least = surplus.max() / size, surplus.min() / size
    return float(most if most > BALANCED or most >= -least else least)


def explicit_limit(outcome: Outcome) -> float:
    """Return the longest stable explicit step that a refusal tells, s; nan if there is none."""
    found = _LIMIT.search(outcome.reason)
    return float(found[1]) if found else np.nan


def _error(outcome: Outcome, exact: Outcome | None) -> float:
    if exact is None or exact.status != "ok":
        return np.nan
    errors = [0.0]
    for name, record in exact.probes.items():
        size = np.linalg.norm(record.value - record.value[0], axis=1).max()
        if size > 0:
            errors.append(np.linalg.norm(outcome.probes[name].value - record.value, axis=1).max() / size)
    return float(max(errors))
