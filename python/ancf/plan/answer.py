"""The answer: the choice, checked in time, with its reasons and all that was tried."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ancf.plan.errors import distance, scales
from ancf.plan.ladder import RIGID, apply
from ancf.plan.pilots import SLOW, Pilot, Pilots
from ancf.plan.report import Plan, Row
from ancf.plan.search import Search
from ancf.plan.shear import told
from ancf.plan.timing import SHARE
from ancf.result import Result
from ancf.scene import Scene

_ROUNDING = 1e-13
"""Relative differences below it are none."""


def of_search(
    search: Search,
    chosen: Pilot,
    in_space: float,
    in_time: float,
    scale: Sequence[float],
) -> Plan:
    """Return the plan that follows from a search."""
    pilots, tol, finest = search.pilots, search.tol, search.best
    errors = search.observed()
    converged = search.checked and in_space + in_time <= tol
    if chosen.choice.rung == finest:
        reason = f"{finest} is the finest rung that was run; no cheaper one is good enough."
    elif in_space + in_time <= tol:
        reason = f"{chosen.choice.rung} is the cheapest rung found whose error is small enough: {in_space:.2g}."
    else:
        known = f"an error of {in_space:.2g}" if np.isfinite(in_space) else "an error that is not known"
        reason = f"{chosen.choice.rung} is the best rung found, with {known}."
    reasons = [reason]
    if chosen.choice.stepping is not None:
        reasons.append(
            f"{chosen.choice.stepping} is the cheapest way through time that was found; what is known best "
            f"{_told(in_time)} in time."
        )
    axes = "xy"
    names = list(pilots.scene.model.bodies)
    refined = []
    for (body, axis), side in search.sides.items():
        where = f"{names[body]}, {axes[axis]}" if len(names) > 1 else axes[axis]
        rate = "unknown" if side.rate is None else f"{side.rate:.1f}"
        refined.append(f"along {where} changed {side.difference:.1g}, rate {rate}")
    if refined:
        reasons.append(f"Errors are told from {finest}, the best that is known: refining it {'; '.join(refined)}.")
    if not search.checked:
        reasons.append(
            "Nothing is promised: steps are known on a coarse mesh only, shorter ones did not end on finer ones."
        )
    if in_space + in_time > tol:
        reasons.append(_missed(search, in_space + in_time))
    threads = search.costs.threads(chosen.choice)
    if pilots.threads != 1:
        reasons.append(f"{'One thread is' if threads == 1 else 'More threads are'} predicted to be the fastest.")
    reasons += told(pilots.scene.model, tol)
    rows = [
        Row(
            str(p.choice),
            search.predicted.get(p.choice),
            p.seconds,
            search.guessed.get(p.choice),
            errors.get(p.choice),
            p.outcome,
        )
        for p in pilots.done
    ]
    index = next(i for i, p in enumerate(pilots.done) if p.choice == chosen.choice)
    return Plan(
        scene=apply(pilots.scene, chosen.choice),
        result=_result(chosen),
        settings=chosen.choice,
        tol=tol,
        scale=dict(zip(pilots.want, scale, strict=True)),
        error=in_space,
        error_in_time=in_time,
        converged=converged,
        reasons=reasons,
        rows=rows,
        chosen=index,
        seconds=pilots.spent,
        predicted_seconds=search.predicted.get(chosen.choice, chosen.seconds),
        threads=threads,
    )


def of_rigid(scene: Scene, pilots: Pilots, pilot: Pilot, bent: float, tol: float) -> Plan:
    """Return the plan of bodies that hardly deform, by `bent`."""
    reason = (
        f"No body deforms to speak of: loads and inertia change what is wanted by about {bent:.1g} of its change, "
        f"so six rigid motions do."
    )
    assert pilot.choice.stepping is not None
    tight = pilots.run(replace(pilot.choice, stepping=pilot.choice.stepping.tighter()))
    in_time = distance(tight.values, pilot.values, scales(pilot.values)) if tight.ok else SHARE * tol
    told_time = f"{pilot.choice.stepping} {_told(in_time)}."
    errors = {p.choice: bent for p in pilots.done if p.ok and p.choice.rung.family == RIGID}
    rows = [Row(str(p.choice), None, p.seconds, None, errors.get(p.choice), p.outcome) for p in pilots.done]
    scale = dict(zip(pilots.want, scales(pilot.values), strict=True))
    chosen = apply(scene, pilot.choice)
    return Plan(
        scene=chosen,
        result=_result(pilot),
        settings=pilot.choice,
        tol=tol,
        scale=scale,
        error=bent,
        error_in_time=in_time,
        converged=bent + in_time <= tol,
        reasons=[reason, told_time],
        rows=rows,
        chosen=rows.index(next(row for row in rows if row.settings == str(pilot.choice))),
        seconds=pilots.spent,
        predicted_seconds=pilot.seconds,
        threads=1,
    )


def _missed(search: Search, error: float) -> str:
    """Say why the estimates do not reach the tolerance, and what they are."""
    pilots, finest = search.pilots, search.best
    slow = [side for side in search.sides.values() if side.rate is not None and side.rate < 0.6]
    failed = [p for p in pilots.done if not p.ok and p.outcome != SLOW and p.choice.rung.family != RIGID]
    finer = [p for p in failed if p.choice.rung.elements > finest.elements]
    if pilots.interrupted:
        why = "the plan was interrupted"
    elif finer:
        why = f"finer meshes do not reach their end ({finer[-1].choice.rung}: {finer[-1].outcome})"
    elif slow:
        why = "differences hardly shrink with the mesh, as at a singular point or where the motion is chaotic"
    else:
        why = "the budget (--budget) or the largest mesh was reached"
    reason = f"The estimates do not reach the tolerance: {why}."
    if not np.isfinite(error):
        return reason
    return f"{reason} {'Promised is' if search.checked else 'What was run suggests'} an error of {error:.2g}."


def _told(in_time: float) -> str:
    """Say what is known of an error in time."""
    return "has an error below rounding" if in_time < _ROUNDING else f"has an error of {in_time:.2g}"


def _result(pilot: Pilot) -> Result:
    assert pilot.result is not None
    return pilot.result
