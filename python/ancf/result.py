"""Results: the states of a run, what was recorded of them, and how the run went."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ancf import _core
from ancf.balance import EnergyWarning, balance_warnings
from ancf.courses import CourseWarning, course_warnings
from ancf.model import Model
from ancf.probes import Probe, Quantity
from ancf.records import Energy, FloatArray, Reaction, Record
from ancf.run import CheckpointWarning, Dynamic, PathWarning, Static

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from matplotlib.figure import Figure

Status = Literal["ok", "failed", "interrupted"]


_RESTS = 1e-9
"""Changes of nodal coordinates, relative to their range, that are none: strains of them square to rounding."""


@dataclass(frozen=True, eq=False)
class Result:
    """What a run leaves: every state up to its end, and how it ended.

    Parameters
    ----------
    model : Model
        What was run.
    run : Static or Dynamic
        How it was run.
    status : {"ok", "failed", "interrupted"}
        How it ended.
    reason, advice : str
        Why it did not end well and what to try; empty if it did.
    reached : float
        The last time, s, or load factor.
    jumps : ndarray, shape (jumps,)
        Load factors at which a structure in statics has jumped to another equilibrium, up to 1.5 % above those at
        which it lost its own.
    t : ndarray, shape (states,)
        Times, s, or load factors; the first is 0, the state at the start.
    q, v, a : ndarray, shape (states, n)
        Nodal coordinates (order: `Model.nodal_coordinates`) and their first and second derivatives in time; in
        statics v and a are zero.
    probes : dict of str to Record
        What each probe recorded.
    reactions : tuple of Reaction
        What each support of the model exerts, in their order.
    energy : Energy
        Energies and the work of the loads.
    momentum, angular_momentum : ndarray, shape (states, 3)
        kg m/s, and kg m2/s about the origin.
    negative_pivots : ndarray of int, shape (states,)
        Eigenvalues of the tangent with a negative real part, 0 where the equilibrium is stable; -1 where they were not
        counted.
    counts : dict of str to int
        elements, dofs, steps, rejected and its causes (inaccurate, unsolved, singular, not_finite), iterations,
        forces (evaluations), factorizations.
    seconds : dict of str to float
        total, setup, assembly, factorization, solve.
    unsaved : str, optional
        Why the last checkpoint could not be written.
    """

    model: Model = field(repr=False)
    run: Static | Dynamic
    status: Status
    reason: str
    advice: str
    reached: float
    jumps: FloatArray
    t: FloatArray = field(repr=False)
    q: FloatArray = field(repr=False)
    v: FloatArray = field(repr=False)
    a: FloatArray = field(repr=False)
    probes: dict[str, Record] = field(repr=False)
    reactions: tuple[Reaction, ...] = field(repr=False)
    energy: Energy = field(repr=False)
    momentum: FloatArray = field(repr=False)
    angular_momentum: FloatArray = field(repr=False)
    negative_pivots: NDArray[np.int64] = field(repr=False)
    counts: dict[str, int]
    seconds: dict[str, float]
    unsaved: str | None = None

    @classmethod
    def of(cls, model: Model, run: Static | Dynamic, core: _core.Run) -> Result:
        """Make the result of what the compiled module returned."""

        def record(probe: Probe) -> Record:
            value = model.evaluate(probe.body, [probe.at], probe.quantity, core.q, core.v)
            return Record(core.t, value[:, 0, :])

        # Of no state the compiled module knows no supports either.
        reactions = core.reactions.reshape(len(core.t), len(model.supports), 9)
        return cls(
            model=model,
            run=run,
            status=cast(Status, core.status),
            reason=core.reason,
            advice=core.advice,
            reached=core.reached,
            jumps=core.jumps,
            t=core.t,
            q=core.q,
            v=core.v,
            a=core.a,
            probes={probe.name: record(probe) for probe in model.probes},
            reactions=tuple(
                Reaction(support, core.t, *np.split(reactions[:, index], 3, axis=1))
                for index, support in enumerate(model.supports)
            ),
            energy=Energy(core.t, **core.energy),
            momentum=core.momentum,
            angular_momentum=core.angular_momentum,
            negative_pivots=core.negative_pivots,
            counts=core.counts,
            seconds=core.seconds,
            unsaved=core.unsaved,
        )

    @property
    def states(self) -> int:
        """How many states there are."""
        return len(self.t)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful about a path or a motion, and what to try.

        That a path by arc length ends before its last load factor; in motion tables over time that it does not see as
        they are meant; where and how far its energy balance is off; that the last checkpoint could not be written.
        """
        return tuple(str(doubt) for doubt in self.doubts())

    def doubts(self) -> list[RuntimeWarning]:
        """Return the same as the warnings that are given."""
        doubts: list[RuntimeWarning] = []
        if isinstance(self.run, Static) and self.status == "ok" and self.reached != self.run.load_factors[-1]:
            text = f"the path ends after {self.run.max_steps} steps at load factor {self.reached:.6g}"
            cure = 'more max_steps, or path = "load", which jumps where a path turns away'
            doubts.append(PathWarning(f"{text}, before {self.run.load_factors[-1]:g}. Try: {cure}"))
        if isinstance(self.run, Dynamic):
            doubts += [CourseWarning(text) for text in course_warnings(self.model, self.run)]
            if not self._rests():
                moved = any(support.moves for support in self.model.supports)
                doubts += [EnergyWarning(text) for text in balance_warnings(self.run, self.energy, moved)]
        if self.unsaved is not None:
            doubts.append(CheckpointWarning(f"the last checkpoint was not written: {self.unsaved}"))
        return doubts

    def _rests(self) -> bool:
        """Whether all nodal coordinates stay where they are, but for rounding: energies are rounding, too."""
        return bool(np.ptp(self.q, axis=0).max() < _RESTS * np.ptp(self.q[0])) if len(self.q) else True

    def evaluate(self, body: str, points: ArrayLike, quantity: Quantity) -> FloatArray:
        """Return a quantity at material points in every state.

        Parameters
        ----------
        body : str
            Its name.
        points : array_like, shape (points, 2)
            Natural coordinates.
        quantity : str
            One of those of `Probe`.

        Returns
        -------
        ndarray, shape (states, points, components)
            In the unit of the quantity.

        Raises
        ------
        InputError
            If there is no such body or quantity, or a point is outside.
        """
        return self.model.evaluate(body, points, quantity, self.q, self.v)

    def positions(self, body: str, points: ArrayLike) -> FloatArray:
        """Return the positions of material points in every state.

        Parameters
        ----------
        body : str
            Its name.
        points : array_like, shape (points, 2)
            Natural coordinates.

        Returns
        -------
        ndarray, shape (states, points, 3)
            m.

        Raises
        ------
        InputError
            If there is no such body or a point is outside.
        """
        return self.evaluate(body, points, "position")

    def plot(self, title: str = "") -> Figure:
        """Draw the bodies at rest and deformed, and the records of the probes.

        Parameters
        ----------
        title : str, optional
            Written above.

        Returns
        -------
        matplotlib.figure.Figure
            To be saved with its ``savefig``.
        """
        from ancf.plot import plot  # noqa: PLC0415  Matplotlib takes longer to import than most scenes to run.

        return plot(self, title)

    def animate(self, path: str | os.PathLike[str], title: str = "") -> None:
        """Write the motion as a film.

        Parameters
        ----------
        path : str or path
            The file; ".gif" or, with ffmpeg, ".mp4".
        title : str, optional
            Written above.

        Raises
        ------
        InputError
            If the file has another ending, or ffmpeg is needed and missing.
        """
        from ancf.film import animate  # noqa: PLC0415  As above.

        animate(self, path, title)

    def write_fields(
        self,
        path: str | os.PathLike[str],
        subdivisions: int | None = None,
        quantities: Sequence[Quantity] | None = None,
    ) -> None:
        """Write all states as files for ParaView and PyVista; needs ``ancf[fields]``.

        Parameters
        ----------
        path : str or path
            The collection to open, "fields.pvd", which gives every state its time or load factor. The states are in a
            folder beside it, "fields/00000.vtu" and so on: the middle surfaces with the quantities at their points, the
            natural coordinates of these, and for each facet the number of its body.
        subdivisions : int, optional
            Facets along each side of an element; from 12 for one element to 1 for many if left out.
        quantities : sequence of str, optional
            Of those of `Probe`. If left out: displacement, velocity in motion, normal, membrane_force, moment,
            shear_force, stress and von_mises of the faces and the middle.

        Raises
        ------
        InputError
            If the file has another ending, a quantity does not exist, or PyVista is missing.
        OSError
            If a file cannot be written; an earlier run's files are left as they were.
        """
        from ancf.fields import write_fields  # noqa: PLC0415  As above.

        write_fields(self, path, subdivisions, quantities)
