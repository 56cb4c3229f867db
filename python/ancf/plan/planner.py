"""Planning a scene: from what is wanted to the settings of the run."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ancf.errors import InputError, Mistake, Mistakes, one_of, show
from ancf.model import Model
from ancf.plan.ascent import Ascent
from ancf.plan.cost import Costs, as_written, calibrated
from ancf.plan.descent import Descent
from ancf.plan.errors import Values, distance, scales
from ancf.plan.ladder import RIGID, Choice, Family, Rung, Stepping, apply, coarsest, families
from ancf.plan.pilots import Pilot, Pilots
from ancf.plan.report import Plan, Row
from ancf.plan.rigid import deflection
from ancf.plan.search import Search
from ancf.plan.shear import told
from ancf.plan.symmetry import doubled, halved
from ancf.plan.timing import SHARE, Timing, reference, steppings
from ancf.result import Result
from ancf.run import Dynamic, Static
from ancf.scene import Scene, load_scene
from ancf.solve import solve

LEAST, MOST, PROPORTION = 20.0, 300.0, 9.0
"""Seconds that a plan may take if nothing is said: at least, at most, and relative to the scene as written.

To check that by hand takes it once more, with twice the elements along both sides and half the steps: 9 times in all.
"""
_RIGID_SHARE = 0.7
"""Part of the tolerance below which the estimated deflection of a rigid body is no matter."""
_SURELY_RIGID, _STEPS = 0.02, 60
"""Part of the tolerance up to which the estimate is believed, and the steps of the motion that checks others."""
_SYMMETRIC = 0.2
"""Part of the tolerance that the whole of a symmetric scene may be off its half."""
_CHECKS = 3
_ROUNDING = 1e-13
"""Relative differences below it are none."""


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
        On Ctrl-C.
    """
    scene = _scene(scene, run)
    names = _wanted(scene, want)
    _check(scene, tol, budget)
    costs = calibrated(threads=threads)
    written = as_written(scene, costs)
    if budget is None:
        budget = MOST if written is None else min(max(PROPORTION * written, LEAST), MOST)
    pilots = Pilots(scene, names, budget, threads, costs)
    found = _planned(scene, pilots, costs, tol, max(written or budget, LEAST))
    return replace(found, budget=budget, seconds_as_written=written)


def _planned(scene: Scene, pilots: Pilots, costs: Costs, tol: float, worth: float) -> Plan:
    """Plan it as rigid bodies, as the half of a symmetric scene, or as a whole."""
    allowed = families(scene.model)
    if isinstance(scene.run, Dynamic):
        rigid, bent = _rigid(pilots, coarsest(scene.model), allowed[0], tol)
        if rigid is not None and max(bent) <= _RIGID_SHARE * tol:
            return _as_rigid(scene, pilots, rigid, max(bent), tol)
    part, mirrors = halved(scene)
    if mirrors:
        found = _flexible(Pilots(part, pilots.want, pilots.left / 2, pilots.threads, costs), allowed, costs, tol, worth)
        off = _asymmetry(pilots, found, mirrors)
        sides = " and ".join("xy"[axis] for axis in mirrors)
        reason = f"The scene is symmetric across the middle of {sides}: the low half is enough"
        if off is None:
            reasons = [*found.reasons, f"{reason} if it moves so; the budget did not suffice to run the whole."]
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
    values = [found.result.probes[name].value for name in pilots.want]
    return distance(whole.values, values, scales(values))


def _flexible(pilots: Pilots, allowed: tuple[Family, ...], costs: Costs, tol: float, worth: float) -> Plan:
    """Plan a scene whose bodies deform; look for nothing cheaper after `worth` seconds."""
    scene = pilots.scene
    base = coarsest(scene.model)
    timings = _timings(pilots, allowed, base, tol) if isinstance(scene.run, Dynamic) else []
    search = Search(pilots, costs, allowed, base, tol, timings)
    if not Ascent(search).up(_to_refine(search)):
        raise InputError(Mistake(("scene",), f"no pilot reached its end within the budget: {_last_words(pilots)}"))
    scale = _scales(search.exact, pilots.want)
    descent = Descent(search, worth)
    descent.down()
    descent.lengthen()
    descent.settle()
    chosen = search.cheapest(search.observed()) or _of_rung(pilots, search.best)
    in_space = search.observed()[chosen.choice]
    chosen, in_time = _check_time(search, chosen, scale, search.tol - in_space)
    return _report(search, chosen, in_space, in_time, scale)


def _of_rung(pilots: Pilots, rung: Rung) -> Pilot:
    return min((p for p in pilots.done if p.ok and p.choice.rung == rung), key=lambda pilot: pilot.seconds)


def _scene(given: Scene | Model | str | os.PathLike[str], run: Static | Dynamic | None) -> Scene:
    if isinstance(given, Model):
        if run is None:
            raise InputError(Mistake(("run",), "is missing: Static(...) or Dynamic(...)"))
        run.check(given)
        return Scene("", given, run)
    if run is not None:
        raise InputError(Mistake(("run",), "is for models; a scene has its own", show(type(run).__name__)))
    return given if isinstance(given, Scene) else load_scene(given)


