"""Natural frequencies and mode shapes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ancf import _core
from ancf.errors import Interrupted, SolveError, from_core
from ancf.inputs import numbers, whole
from ancf.model import Model
from ancf.progress import Progress, meter
from ancf.result import Result, Status
from ancf.run import Modes, Static
from ancf.solve import check_threads, solve

if TYPE_CHECKING:
    import os

    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]

_AMPLITUDE = 0.1


@dataclass(frozen=True, eq=False)
class ModalResult:
    """Small oscillations about a state: frequencies in increasing order, and shapes.

    Parameters
    ----------
    model : Model
        What oscillates.
    run : Modes
        What was asked for.
    status : {"ok", "failed", "interrupted"}
        How it ended; if not "ok" there may be fewer modes, and some in between may be missing.
    reason, advice : str
        Why it did not end well and what to try; empty if it did.
    q : ndarray, shape (n,)
        The nodal coordinates about which it oscillates.
    frequency : ndarray, shape (modes,)
        Hz. Exactly 0 for motions without stiffness, as the rigid ones of a free body. Negative where the state is not
        stable: a mode with the frequency -f grows as exp(2 pi f t).
    eigenvalue : ndarray, shape (modes,)
        Squares of the circular frequencies, 1/s2; negative where the state is not stable.
    shapes : ndarray, shape (modes, n)
        Changes of the nodal coordinates, orthonormal with respect to the mass matrix.
    counts : dict of str to int
        As of `Result`, those of statics included; iterations are products with the inverse.
    seconds : dict of str to float
        total, setup, assembly, factorization, solve.
    """

    model: Model = field(repr=False)
    run: Modes
    status: Status
    reason: str
    advice: str
    q: FloatArray = field(repr=False)
    frequency: FloatArray
    eigenvalue: FloatArray = field(repr=False)
    shapes: FloatArray = field(repr=False)
    counts: dict[str, int]
    seconds: dict[str, float]

    @property
    def states(self) -> int:
        """How many modes there are, as `reached`."""
        return len(self.frequency)

    @property
    def reached(self) -> int:
        """How many modes were found."""
        return len(self.frequency)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about the modes: nothing, they are proved complete or the run fails."""
        return ()

    @property
    def unstable(self) -> int:
        """How many of the modes grow: 0 about a stable equilibrium."""
        return int(np.count_nonzero(self.eigenvalue < 0))

    def displacements(self, body: str, points: ArrayLike) -> FloatArray:
        """Return the mode shapes at material points.

        Parameters
        ----------
        body : str
            Its name.
        points : array_like, shape (points, 2)
            Natural coordinates.

        Returns
        -------
        ndarray, shape (modes, points, 3)
            Displacements of the modes of modal mass 1 kg m2, m.

        Raises
        ------
        InputError
            If there is no such body or a point is outside.
        """
        return self.model.evaluate(body, points, "position", self.shapes)

    def oscillation(self, mode: int, phases: ArrayLike) -> FloatArray:
        """Return nodal coordinates of an oscillation that can be seen: by a tenth of the size of the model.

        Parameters
        ----------
        mode : int
            Which, from 0.
        phases : array_like, shape (states,)
            Of the oscillation, rad; at 0 it passes the state at rest.

        Returns
        -------
        ndarray, shape (states, n)
            Nodal coordinates. Where the amplitude of a rotation is large, lengths change: it is one of first order.

        Raises
        ------
        InputError
            If there is no such mode.
        """
        whole("mode", mode, 0, len(self.frequency) - 1)
        places = self._nodes(self.q)
        size = np.linalg.norm(np.ptp(places, axis=0))
        scale = _AMPLITUDE * size / np.linalg.norm(self._nodes(self.shapes[mode]), axis=-1).max()
        waves = np.sin(numbers("phases", phases, "states"))
        states: FloatArray = self.q + scale * np.outer(waves, self.shapes[mode])
        return states

    def _nodes(self, q: FloatArray) -> FloatArray:
        parts = [
            self.model.evaluate(name, self.model.nodes(name), "position", q[None])[0] for name in self.model.bodies
        ]
        return np.concatenate(parts)

    def plot(self, title: str = "", count: int = 6) -> Figure:
        """Draw the shapes of the first modes that are not rigid.

        Parameters
        ----------
        title : str, optional
            Written above.
        count : int, default 6
            How many.

        Returns
        -------
        matplotlib.figure.Figure
            To be saved with its ``savefig``.
        """
        from ancf.plot import plot_modes  # noqa: PLC0415  Matplotlib takes longer to import than most scenes to run.

        return plot_modes(self, title, count)

    def animate(self, path: str | os.PathLike[str], title: str = "", mode: int | None = None) -> None:
        """Write one mode as a film.

        Parameters
        ----------
        path : str or path
            The file; ".gif" or, with ffmpeg, ".mp4".
        title : str, optional
            Written above.
        mode : int, optional
            Which, from 0; the first that is not rigid if left out.

        Raises
        ------
        InputError
            If there is no such mode, the file has another ending, or ffmpeg is needed and missing.
        """
        from ancf.film import animate_mode  # noqa: PLC0415  As above.

        animate_mode(self, path, title, mode)

    def write_fields(self, path: str | os.PathLike[str], subdivisions: int | None = None) -> None:
        """Write the mode shapes as files for ParaView and PyVista, see `Result.write_fields`.

        Parameters
        ----------
        path : str or path
            The collection, ".pvd"; its "times" are the numbers of the modes, from 1.
        subdivisions : int, optional
            Facets along each side of an element.

        Raises
        ------
        InputError
            If the file has another ending or PyVista is missing.
        OSError
            If a file cannot be written.
        """
        from ancf.fields import write_modes  # noqa: PLC0415  As above.

        write_modes(self, path, subdivisions)

    def visible(self) -> list[int]:
        """Return the modes that are not rigid, or all if there are no others."""
        return np.flatnonzero(self.frequency).tolist() or list(range(len(self.frequency)))


AnyResult: TypeAlias = Result | ModalResult
"""What any run leaves, for what shows and writes all of them."""


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
        frequency=np.empty(0),
        eigenvalue=np.empty(0),
        shapes=np.empty((0, before.q.shape[1])),
        counts=before.counts,
        seconds=before.seconds,
    )
