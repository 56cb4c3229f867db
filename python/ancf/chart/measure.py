"""Measuring a chart: all its runs, first for their errors, then for their times."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ancf.chart.axes import Axes, grid, with_few_outputs
from ancf.chart.labels import Label
from ancf.chart.points import Lost, Point, Rival
from ancf.chart.reference import Candidates, Reference
from ancf.errors import InputError, Mistake
from ancf.run import Dynamic
from ancf.scene import Scene
from ancf.sweep import Outcome, Variant, sweep, time_alone
from ancf.sweep.executors import processors

_SHARE = 0.85
"""Of the budget; the rest is for repetitions."""
_LEAST = 5.0
"""Seconds that every run may take."""
_TIGHTER = 0.1
_TOLERANCES = (1e-3,)
_OMITTED = "the time budget did not reach so far; the same command again goes on, --budget gives more"


@dataclass(frozen=True)
class Chart:
    """What was measured.

    Parameters
    ----------
    scene : Scene
        What was charted.
    reference : Reference
        What errors are measured against.
    points : list of Point
        The runs that ended well.
    lost : list of Lost
        The others.
    repeats : tuple of int
        How often runs were timed: the fewest and the most.
    seconds : float
        What this call took.
    remarks : tuple of str
        What else to know about how it was measured.
    """

    scene: Scene
    reference: Reference
    points: list[Point]
    lost: list[Lost]
    repeats: tuple[int, int]
    seconds: float
    remarks: tuple[str, ...] = ()

    def beside(self, rivals: Iterable[Rival], *remarks: str) -> Chart:
        """Return the chart with runs of other programs as further points, their errors against its own reference.

        Parameters
        ----------
        rivals : iterable of Rival
            The runs.
        *remarks : str
            How they were measured.
        """
        points = [
            Point(
                label=rival.label,
                scene={},
                own=False,
                timing=rival.timing,
                counts={"elements": rival.elements},
                error=self.reference.error(rival.probes),
                space=math.nan,
                time=math.nan,
            )
            for rival in rivals
        ]
        return replace(self, points=self.points + points, remarks=self.remarks + remarks)


def measure(
    scene: Scene,
    axes: Axes,
    log: Path,
    *,
    budget: float,
    executor: Executor | None = None,
    repeats: int = 3,
    progress: bool = False,
) -> Chart:
    """Run the scene in all its variants.

    Parameters
    ----------
    scene : Scene
        What to chart.
    axes : mapping of str to sequence
        What varies, see `ancf.chart.axes`.
    log : Path
        Where outcomes are kept; what is there already is not run again.
    budget : float
        About how long it may take, s. Runs that cost most are omitted first.
    executor : concurrent.futures.Executor, optional
        Where errors are found; timings are always taken on this machine, alone.
    repeats : int, default 3
        How often each run is timed, as far as the budget goes.
    progress : bool, default False
        Show bars on a terminal.

    Returns
    -------
    Chart
        Points, and what has none.

    Raises
    ------
    InputError
        If the scene has no probes, or there is no reference.
    """
    began = time.monotonic()
    if not scene.model.probes:
        raise InputError(Mistake(("probe",), "is missing: a chart shows the errors of probes"))
    plan = Plan.of(with_few_outputs(scene), axes)
    # What several processors do now one of them is timed at afterwards.
    share = _SHARE * budget / (2 if executor else 1 + processors())
    found = plan.run(log, limit=max(_LEAST, budget / 4), budget=share, executor=executor, progress=progress)
    reference = plan.candidates.choose(found)
    well = [variant for variant in plan.runs if (outcome := found.get(variant.digest)) and outcome.status == "ok"]
    timings = time_alone(
        well,
        log,
        repeats=repeats,
        limit=budget,
        budget=budget - (time.monotonic() - began),
        progress="times " if progress else None,
    )
    timed = {variant.digest: timing for variant, timing in zip(well, timings, strict=True)}
    points: list[Point] = []
    lost: list[Lost] = []
    for variant in plan.runs:
        outcome, timing = found.get(variant.digest), timed.get(variant.digest)
        label = Label.of(variant.scene)
        if outcome is None or outcome.status != "ok":
            status, reason = ("omitted", _OMITTED) if outcome is None else (outcome.status, outcome.reason)
            lost.append(Lost(label, status, reason))
        elif timing is None:
            lost.append(Lost(label, "omitted", "it ended well, but not a second time, alone, to be timed"))
        else:
            exact = found.get(plan.tight[label.space].digest) if plan.tight else outcome
            known = exact is not None and exact.status == "ok"
            points.append(
                Point(
                    label=label,
                    scene=variant.scene,
                    own=variant is plan.own,
                    timing=timing,
                    counts=outcome.counts,
                    error=reference.error(outcome.probes),
                    space=reference.error(exact.probes) if exact and known else math.nan,
                    time=reference.error(outcome.probes, exact.probes) if exact and known else math.nan,
                )
            )
    numbers = [len(point.timing.seconds) for point in points] or [0]
    return Chart(scene, reference, points, lost, (min(numbers), max(numbers)), time.monotonic() - began)


@dataclass(frozen=True)
class Plan:
    """What is run for a chart.

    Parameters
    ----------
    own : Variant
        The scene as it is given, but for its outputs.
    runs : list of Variant
        All that may become points, the cheapest first.
    tight : dict of str to Variant
        For each element and mesh the run that shows the error in space alone; none in statics.
    candidates : Candidates
        What the reference is made from.
    """

    own: Variant
    runs: list[Variant]
    tight: dict[str, Variant]
    candidates: Candidates

    @classmethod
    def of(cls, scene: Scene, axes: Axes) -> Plan:
        """Make the plan for a scene with the outputs of a chart."""
        own = Variant.of(scene)
        runs = {variant.digest: variant for variant in (own, *grid(scene, axes))}
        tightest = min(axes.get("rtol", _TOLERANCES))
        tight: dict[str, Variant] = {}
        if isinstance(scene.run, Dynamic):
            for variant in list(runs.values()):
                space = {key: value for key, value in variant.settings.items() if key not in Dynamic.model_fields}
                exact = Variant.of(scene, **space, method="esdirk", rtol=_TIGHTER * tightest)
                tight[Label.of(variant.scene).space] = exact
                runs.setdefault(exact.digest, exact)
        finest = max(axes.get("mesh", [1.0]))
        ordered = sorted(runs.values(), key=lambda variant: variant.effort)
        return cls(own, ordered, tight, Candidates.of(scene, finest, tightest))

    def run(
        self, log: Path, *, limit: float, budget: float, executor: Executor | None, progress: bool
    ) -> dict[str, Outcome]:
        """Run all of it and return what there is time for, under the digests of the variants."""
        among = self.candidates
        # What others are measured against goes first.
        runs = [among.first, among.other, among.coarser, self.own, *self.tight.values(), *self.runs]
        how: dict[str, Any] = {"limit": limit, "executor": executor}
        found = _found(runs, log, "errors " if progress else None, budget=budget, **how)
        if among.first.digest not in found or found[among.first.digest].status != "ok":
            spare = [among.spare, among.spare_coarser]
            found |= _found(spare, log, "reference " if progress else None, **how)
        return found


def _found(variants: list[Variant], log: Path, progress: str | None, **how: Any) -> dict[str, Outcome]:
    """Return the outcomes that there are under the digests of the variants."""
    outcomes = sweep(variants, log, progress=progress, **how)
    return {variant.digest: found for variant, found in zip(variants, outcomes, strict=True) if found is not None}
