"""The lowest rung of motion: bodies that do not deform, and how far the bodies of a scene are from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ancf import _core
from ancf.model import Model
from ancf.plan.errors import distance, scales
from ancf.plan.ladder import RIGID, Choice, Family, Rung, Stepping, apply
from ancf.plan.pilots import Pilot, Pilots
from ancf.plan.timing import SHARE
from ancf.result import Result
from ancf.run import Dynamic
from ancf.solve import solve

FloatArray = NDArray[np.float64]

_MOMENTS = 12
"""Times, evenly along the motion, at which the deflection is estimated, and at how many of the largest values of each
load's history."""
_DYNAMIC = 2.0
"""A load that comes suddenly deflects a structure up to twice as far as one that comes slowly."""
_MOST_COORDINATES = 1500
_HELD = 1e-9
RIGID_SHARE = 0.7
"""Part of the tolerance below which the estimated deflection of a rigid body is no matter."""
_SURELY_RIGID = 0.02
"""Part of the tolerance up to which the estimate is believed."""
_TIGHTENED = 10
"""Times that the steps of the rigid motion are shortened until its error in time is small enough."""


def deflection(model: Model, rigid: Result, limits: Sequence[float] | None = None) -> list[float]:
    """Estimate how far each probe is from where a rigid motion has it.

    At the states of the rigid motion the loads and the inertia act on the elastic body as if they stayed.

    Parameters
    ----------
    model : Model
        The elastic bodies, on the mesh of `rigid`.
    rigid : Result
        Their motion as rigid bodies.
    limits : sequence of float, optional
        For each probe, what is too much: nothing more is estimated once one is beyond it.

    Returns
    -------
    list of float
        For each probe of the model the largest change of its quantity, in its unit, twice the static one because loads
        may come suddenly; infinite if it cannot be told.
    """
    unknown = [np.inf] * len(model.probes)
    core = model.assemble("constant")
    if core.coordinates > _MOST_COORDINATES:
        return unknown
    free = core.free().astype(int)
    mass = _dense(core.mass(), core.coordinates)
    worst = np.zeros(len(model.probes))
    for k, t in enumerate(rigid.t.tolist()):
        q = rigid.q[k]
        load = core.external_force(q, t) - mass @ rigid.a[k]
        stiffness = _dense(core.tangent(q, t), core.coordinates)[np.ix_(free, free)]
        # Loads and inertia together do no work in the rigid motions that supports leave: any stiffness holds these.
        loose = _rigid_motions(model, core, q)[free]
        stiffness += np.abs(np.diag(stiffness)).mean() * (loose @ loose.T)
        try:
            change = np.linalg.solve(stiffness, load[free])
        except np.linalg.LinAlgError:
            return unknown
        moved = q.copy()
        moved[free] += _DYNAMIC * (change - loose @ (loose.T @ change))
        states, velocities = np.array([q, moved]), np.array([rigid.v[k], rigid.v[k]])
        for index, probe in enumerate(model.probes):
            value = model.evaluate(probe.body, [probe.at], probe.quantity, states, velocities)[:, 0]
            worst[index] = max(worst[index], float(np.linalg.norm(value[1] - value[0])))
        if limits is not None and (worst > np.asarray(limits)).any():
            break
    return [float(x) if np.isfinite(x) else np.inf for x in worst]


