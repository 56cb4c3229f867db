"""Planning a scene: from what is wanted to the settings of the run."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ancf.errors import InputError, Interrupted, Mistake
from ancf.model import Model
from ancf.plan.answer import of_rigid, of_search
from ancf.plan.ascent import Ascent
from ancf.plan.asked import changes, check, scene_of, wanted
from ancf.plan.cost import Costs, as_written, calibrated
from ancf.plan.descent import Descent
from ancf.plan.errors import distance, scales
from ancf.plan.families import to_refine
from ancf.plan.ladder import Family, Rung, coarsest, families
from ancf.plan.pilots import Pilot, Pilots
from ancf.plan.report import Plan
from ancf.plan.rigid import RIGID_SHARE, as_rigid
from ancf.plan.search import Search
from ancf.plan.symmetry import below, doubled, halved
from ancf.plan.timing import Timing, reference, steppings
from ancf.run import Dynamic, Static
from ancf.scene import Scene

LEAST, MOST, PROPORTION = 20.0, 300.0, 9.0
"""Seconds that a plan may take if nothing is said: at least, at most, and relative to the scene as written.

To check that by hand takes it once more, with twice the elements along both sides and half the steps: 9 times in all.
"""
_TOLD = 0.5
"""Seconds of measuring costs above which they are told."""
_SYMMETRIC = 0.2
"""Part of the tolerance that the whole of a symmetric scene may be off its half."""
_CHECKS = 3
"""Rungs on which steps are checked before one of them is chosen."""


def plan(
    scene: Scene | Model | str | os.PathLike[str],
    *,
    run: Static | Dynamic | None = None,
    want: str | Sequence[str] | None = None,
    tol: float = 1e-2,
    budget: float | None = None,
    threads: int | None = None,
) -> Plan:
    """Find the cheapest settings of a scene for which the error in what is wanted stays below a tolerance.

    Elements, meshes, integrators and steps of the scene itself do not matter: they are chosen.

    Parameters
    ----------
    scene : Scene, Model, str or path
        What to plan; a file is read.
    run : Static or Dynamic, optional
        How to run a `Model`; in motion its duration and outputs matter, its steps do not.
    want : str or sequence of str, optional
        Names of the probes that matter; all if left out.
    tol : float, default 1e-2
        Largest error that is allowed of each of them, over all recorded states, relative to the largest change of the
        quantity from the first state. From 1e-6 to below 1.
    budget : float, optional
        Seconds after which pilots end; the plan then says what it can promise. If left out, 9 times what the scene
        as it is written should take, but from 20 to 300. On one thread these are seconds of the processor.
    threads : int, optional
        That pilots may use, where more than one are predicted to help; all if left out.

    Returns
    -------
    Plan
        The chosen scene, why it was chosen, and what was tried.

    Raises
    ------
    InputError
        If there is no such probe, it does not change, or the scene is none that can be planned.
    Interrupted
        On Ctrl-C; `Interrupted.result` is the `Plan` that follows from the pilots so far.
    KeyboardInterrupt
        On Ctrl-C before anything follows from them.
    """
    scene = scene_of(scene, run)
    names = wanted(scene, want)
    check(scene, tol, budget)
    start = time.perf_counter()
    costs = calibrated(threads=threads)
    measured = time.perf_counter() - start
    written = as_written(scene, costs)
    if budget is None:
        budget = MOST if written is None else min(max(PROPORTION * written, LEAST), MOST)
    pilots = Pilots(scene, names, budget, threads, costs)
    found = _planned(scene, pilots, costs, tol, max(written or budget, LEAST))
    if measured > _TOLD:
        told = f"Costs on this machine were measured first, in {measured:.2g} s, and are kept for later plans."
        found = replace(found, reasons=[*found.reasons, told])
    found = replace(found, budget=budget, seconds_as_written=written)
    if pilots.interrupted:
        raise Interrupted("the plan was interrupted", found)
    return found


def _planned(scene: Scene, pilots: Pilots, costs: Costs, tol: float, worth: float) -> Plan:
    """Plan it as rigid bodies, as the half of a symmetric scene, or as a whole."""
    allowed = families(scene.model)
    if isinstance(scene.run, Dynamic):
        rigid, bent = as_rigid(pilots, coarsest(scene.model), allowed[0], tol)
        if rigid is not None and max(bent) <= RIGID_SHARE * tol:
            return of_rigid(scene, pilots, rigid, max(bent), tol)
    part, mirrors = halved(scene)
    if mirrors:
        of_part = Pilots(part, pilots.want, pilots.left / 2, pilots.threads, costs)
        found = _flexible(of_part, allowed, costs, tol, worth)
        pilots.interrupted = of_part.interrupted
        off = _asymmetry(pilots, found, mirrors)
        sides = " and ".join("xy"[axis] for axis in mirrors)
        reason = f"The scene is symmetric across the middle of {sides}: the low half is enough"
        if off is None:
            reasons = [*found.reasons, f"{reason} if it moves so; there was no time to run the whole."]
            return replace(found, reasons=reasons, converged=False, seconds=pilots.spent)
        if off <= _SYMMETRIC * tol:
            return replace(found, reasons=[*found.reasons, f"{reason}, to {off:.1g}."], seconds=pilots.spent)
    return _flexible(pilots, allowed, costs, tol, worth)


def _asymmetry(pilots: Pilots, found: Plan, mirrors: list[int]) -> float | None:
    """Return how far the whole is from its part with the same elements, relative: it may buckle to one side.

    None if there is no time to tell.
    """
    choice = found.settings
    rung = replace(choice.rung, divisions=doubled(choice.rung.divisions, mirrors))
    whole = pilots.run(replace(choice, rung=rung))
    if not whole.ok:
        return None if pilots.left <= 0.0 else np.inf
    assert whole.result is not None
    probes = {probe.name: probe for probe in pilots.scene.model.probes}
    low = []
    for name in pilots.want:
        # Curvatures jump between elements: on a mirror those of the low side are meant.
        place = below(pilots.scene.model, probes[name], mirrors)
        low.append(whole.result.evaluate(probes[name].body, [place], probes[name].quantity)[:, 0])
    values = [found.result.probes[name].value for name in pilots.want]
    return distance(low, values, scales(values))


def _flexible(pilots: Pilots, allowed: tuple[Family, ...], costs: Costs, tol: float, worth: float) -> Plan:
    """Plan a scene whose bodies deform; look for nothing cheaper after `worth` seconds."""
    scene = pilots.scene
    base = coarsest(scene.model)
    timings = _timings(pilots, allowed, base, tol) if isinstance(scene.run, Dynamic) else []
    search = Search(pilots, costs, allowed, base, tol, timings)
    try:
        if not Ascent(search).up(to_refine(search)):
            raise _none(pilots)
        descent = Descent(search, worth)
        descent.down()
        _choose(search)
        descent.down()
        descent.settle()
        return _answer(search)
    except KeyboardInterrupt:
        if not any(climb.rung for climb in search.climbs):
            raise
        pilots.interrupted = True
        return _answer(search)


def _choose(search: Search) -> Pilot:
    """Return the cheapest pilot that is good enough, else the best one, once the error in time is known on its rung."""
    checked: set[Rung] = set()
    while True:
        errors = search.observed()
        chosen = search.cheapest(errors) or search.pilots.known(
            min(errors, key=lambda choice: (errors[choice], -choice.rung.elements))
        )
        assert chosen is not None
        if chosen.choice.rung in checked or len(checked) == _CHECKS:
            return chosen
        checked.add(chosen.choice.rung)
        search.correct(chosen.choice.rung)


def _answer(search: Search) -> Plan:
    """Choose from what a search has found and tell."""
    scale = changes(search.exact, search.pilots.want)
    chosen = _choose(search)
    return of_search(search, chosen, search.observed()[chosen.choice], search.in_time, scale)


def _timings(
    pilots: Pilots, allowed: tuple[Family, ...], base: tuple[tuple[int, int], ...], tol: float
) -> list[Timing]:
    """Find steppings on a coarse mesh, of the first family whose pilots reach their end."""
    for family in allowed:
        rung = Rung(family, tuple((2 * x, 2 * y) for x, y in base))
        exact = reference(pilots, rung, tol)
        if exact.ok:
            changes(exact.values, pilots.want, exact.result)
            return steppings(pilots, rung, exact, tol)
    raise _none(pilots)


def _none(pilots: Pilots) -> InputError:
    """Return why nothing can be said at all."""
    outcome = pilots.done[-1].outcome if pilots.done else "none was made"
    text = f"no pilot reached its end within the budget, {outcome}; a larger budget may help"
    return InputError(Mistake(("scene",), text))