def _wanted(scene: Scene, want: str | Sequence[str] | None) -> list[str]:
    known = [probe.name for probe in scene.model.probes]
    if not known:
        raise InputError(Mistake(("want",), "the scene has no probes: nothing can be wanted of it"))
    names = known if want is None else [want] if isinstance(want, str) else list(want)
    mistakes = Mistakes()
    for name in names or [""]:
        if name not in known:
            mistakes.add(("want",), one_of(known, name), name)
    mistakes.check()
    return names


def _check(scene: Scene, tol: float, budget: float | None) -> None:
    mistakes = Mistakes()
    limits = [("tol", tol, 1e-6, 1.0)]
    if budget is not None:
        limits.append(("budget", budget, 0.0, np.inf))
    for name, value, low, high in limits:
        number = isinstance(value, (int, float)) and not isinstance(value, bool) and np.isfinite(value)
        if not number or not low <= value < high or value <= 0:
            allowed = "a number from 1e-6 to below 1" if name == "tol" else "a number of seconds greater than 0"
            mistakes.add((name,), f"allowed is {allowed}", value)
    if not isinstance(scene.run, (Static, Dynamic)):
        mistakes.add(("run", "kind"), "statics and motion can be planned", scene.run.kind)
    if isinstance(scene.run, Static) and scene.run.path == "arc":
        mistakes.add(
            ("run", "path"), 'can be planned only for "load": steps along an arc differ from mesh to mesh', "arc"
        )
    mistakes.check()


def _scales(values: Values, names: list[str]) -> list[float]:
    scale = scales(values)
    mistakes = Mistakes()
    for name, size in zip(names, scale, strict=True):
        if size == 0.0:
            mistakes.add(("want",), "does not change, so that no error is relative to it", name)
    mistakes.check()
    return scale


def _rigid(
    pilots: Pilots, base: tuple[tuple[int, int], ...], family: Family, tol: float
) -> tuple[Pilot | None, list[float]]:
    """Run the scene with rigid bodies, and estimate what deflection changes of the wanted quantities, relative."""
    curved = any(body.shape != "rectangle" for body in pilots.scene.model.bodies.values())
    divisions = tuple((4 * x, 4 * y) for x, y in base) if curved else base
    rtol = min(1e-3, 1e-2 * tol)
    pilot = pilots.run(Choice(Rung(RIGID, divisions), Stepping("rigid", rtol=rtol)), pilots.left / 4)
    if not pilot.ok or pilot.result is None:
        return None, []
    scale = scales(pilot.values)
    if min(scale) == 0.0:
        return None, []
    # Deflections need more than the corners.
    finer = Rung(family, tuple((max(x, 2), max(y, 2)) for x, y in divisions))
    assert isinstance(pilots.scene.run, Dynamic)
    again = apply(pilots.scene, replace(pilot.choice, rung=replace(finer, family=RIGID)))
    assert isinstance(again.run, Dynamic)
    result = solve(again.model, again.run, threads=1, throw=False)
    elastic = apply(pilots.scene, Choice(finer)).model
    names = [probe.name for probe in elastic.probes]
    limits = [_RIGID_SHARE * tol * dict(zip(pilots.want, scale, strict=True)).get(name, np.inf) for name in names]
    bent = dict(zip(names, deflection(elastic, result, limits), strict=True))
    errors = [bent[name] / size for name, size in zip(pilots.want, scale, strict=True)]
    if _SURELY_RIGID * tol < max(errors) <= _RIGID_SHARE * tol:
        # Loads that change as the body oscillates add up: see what it does.
        until = pilots.scene.run.until
        moved = pilots.run(Choice(finer, Stepping("esdirk", step=until / _STEPS)), pilots.left / 4)
        errors.append(distance(moved.values, pilot.values, scale) if moved.ok else np.inf)
    return pilot, errors


def _as_rigid(scene: Scene, pilots: Pilots, pilot: Pilot, bent: float, tol: float) -> Plan:
    reason = (
        f"No body deforms to speak of: loads and inertia change what is wanted by about {bent:.1g} of its change, "
        f"so six rigid motions do."
    )
    assert pilot.choice.stepping is not None
    tight = pilots.run(replace(pilot.choice, stepping=pilot.choice.stepping.tighter()))
    in_time = distance(tight.values, pilot.values, scales(pilot.values)) if tight.ok else SHARE * tol
    told_time = f"{pilot.choice.stepping} {_told(in_time)}."
    rows = [Row(str(p.choice), None, p.seconds, None, bent if p.ok else None, p.outcome) for p in pilots.done]
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


