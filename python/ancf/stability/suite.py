"""The suite: cases in which such programs fail, each with what is expected of it."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from ancf.stability.cases import cases
from ancf.stability.expect import Case
from ancf.sweep import sweep


@dataclass(frozen=True)
class Verdict:
    """What became of a case.

    Parameters
    ----------
    case : Case
        Which.
    problems : list of str
        What was not as expected; empty if all was.
    told : str
        What was found, in a line.
    """

    case: Case
    problems: list[str]
    told: str


def run_suite(
    log: Path,
    *,
    quick: bool = False,
    limit: float = 300.0,
    executor: Executor | None = None,
    progress: bool = False,
) -> list[Verdict]:
    """Run the suite.

    Parameters
    ----------
    log : Path
        Where outcomes are kept; what is there already is not run again.
    quick : bool, default False
        Only the cases that take a few seconds.
    limit : float, default 300
        Seconds after which a run is stopped, unless its case says less.
    executor, progress
        As in `ancf.sweep.sweep`, whether to show a bar.

    Returns
    -------
    list of Verdict
        One for each case.
    """
    chosen = [case for case in cases() if case.quick or not quick]
    variants = [variant for case in chosen for variant in case.runs.values()]
    outcomes = sweep(variants, log, limit=limit, executor=executor, progress="suite " if progress else None)
    found = {v.digest: outcome for v, outcome in zip(variants, outcomes, strict=True) if outcome is not None}
    verdicts = []
    for case in chosen:
        named = {name: found[variant.digest] for name, variant in case.runs.items()}
        problems = [problem for expectation in case.expected if (problem := expectation(named))]
        told = "; ".join(f"{name}: {case.tell(outcome)}" for name, outcome in named.items())
        verdicts.append(Verdict(case, problems, told))
    return verdicts
