"""Finding natural frequencies and mode shapes."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from ancf import _core
from ancf.errors import Interrupted, SolveError, from_core
from ancf.inputs import numbers
from ancf.modal import ModalResult
from ancf.model import Model
from ancf.progress import Progress, meter
from ancf.result import Result, Status
from ancf.run import Modes, Static
from ancf.solve import check_threads, solve


def modes(
    model: Model,
    *,
    count: int = 10,
    load_factor: float = 0.0,
    q: ArrayLike | None = None,
    threads: int | None = None,
    progress: Progress = None,
    throw: bool = True,
) -> ModalResult:
    """Find the smallest natural frequencies of a model and their shapes.

    Parameters
    ----------
    model : Model
        What oscillates.
    count, load_factor : optional
        As in `Modes`.
    q : array_like, shape (n,), optional
        The state about which it oscillates, as one of `Result.q`; the equilibrium at `load_factor` if left out. Where
        it is no equilibrium the modes are those of its tangent.
    threads : int, optional
        How many; all if left out. The result does not depend on it.
    progress : bool or callable, optional
        True shows a bar on standard error if that is a terminal; a callable is called with the number of modes found,
        and before, where statics comes first, with the load factor.
    throw : bool, default True
        Raise an error if the run fails. Otherwise see `ModalResult.status`.

    Returns
    -------
    ModalResult
        Frequencies in Hz, rigid modes included, and shapes.

    Raises
    ------
    InputError
        If an argument is wrong, a body has no mass, or there are fewer modes.
    SolveError
        If the run fails.
    Interrupted
        On Ctrl-C; `Interrupted.result` holds what it had.

    Examples
    --------
    >>> from ancf import Material, Model, Rectangle, Support
    >>> steel = Material(E=2.1e11, nu=0.3, density=7800.0)
    >>> strip = Rectangle(size=(1.0, 0.1), divisions=(8, 1), thickness=0.01, material=steel)
    >>> found = modes(Model(bodies={"strip": strip}, supports=[Support(at="edge:x0", clamp=True)]), count=2)
    >>> found.frequency.round(1)
    array([ 8.5, 53.2])
    """
    return find_modes(
        model, Modes(count=count, load_factor=load_factor), q=q, threads=threads, progress=progress, throw=throw
    )


def find_modes(
    model: Model,
    run: Modes,
    *,
    q: ArrayLike | None = None,
    threads: int | None = None,
    progress: Progress = None,
    throw: bool = True,
) -> ModalResult:
    """Find modes; what `modes` and scenes have in common."""
    check_threads(threads)
    run.check(model)
    core = model.assemble(run.history)
    rest = model.nodal_coordinates()
    state = rest if q is None else numbers("q", q, len(rest))
    before = None
    if q is None and run.load_factor != 0:
        before = _load(model, run, threads, progress, throw)
        if before.status == "failed":
            return _without_modes(run, before)
        state = before.q[-1]
    with meter(progress, run.count, run.unit) as call, from_core():
        outcome, eigenvalue, shapes = _core.modes(
            core, count=run.count, q=state, load_factor=run.load_factor, threads=threads, progress=call
        )
        if call and outcome.exception is None:
            call(outcome.reached)
    counts, seconds = outcome.counts, outcome.seconds
    if before is not None:
        counts = {name: number + before.counts[name] for name, number in counts.items()}
        counts |= {name: before.counts[name] for name in ("elements", "dofs")}
        seconds = {name: number + before.seconds[name] for name, number in seconds.items()}
    result = ModalResult(
        model=model,
        run=run,
        status=cast(Status, outcome.status),
        reason=outcome.reason,
        advice=outcome.advice,
        q=state,
        jumps=np.empty(0) if before is None else before.jumps,
        frequency=np.sign(eigenvalue) * np.sqrt(np.abs(eigenvalue)) / (2 * np.pi),
        eigenvalue=eigenvalue,
        shapes=shapes,
        counts=counts,
        seconds=seconds,
    )
    if outcome.exception is not None:
        if isinstance(outcome.exception, KeyboardInterrupt):
            raise Interrupted(f"the run was interrupted with {len(eigenvalue)} modes", result) from outcome.exception
        raise outcome.exception
    if throw and result.status == "failed":
        raise SolveError(f"the run failed: {result.reason}. Try: {result.advice}", result)
    return result


def _load(model: Model, run: Modes, threads: int | None, progress: Progress, throw: bool) -> Result:
    """Find the equilibrium about which the model is to oscillate."""
    statics = Static(load_factors=(run.load_factor,))
    try:
        return solve(model, statics, threads=threads, progress=progress, throw=throw)
    except Interrupted as stopped:
        raise Interrupted(str(stopped), _without_modes(run, cast(Result, stopped.result))) from stopped


def _without_modes(run: Modes, before: Result) -> ModalResult:
    """Return what is left when statics does not reach the state about which the model is to oscillate."""
    return ModalResult(
        model=before.model,
        run=run,
        status=before.status,
        reason=f"no equilibrium beyond load factor {before.reached:.6g}: {before.reason}",
        advice=before.advice,
        q=before.q[-1] if len(before.q) else before.model.nodal_coordinates(),
        jumps=before.jumps,
        frequency=np.empty(0),
        eigenvalue=np.empty(0),
        shapes=np.empty((0, before.q.shape[1])),
        counts=before.counts,
        seconds=before.seconds,
    )
