"""Running a model."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from typing import Literal

from numpy.typing import ArrayLike

from ancf import _core
from ancf.errors import Interrupted, SolveError, from_core
from ancf.inputs import numbers, whole
from ancf.model import Model
from ancf.progress import Progress, meter
from ancf.result import Result
from ancf.run import Dynamic, Method, ProgressCall, Static

_Start = Callable[[_core.Model, int | None, ProgressCall], _core.Run]


def solve_static(
    model: Model,
    *,
    load_factors: Sequence[float] = (1.0,),
    path: Literal["load", "arc"] = "load",
    newton: Literal["mip", "plain"] = "mip",
    tolerance: float = 1e-8,
    max_iterations: int = 30,
    first_step: float | None = None,
    min_step: float = 1e-5,
    max_steps: int = 1000,
    threads: int | None = None,
    progress: Progress = None,
    throw: bool = True,
) -> Result:
    """Find the equilibrium of a model under loads that grow in adaptive steps.

    Parameters
    ----------
    model : Model
        What to load.
    load_factors, path, newton, tolerance, max_iterations, first_step, min_step, max_steps : optional
        As in `Static`.
    threads : int, optional
        How many; all if left out. The result does not depend on it.
    progress : bool or callable, optional
        True shows a bar on standard error if that is a terminal; a callable is called with the load factor reached.
    throw : bool, default True
        Raise an error if the run fails. Otherwise see `Result.status`.

    Returns
    -------
    Result
        The state without loads, then one for each load factor, or by arc length for each step.

    Raises
    ------
    InputError
        If an argument is wrong, or the model can move rigidly.
    SolveError
        If the run fails; `SolveError.result` holds what it had.
    Interrupted
        On Ctrl-C; `Interrupted.result` holds what it had.

    Warns
    -----
    PathWarning
        If a path by arc length ends before its last load factor; also in `Result.warnings`.
    """
    run = Static(
        load_factors=load_factors,
        path=path,
        newton=newton,
        tolerance=tolerance,
        max_iterations=max_iterations,
        first_step=first_step,
        min_step=min_step,
        max_steps=max_steps,
    )
    return solve(model, run, threads=threads, progress=progress, throw=throw)


def simulate(
    model: Model,
    *,
    until: float,
    step: float | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    first_step: float | None = None,
    max_step: float | None = None,
    min_step: float | None = None,
    force: bool = False,
    method: Method = "hht",
    alpha: float | None = None,
    rho_inf: float | None = None,
    lumped: bool = False,
    outputs: Sequence[float] | None = None,
    every: float | None = None,
    velocity: ArrayLike | None = None,
    newton: Literal["mip", "plain"] = "mip",
    tolerance: float = 1e-8,
    max_iterations: int = 30,
    reuse: bool = True,
    checkpoint: str | os.PathLike[str] | None = None,
    resume: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    throw: bool = True,
) -> Result:
    """Find the motion of a model.

    Parameters
    ----------
    model : Model
        What moves.
    until, step, rtol, atol, first_step, max_step, min_step, force, method, alpha, rho_inf, lumped, outputs, every, \
newton, tolerance, max_iterations, reuse : optional
        As in `Dynamic`; `until` is needed, and either `step` or `rtol`.
    velocity : array_like, shape (n,), optional
        Velocities of the nodal coordinates at t = 0, in the order of `Model.nodal_coordinates`; at rest if left out.
    checkpoint : str or path, optional
        A file that is replaced, in one go, about every second and at the end: what is needed to go on.
    resume : str or path, optional
        Such a file of the same model and options, to go on from: to the same bits as without a stop.
    threads : int, optional
        How many; all if left out. The result does not depend on it.
    progress : bool or callable, optional
        True shows a bar on standard error if that is a terminal; a callable is called with the time reached, s.
    throw : bool, default True
        Raise an error if the run fails. Otherwise see `Result.status`.

    Returns
    -------
    Result
        The state at t = 0, then one for each output time.

    Raises
    ------
    InputError
        If an argument is wrong.
    SolveError
        If the run fails; `SolveError.result` holds what it had.
    Interrupted
        On Ctrl-C; `Interrupted.result` holds what it had.

    Warns
    -----
    CourseWarning
        If fixed steps miss what a load or a support does between them, or the smooth curve of a moved support goes far
        beyond its rows; also in `Result.warnings`.
    EnergyWarning
        If the energy balance is off, so that the motion cannot be right; also in `Result.warnings`.
    CheckpointWarning
        If the last checkpoint could not be written, the disk is full, say; there, too.
    """
    run = Dynamic(
        until=until,
        step=step,
        rtol=rtol,
        atol=atol,
        first_step=first_step,
        max_step=max_step,
        min_step=min_step,
        force=force,
        method=method,
        alpha=alpha,
        rho_inf=rho_inf,
        lumped=lumped,
        outputs=outputs,
        every=every,
        newton=newton,
        tolerance=tolerance,
        max_iterations=max_iterations,
        reuse=reuse,
    )
    given_velocity = None if velocity is None else numbers("velocity", velocity, len(model.nodal_coordinates()))
    start = partial(run.start, velocity=given_velocity, checkpoint=checkpoint, resume=resume)
    return solve(model, run, threads=threads, progress=progress, throw=throw, start=start)


def solve(
    model: Model,
    run: Static | Dynamic,
    *,
    threads: int | None = None,
    progress: Progress = None,
    throw: bool = True,
    start: _Start | None = None,
) -> Result:
    """Run a model in any way; what `solve_static`, `simulate` and scenes have in common."""
    check_threads(threads)
    run.check(model)
    core = model.assemble(run.history)
    with meter(progress, run.end, run.unit) as call, from_core():
        outcome = (start or run.start)(core, threads, call)
        if call and outcome.exception is None:
            call(outcome.reached)
    result = Result.of(model, run, outcome)
    for doubt in result.doubts():
        warnings.warn(doubt, stacklevel=3)
    place = f"{run.parameter} = {result.reached:.6g} {run.unit}".rstrip()
    if outcome.exception is not None:
        raise _stopped(outcome.exception, place, result)
    if throw and result.status == "failed":
        raise SolveError(f"the run failed at {place}: {result.reason}. Try: {result.advice}", result)
    return result


def check_threads(threads: int | None) -> None:
    """Raise `InputError` unless `threads` is a possible number of them."""
    if threads is not None:
        whole("threads", threads, 1, 1024)


def _stopped(cause: BaseException, place: str, result: Result) -> BaseException:
    if isinstance(cause, KeyboardInterrupt):
        stopped = Interrupted(f"the run was interrupted at {place}", result)
        stopped.__cause__ = cause
        return stopped
    cause.add_note(f"It stopped the run at {place}; the attribute `result` holds the states up to there.")
    cause.__dict__["result"] = result
    return cause