def _timings(
    pilots: Pilots, allowed: tuple[Family, ...], base: tuple[tuple[int, int], ...], tol: float
) -> list[Timing]:
    """Find steppings on a coarse mesh, of the first family whose pilots reach their end."""
    for family in allowed:
        rung = Rung(family, tuple((2 * x, 2 * y) for x, y in base))
        exact = reference(pilots, rung, tol)
        if exact.ok:
            _scales(exact.values, pilots.want)
            found = steppings(pilots, rung, exact.values, tol)
            if not found:
                assert exact.choice.stepping is not None
                found = [Timing(exact.choice.stepping, SHARE * tol, exact)]
            return found
    raise InputError(Mistake(("scene",), f"no pilot reached its end within the budget: {_last_words(pilots)}"))


def _to_refine(search: Search) -> list[Family]:
    """Return of each element the family that changes least when a coarse mesh is refined and agrees with others.

    Agreement matters because what locks hardly changes either.
    """
    coarse, fine = (_of_families(search, factor) for factor in (1, 2))
    if not fine:
        return []
    scale = [max(sizes) for sizes in zip(*(scales(values) for values in fine.values()), strict=True)]
    doubts = {family: _doubt(family, coarse, fine, scale) for family in fine}
    elements = dict.fromkeys(family.element for family in fine)
    return [
        min((family for family in fine if family.element == element), key=doubts.__getitem__) for element in elements
    ]


def _of_families(search: Search, factor: int) -> dict[Family, Values]:
    """Return the wanted quantities of all families on one mesh that reach their end in time."""
    found: dict[Family, Values] = {}
    cheapest = search.pilots.left / 8
    rungs = [Rung(family, tuple((factor * x, factor * y) for x, y in search.base)) for family in search.families]
    for rung in rungs:
        pilot = search.run(rung, 3 * cheapest + 0.02)
        if pilot.ok:
            _scales(pilot.values, search.pilots.want)
            found[rung.family] = pilot.values
            cheapest = min(cheapest, pilot.seconds)
    return found


def _doubt(family: Family, coarse: dict[Family, Values], fine: dict[Family, Values], scale: list[float]) -> float:
    """Return how far a family is from its coarse mesh and, together, from the nearest other family, relative."""
    change = distance(coarse[family], fine[family], scale) if family in coarse else 1.0
    others = [distance(fine[family], values, scale) for other, values in fine.items() if other != family]
    return change + min(others, default=0.0)


def _check_time(search: Search, chosen: Pilot, scale: Sequence[float], allowed: float) -> tuple[Pilot, float]:
    """Repeat the choice with tighter steps until they no longer matter; return it with its error in time, relative."""
    stepping = chosen.choice.stepping
    # Where it cannot be checked, what was found on a coarse mesh must do.
    error = max((t.error for t in search.timings if t.stepping == stepping), default=SHARE * search.tol)
    for _ in range(_CHECKS):
        stepping = chosen.choice.stepping
        if stepping is None:
            return chosen, 0.0
        tight = search.pilots.run(replace(chosen.choice, stepping=stepping.tighter()))
        if not tight.ok:
            break
        change = distance(tight.values, chosen.values, scale)
        # The limit of stability may set the steps of both: then tighter control tells nothing.
        error = max(change, error) if change < _ROUNDING else change
        if error <= max(allowed, SHARE * search.tol):
            break
        chosen = tight
    return chosen, error


def _report(
    search: Search,
    chosen: Pilot,
    in_space: float,
    in_time: float,
    scale: Sequence[float],
) -> Plan:
    pilots, tol, finest = search.pilots, search.tol, search.best
    errors = search.observed()
    converged = in_space + in_time <= tol
    reasons = [f"{chosen.choice.rung} is the cheapest rung found whose error is small enough: {in_space:.2g}."]
    if chosen.choice.rung == finest:
        reasons[0] = f"{finest} is the finest rung that was run; no cheaper one is good enough."
    if chosen.choice.stepping is not None:
        reasons.append(
            f"{chosen.choice.stepping} is predicted to be the cheapest way through time; it {_told(in_time)}."
        )
    axes = "xy"
    names = list(pilots.scene.model.bodies)
    for (body, axis), side in search.sides.items():
        where = f"{names[body]}, {axes[axis]}" if len(names) > 1 else axes[axis]
        rate = "unknown" if side.rate is None else f"{side.rate:.1f}"
        reasons.append(f"Refining {finest} along {where} changed {side.difference:.1g}, rate {rate}.")
    if not converged:
        slow = [side for side in search.sides.values() if side.rate is not None and side.rate < 0.6]
        why = (
            "differences hardly shrink as the mesh is refined, as at a singular point or where the motion is chaotic"
            if slow
            else "the budget (--budget) or the largest mesh was reached"
        )
        reasons.append(
            f"The estimates do not reach the tolerance: {why}. Promised is an error of {in_space + in_time:.2g}."
        )
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


def _told(in_time: float) -> str:
    """Say what is known of an error in time."""
    return "has an error below rounding" if in_time < _ROUNDING else f"has an error of {in_time:.2g}"


def _result(pilot: Pilot) -> Result:
    assert pilot.result is not None
    return pilot.result


def _last_words(pilots: Pilots) -> str:
    return pilots.done[-1].outcome if pilots.done else "none was made"
