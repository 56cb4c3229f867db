"""Results of modes: natural frequencies and mode shapes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ancf.inputs import numbers, whole
from ancf.model import Model
from ancf.result import Result, Status
from ancf.run import Modes

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
    jumps : ndarray, shape (jumps,)
        Load factors at which the structure has jumped on its way to this state, as of `Result`.
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
    jumps: FloatArray
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
