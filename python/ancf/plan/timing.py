"""Errors in time: the cheapest methods and steps that keep them small, found on a coarse mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ancf.plan.asked import still
from ancf.plan.errors import distance, scales
from ancf.plan.ladder import LOOSEST, Choice, Rung, Stepping
from ancf.plan.pilots import SLOW, Pilot, Pilots
from ancf.run import Dynamic, Method

FIXED: tuple[Method, ...] = ("esdirk", "hht", "generalized_alpha", "tr_bdf2", "energy_momentum")
CONTROLLED: tuple[Method, ...] = ("esdirk", "hht", "tr_bdf2", "verlet", "rk")

SHARE = 0.25
"""Part of the tolerance that the error in time may take."""
_REFERENCE = 0.1
"""Error of the reference in time, relative to that."""
_FINER = 8.0
"""Times that its error control is tightened until it does not change."""
_TIGHTEST = 1e-11
_MESHES = 0.5
"""Part of the time left that is for meshes."""
_ROOM = 30.0
"""Runs of the coarse mesh that must fit into the time left, if no stepping is good enough."""
_FEWEST_STEPS = 12
_ROUNDS = 11
_ORDER = 3
_KEPT = 2
"""Implicit and explicit steppings that are taken to finer meshes."""
_LOOSE = 64.0
"""First tolerance of error control relative to that of the plan: steps that must be stable are often precise."""
_PATIENCE = 1.2
"""Times the cheapest adequate pilot after which another is given up."""


@dataclass(frozen=True)
class Timing:
    """A stepping that is good enough on the coarse mesh.

    Parameters
    ----------
    stepping : Stepping
        Method and step.
    error : float
        Against the reference in time, relative.
    pilot : Pilot
        Its run.
    """

    stepping: Stepping
    error: float
    pilot: Pilot


def reference(pilots: Pilots, rung: Rung, tol: float) -> Pilot:
    """Run a rung with a small error in time.

    Parameters
    ----------
    pilots : Pilots
        Runs and remembers.
    rung : Rung
        A coarse one.
    tol : float
        Of the plan.

    Returns
    -------
    Pilot
        The most precise one that reached its end; not ok if none did.
    """
    size = _size(pilots)
    first = pilots.run(Choice(rung, Stepping("esdirk", rtol=min(LOOSEST, tol))), pilots.left / 6)
    if not first.ok:
        first = pilots.run(Choice(rung, Stepping("verlet", rtol=min(LOOSEST, tol))), pilots.left / 6)
    if first.result is None or still(first.result):
        return first
    scale = scales(first.values)
    # Error control bounds what steps add to positions; velocities and strains need more care, so that the cheapest
    # reference is refined until it does not change.
    rtol = min(LOOSEST, SHARE * _REFERENCE * tol * _relative(pilots, scale, size))
    best, method = first, first.choice.stepping
    assert method is not None
    assert method.rtol is not None
    before = method.rtol
    while pilots.left > 0:
        rtol = max(rtol, _TIGHTEST)
        finer = pilots.run(Choice(rung, replace(method, rtol=rtol)), pilots.left / 4)
        if not finer.ok:
            return best
        # Errors fall at least with the root of the tolerance.
        left = distance(finer.values, best.values, scale) * np.sqrt(rtol / before)
        best, before = finer, rtol
        if left <= SHARE * tol / np.sqrt(_FINER) or rtol <= _TIGHTEST:
            break
        rtol /= _FINER
    return best


def steppings(pilots: Pilots, rung: Rung, precise: Pilot, tol: float) -> list[Timing]:
    """Find for each method the longest steps, or loosest tolerance, whose error in time is small enough.

    Parameters
    ----------
    pilots : Pilots
        Runs and remembers.
    rung : Rung
        A coarse one.
    precise : Pilot
        This rung without error in time; what is much slower than it is given up.
    tol : float
        Of the plan.

    Returns
    -------
    list of Timing
        Of each method that has one at no more than some times the cost of the cheapest, cheapest first. If none has,
        the best of those that leave time for meshes, as where a motion is chaotic.
    """
    exact = precise.values
    scale = scales(exact)
    found: list[Timing] = []
    rough: list[Timing] = []
    least = _MESHES * pilots.left if np.isfinite(pilots.left) else 0.0
    unstable = False
    for ladder in (*_fixed(pilots), *_controlled(pilots, tol, scale)):
        index, last = 0, None
        while index < len(ladder):
            stepping = ladder[index]
            if stepping.explicit and unstable:
                break
            index += 1
            cheapest = min((timing.pilot.seconds for timing in found), default=precise.seconds)
            # An explicit method may be cheaper on a fine mesh, where factorisations cost more than forces.
            patience = 4.0 if stepping.explicit else _PATIENCE
            limit = patience * cheapest + 0.02
            if last is not None and last[1] * last[0].lengthening(stepping) > limit:
                break
            pilot = pilots.run(Choice(rung, stepping), min(limit, pilots.left / 4))
            last = stepping, pilot.seconds
            # What is too slow with the loosest tolerance is so for stability, which is about the same for all.
            unstable = unstable or (stepping.explicit and index == 1 and pilot.outcome == SLOW)
            if pilot.ok:
                error = distance(pilot.values, exact, scale)
                if error <= SHARE * tol:
                    found.append(Timing(stepping, error, pilot))
                    break
                rough.append(Timing(stepping, error, pilot))
                # Those that are too long even if errors shrink fast, with the third power of the step or with the
                # tolerance, are left out.
                ratio = min(error, 1.0) / (SHARE * tol)
                index += int(np.log2(ratio) / _ORDER if stepping.step is not None else np.log2(ratio) / 2)
            if pilots.left <= least or pilot.seconds > limit:
                break
        if pilots.left <= least:
            break
    if not found:
        assert precise.choice.stepping is not None
        rough.append(Timing(precise.choice.stepping, SHARE * tol, precise))
        short = [timing for timing in rough if _ROOM * timing.pilot.seconds <= pilots.left]
        return [min(short, key=lambda t: t.error) if short else min(rough, key=lambda t: t.pilot.seconds)]
    found.sort(key=lambda timing: timing.pilot.seconds)
    found = [t for explicit in (False, True) for t in [t for t in found if t.stepping.explicit is explicit][:_KEPT]]
    implicit = min((t for t in found if not t.stepping.explicit), key=lambda t: t.pilot.seconds, default=None)
    if implicit is not None:
        reused = replace(implicit.stepping, reuse=True)
        # On a coarse mesh factorisations cost little: whether keeping them pays shows on finer ones.
        pilot = pilots.run(Choice(rung, reused), _PATIENCE * implicit.pilot.seconds + 0.02)
        if pilot.ok:
            error = distance(pilot.values, exact, scale)
            if error <= SHARE * tol:
                found.append(Timing(reused, error, pilot))
    found.sort(key=lambda timing: timing.pilot.seconds)
    return found


def _fixed(pilots: Pilots) -> Iterator[list[Stepping]]:
    run = pilots.scene.run
    assert isinstance(run, Dynamic)
    for method in FIXED:
        yield [Stepping(method, step=run.until / (_FEWEST_STEPS * 2**k)) for k in range(_ROUNDS)]


def _controlled(pilots: Pilots, tol: float, scale: list[float]) -> Iterator[list[Stepping]]:
    loose = min(LOOSEST, _LOOSE * tol * _relative(pilots, scale, _size(pilots)))
    for method in CONTROLLED:
        yield [Stepping(method, rtol=max(loose / 4**k, _TIGHTEST)) for k in range(_ROUNDS)]


def _size(pilots: Pilots) -> float:
    """Return the size of the model at rest, m."""
    q = pilots.scene.model.nodal_coordinates().reshape(-1, 3)
    return float(np.ptp(q, axis=0).max())


def _relative(pilots: Pilots, scale: list[float], size: float) -> float:
    """Return the smallest scale of a wanted position, relative to the size of the model; 1 if none is wanted."""
    kinds = {probe.name: probe.quantity for probe in pilots.scene.model.probes}
    lengths = [s for name, s in zip(pilots.want, scale, strict=True) if kinds[name] in ("position", "displacement")]
    return min([*(length / size for length in lengths), 1.0])
