"""Loads.

Each has a `history`, the factor on it:

- "constant" is 1, the default in motion;
- "ramp" is the load factor, the default in statics and only for them;
- pairs [[t, factor], ...] are joined by straight lines and constant outside; t is the time in s, in statics the load
  factor.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import PlainValidator

from ancf import _core
from ancf.inputs import Input, OnBody, Vector, table
from ancf.places import CornerOrPoint, Edge, is_number


def _check_history(value: Any) -> Any:
    if value in ("constant", "ramp"):
        return value
    if not isinstance(value, tuple) or not value or not all(map(_is_pair, value)):
        raise ValueError("allowed are constant, ramp and a list of pairs [[t, factor], ...]")
    if any(after[0] <= before[0] for before, after in pairwise(value)):
        raise ValueError("the t of [[t, factor], ...] must increase")
    return value


def _is_pair(value: object) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and all(map(is_number, value))


History: TypeAlias = Literal["constant", "ramp"] | Sequence[tuple[float, float]]


class _Load(Input, ABC):
    kind: ClassVar[str]

    history: Annotated[History, PlainValidator(_check_history)] | None = None

    @abstractmethod
    def add(self, core: _core.Model, history: History) -> None:
        """Add the load to the compiled model, with `history` where it has none."""


class Gravity(_Load):
    """The same acceleration on all mass of all bodies.

    Parameters
    ----------
    acceleration : three floats
        m/s2.
    history : "constant", "ramp" or sequence of pairs, optional
        The factor on the load, see `ancf.loads`.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> gravity = Gravity(acceleration=(0.0, 0.0, -9.81))
    """

    kind: ClassVar[str] = "gravity"

    acceleration: Vector

    def add(self, core: _core.Model, history: History) -> None:
        """Add the load to the compiled model, with `history` where it has none."""
        core.add_gravity(self.acceleration, self.history or history)


class Force(_Load, OnBody):
    """A force on a material point; it keeps its direction.

    Parameters
    ----------
    body : str, optional
        Its name; may be left out where the model has just one.
    at : str or pair of float
        "corner:x0y0", "corner:x1y0", "corner:x1y1", "corner:x0y1", or the natural coordinates of a point.
    force : three floats
        N.
    history : "constant", "ramp" or sequence of pairs, optional
        The factor on the load, see `ancf.loads`.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "force"

    at: CornerOrPoint
    force: Vector

    def add(self, core: _core.Model, history: History) -> None:
        """Add the load to the compiled model, with `history` where it has none."""
        core.add_force(self.body, self.at, self.force, self.history or history)


class LineLoad(_Load, OnBody):
    """A force along an edge, per length at rest; it keeps its direction.

    Parameters
    ----------
    body : str, optional
        Its name; may be left out where the model has just one.
    at : str
        "edge:x0", "edge:x1", "edge:y0" or "edge:y1".
    per_length : three floats
        N/m.
    history : "constant", "ramp" or sequence of pairs, optional
        The factor on the load, see `ancf.loads`.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "line"

    at: Edge
    per_length: Vector

    def add(self, core: _core.Model, history: History) -> None:
        """Add the load to the compiled model, with `history` where it has none."""
        core.add_line_load(self.body, self.at, self.per_length, self.history or history)


class Moment(_Load, OnBody):
    """A moment along an edge, per length at rest, about the edge, which it follows.

    Parameters
    ----------
    body : str, optional
        Its name; may be left out where the model has just one.
    at : str
        "edge:x0", "edge:x1", "edge:y0" or "edge:y1".
    per_length : float
        N m/m. Where it is positive it turns the outward direction of the edge towards the normal ``r_x x r_y``, and is
        the "moment" across the edge that a `Probe` there records.
    history : "constant", "ramp" or sequence of pairs, optional
        The factor on the load, see `ancf.loads`.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "moment"

    at: Edge
    per_length: float

    def add(self, core: _core.Model, history: History) -> None:
        """Add the load to the compiled model, with `history` where it has none."""
        core.add_moment(self.body, self.at, self.per_length, self.history or history)


class Pressure(_Load, OnBody):
    """A pressure on a whole body along its current normal r_x x r_y, which it follows.

    Parameters
    ----------
    body : str, optional
        Its name; may be left out where the model has just one.
    pressure : float
        Pa, per current area.
    history : "constant", "ramp" or sequence of pairs, optional
        The factor on the load, see `ancf.loads`.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "pressure"

    pressure: float

    def add(self, core: _core.Model, history: History) -> None:
        """Add the load to the compiled model, with `history` where it has none."""
        core.add_pressure(self.body, self.pressure, self.history or history)


Load: TypeAlias = Annotated[
    Gravity | Force | LineLoad | Pressure | Moment,
    PlainValidator(table(Gravity, Force, LineLoad, Pressure, Moment, key="kind")),
]