def as_rigid(
    pilots: Pilots, base: tuple[tuple[int, int], ...], family: Family, tol: float
) -> tuple[Pilot | None, list[float]]:
    """Run the scene with rigid bodies, and estimate what deflection changes of the wanted quantities, relative."""
    curved = any(body.shape != "rectangle" for body in pilots.scene.model.bodies.values())
    divisions = tuple((4 * x, 4 * y) for x, y in base) if curved else base
    pilot = _precise(pilots, Rung(RIGID, divisions), tol)
    if pilot is None:
        return None, []
    scale = scales(pilot.values)
    # Deflections need more than the corners.
    finer = Rung(family, tuple((max(x, 2), max(y, 2)) for x, y in divisions))
    again = apply(pilots.scene, replace(pilot.choice, rung=replace(finer, family=RIGID)))
    assert isinstance(again.run, Dynamic)
    moments = _moments(again.model, again.run.until)
    run = again.run.model_copy(update={"every": None, "outputs": moments})
    result = solve(again.model, run, threads=1, throw=False)
    elastic = apply(pilots.scene, Choice(finer)).model
    names = [probe.name for probe in elastic.probes]
    limits = [RIGID_SHARE * tol * dict(zip(pilots.want, scale, strict=True)).get(name, np.inf) for name in names]
    bent = dict(zip(names, deflection(elastic, result, limits), strict=True))
    errors = [bent[name] / size for name, size in zip(pilots.want, scale, strict=True)]
    # A deflection has no velocity: only a motion tells how fast the bodies oscillate.
    swift = any(probe.quantity == "velocity" for probe in elastic.probes if probe.name in pilots.want)
    if (0.0 if swift else _SURELY_RIGID * tol) <= max(errors) <= RIGID_SHARE * tol:
        # Loads that change as the body oscillates add up: see what it does. No fixed steps, which a pulse may escape.
        moved = pilots.run(Choice(finer, Stepping("esdirk", rtol=1e-2 * tol)), pilots.left / 4)
        errors.append(distance(moved.values, pilot.values, scale) if moved.ok else np.inf)
    return pilot, errors


def _precise(pilots: Pilots, rung: Rung, tol: float) -> Pilot | None:
    """Run rigid bodies with ever shorter steps until they change little; None if they cannot be run or do not move."""
    stepping = Stepping("rigid", rtol=min(1e-3, 1e-2 * tol))
    pilot = pilots.run(Choice(rung, stepping), pilots.left / 4)
    for _ in range(_TIGHTENED):
        if not pilot.ok or min(scales(pilot.values)) == 0.0:
            return None
        stepping = stepping.tighter()
        tight = pilots.run(Choice(rung, stepping), pilots.left / 4)
        if not tight.ok or distance(tight.values, pilot.values, scales(tight.values)) <= SHARE * tol:
            break
        pilot = tight
    return pilot


def _moments(model: Model, until: float) -> list[float]:
    """Return times along a motion, and those at which the histories of loads are the largest: pulses may be short."""
    times = [np.linspace(0.0, until, _MOMENTS)]
    for load in model.loads:
        if load.history is not None and not isinstance(load.history, str):
            t, factor = np.array(load.history).T
            inside = (t > 0.0) & (t < until)
            times.append(t[inside][np.argsort(-np.abs(factor[inside]))[:_MOMENTS]])
    return [float(t) for t in np.unique(np.concatenate(times))]


def _dense(entries: tuple[NDArray[np.uint64], NDArray[np.uint64], FloatArray], n: int) -> FloatArray:
    rows, columns, values = entries
    full = np.zeros((n, n))
    np.add.at(full, (rows.astype(int), columns.astype(int)), values)
    return full


def _rigid_motions(model: Model, core: _core.Model, q: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the rigid motions that supports leave in the state q, shape (n, motions)."""
    vectors = q.reshape(-1, 3)
    motions = []
    for name in model.bodies:
        indices = core.vectors(name).astype(int)
        centre = vectors[indices[:, 0] // 3].mean(axis=0)
        for axis in np.eye(3):
            shift, turn = np.zeros_like(vectors), np.zeros_like(vectors)
            shift[indices[:, 0] // 3] = axis
            own = indices.ravel() // 3
            arms = vectors[own].copy()
            arms[:: indices.shape[1]] -= centre
            turn[own] = np.cross(axis, arms)
            motions += [shift.ravel(), turn.ravel()]
    basis = np.linalg.qr(np.array(motions).T)[0]
    fixed = np.setdiff1d(np.arange(len(q)), core.free().astype(int))
    if len(fixed):
        _, singular, right = np.linalg.svd(basis[fixed])
        rank = int((singular > _HELD).sum())
        basis = basis @ right[rank:].T
    return basis
