"""Cases of the suite, and what can be expected of their runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from ancf.records import Record
from ancf.stability.cells import energy_gain
from ancf.sweep import Outcome, Variant

Outcomes: TypeAlias = Mapping[str, Outcome]
Expectation: TypeAlias = Callable[[Outcomes], str]
"""Looks at the outcomes of a case under the names of its runs; returns what is wrong, or nothing."""


@dataclass(frozen=True)
class Case:
    """A few runs and what is expected of them.

    Parameters
    ----------
    name : str
        What is tried.
    runs : dict of str to Variant
        The runs, each with a name.
    expected : sequence of Expectation
        What must hold.
    quick : bool
        Whether it takes a few seconds only.
    """

    name: str
    runs: dict[str, Variant]
    expected: Sequence[Expectation]
    quick: bool

    def tell(self, outcome: Outcome) -> str:
        """Return how a run went, in a few words."""
        if outcome.status != "ok":
            return f"{outcome.status} ({outcome.reason.partition(':')[0]})"
        last = next(iter(outcome.probes.values())).value[-1]
        numbers = ", ".join(f"{number:.4g}" for number in last)
        return f"ok, {outcome.counts['steps']} steps, {outcome.counts['iterations']} iterations, ({numbers})"


def well(*names: str) -> Expectation:
    """Expect runs to end well; all of them if none is named."""

    def check(outcomes: Outcomes) -> str:
        bad = [f"{name}: {outcomes[name].reason}" for name in names or outcomes if outcomes[name].status != "ok"]
        return "; ".join(bad)

    return check


def balanced(*names: str, within: float) -> Expectation:
    """Expect that no energy comes from nowhere, relative to the energy that moves."""

    def check(outcomes: Outcomes) -> str:
        gains = {name: energy_gain(energy) for name in names or outcomes if (energy := outcomes[name].energy)}
        bad = [f"{name}: energy gain {gain:.2g}" for name, gain in gains.items() if not gain <= within]
        return "; ".join(bad)

    return check


def ends(status: str, *names: str, reason: str = "") -> Expectation:
    """Expect runs to end otherwise, and to say why."""

    def check(outcomes: Outcomes) -> str:
        bad = [
            f"{name}: {outcomes[name].status} {outcomes[name].reason}"
            for name in names
            if outcomes[name].status != status or reason not in outcomes[name].reason
        ]
        return "; ".join(bad)

    return check


def agree(*names: str, within: float) -> Expectation:
    """Expect the first probes to agree at their common outputs, relative to the size of the motion of the first run."""

    def check(outcomes: Outcomes) -> str:
        first = next(iter(outcomes[names[0]].probes.values()), None)
        if first is None:
            return f"{names[0]}: no values"
        size = np.linalg.norm(first.value - first.value[0], axis=1).max()
        bad = []
        for name in names[1:]:
            other = next(iter(outcomes[name].probes.values()), None)
            distance = np.nan if other is None else _distance(first, other) / size
            if not distance <= within:
                bad.append(f"{name} differs from {names[0]} by {distance:.2g}")
        return "; ".join(bad)

    return check


def _distance(first: Record, other: Record) -> float:
    """Return the largest distance at the times, or load factors, that two records share; nan if the ends differ."""
    if first.t[-1] != other.t[-1]:
        return float("nan")
    _, these, those = np.intersect1d(first.t, other.t, return_indices=True)
    return float(np.linalg.norm(first.value[these] - other.value[those], axis=1).max())


def near(name: str, value: Sequence[float], within: float) -> Expectation:
    """Expect the last values of the first probe of a run."""

    def check(outcomes: Outcomes) -> str:
        record = next(iter(outcomes[name].probes.values()), None)
        if record is None:
            return f"{name}: no values"
        distance = float(np.abs(record.value[-1] - np.array(value)).max())
        return "" if distance <= within else f"{name}: {record.value[-1]} instead of {value}"

    return check


def never_wrong(name: str, like: str, within: float) -> Expectation:
    """Expect a run to fail, or to agree with another: what it must not do is to end well with something else."""

    def check(outcomes: Outcomes) -> str:
        return agree(like, name, within=within)(outcomes) if outcomes[name].status == "ok" else ""

    return check


def fails_or_gains(name: str, more_than: float) -> Expectation:
    """Expect a run to fail, or to gain energy."""

    def check(outcomes: Outcomes) -> str:
        outcome = outcomes[name]
        gain = energy_gain(outcome.energy) if outcome.energy else np.inf
        kept = outcome.status == "ok" and gain <= more_than
        return f"{name} does well: energy gain {gain:.2g}" if kept else ""

    return check


def fewer_iterations(less: str, more: str) -> Expectation:
    """Expect one run to take fewer Newton iterations than another."""

    def check(outcomes: Outcomes) -> str:
        a, b = (outcomes[name].counts.get("iterations", 0) for name in (less, more))
        return "" if 0 < a < b else f"{less} takes {a} iterations, {more} {b}"

    return check


def closer(*names: str, to: str) -> Expectation:
    """Expect each run to come at least as close to another as the one before it."""

    def check(outcomes: Outcomes) -> str:
        if any(not outcomes[name].probes for name in (*names, to)):
            return "a run has no values"
        records = [next(iter(outcomes[name].probes.values())).value[-1] for name in (*names, to)]
        distances = [float(np.linalg.norm(value - records[-1])) for value in records[:-1]]
        bad = any(after > before for before, after in pairwise(distances))
        return f"distances {', '.join(f'{d:.2g}' for d in distances)} do not shrink" if bad else ""

    return check
