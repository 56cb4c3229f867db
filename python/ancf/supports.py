"""Supports: nodal coordinates that keep their value at rest, or move as prescribed."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal, Self, TypeAlias, TypeVar

import numpy as np
from pydantic import AfterValidator, PlainValidator, field_validator, model_validator

from ancf import _core
from ancf.bodies import NODAL_VECTORS
from ancf.errors import InputError, Mistake, Mistakes, one_of, show
from ancf.inputs import Input, OnBody, Positive, Vector, table
from ancf.places import EDGES, Anywhere

Axis: TypeAlias = Literal["x", "y", "z"]
Rows = TypeVar("Rows", bound=Sequence[Sequence[float]])

_FLAT = 1e-6
"""How far, relative to its size, a surface may be from its plane of symmetry: derivatives of maps are differences."""


def _check_rows(rows: Rows) -> Rows:
    if len(rows) < 2 or any(after[0] <= before[0] for before, after in pairwise(rows)):
        raise ValueError("must be at least two rows, their t increasing")
    return rows


class Shake(Input):
    """A harmonic translation, ``amplitude * sin(2 pi frequency t)``.

    Parameters
    ----------
    amplitude : three floats
        m.
    frequency : float
        Hz, greater than 0.
    """

    amplitude: Vector
    frequency: Positive


class Rotation(Input):
    """A rotation about a fixed axis.

    Parameters
    ----------
    axis : three floats
        Its direction.
    point : three floats, default the origin
        A point on it, m.
    angle : sequence of pairs
        Rows [t, angle], s and rad, joined by a smooth curve that begins at rest with the angle 0 and goes on with
        constant velocity after the last.
    """

    axis: Vector
    point: Vector = (0.0, 0.0, 0.0)
    angle: Annotated[Sequence[tuple[float, float]], AfterValidator(_check_rows)]

    @field_validator("axis")
    @classmethod
    def _check_axis(cls, axis: tuple[float, float, float]) -> tuple[float, float, float]:
        if not any(axis):
            raise ValueError("must have a direction")
        return axis


class Support(OnBody):
    """Nodal coordinates that keep their value at rest, or move as prescribed, at a place of a body.

    Parameters
    ----------
    body : str, optional
        Its name; may be left out where the model has just one.
    at : str or pair of float
        "corner:x0y0", "corner:x1y0", "corner:x1y1" or "corner:x0y1"; "edge:x0", "edge:x1", "edge:y0" or "edge:y1";
        the natural coordinates of a point, which stands for the nearest node; or "all".
    fix : sequence of str
        Nodal vectors ("r", "r_x", "r_y") or single components of them ("r.x", "r_x.z"). The gradients are along the
        natural coordinates.
    clamp : bool, default False
        Fix the position and all gradients instead.
    symmetry : {"x", "y", "z"}, optional
        Fix instead what a plane of symmetry normal to this global axis fixes at an edge that lies in it: of r, of the
        gradient along the edge and of r_z the component along the axis, of the gradient across it and r_xy the others.
    translation : sequence of four floats, optional
        Motion of the support: rows [t, x, y, z], s and m, joined by a smooth curve that begins at rest with zero and
        goes on with constant velocity after the last. In statics supports stay where they are.
    shake : Shake, optional
        A harmonic translation, added.
    rotation : Rotation, optional
        A rotation before the translation.

    Raises
    ------
    InputError
        If not one of `fix`, `clamp` and `symmetry` is given, or a value is impossible.

    Examples
    --------
    >>> pin = Support(at="corner:x0y0", fix=["r"])
    >>> wall = Support(at="edge:x0", clamp=True)
    >>> cut = Support(at="edge:x1", symmetry="x")
    """

    at: Anywhere
    fix: Sequence[str] = ()
    clamp: bool = False
    symmetry: Axis | None = None
    translation: Annotated[Sequence[tuple[float, float, float, float]], AfterValidator(_check_rows)] | None = None
    shake: Annotated[Shake, PlainValidator(table(Shake))] | None = None
    rotation: Annotated[Rotation, PlainValidator(table(Rotation))] | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if bool(self.fix) + self.clamp + (self.symmetry is not None) != 1:
            raise InputError(Mistake(("fix",), "give either the coordinates to fix, clamp = true, or symmetry"))
        if self.symmetry is not None:
            if self.at not in EDGES:
                raise InputError(Mistake(("at",), f"with symmetry {one_of(EDGES, self.at)}", show(self.at)))
            if self.moves:
                raise InputError(Mistake(("symmetry",), "a plane of symmetry cannot be moved", show(self.symmetry)))
        return self

    @property
    def moves(self) -> bool:
        """Whether its motion is prescribed."""
        return bool(self.translation or self.shake or self.rotation)

    def coordinates(self, element: str) -> Sequence[str]:
        """Return the nodal vectors, or components of them, that are fixed; of a clamp all.

        The field of a body is its own mirror image in a plane of symmetry. So across the plane the component along its
        normal is odd, of r as of what is differentiated along the edge, and the others are even; a derivative across it
        turns that round.
        """
        vectors = NODAL_VECTORS[element]
        if self.clamp:
            return vectors
        if self.symmetry is None:
            return self.fix
        normal, inside = self.symmetry, [axis for axis in "xyz" if axis != self.symmetry]
        turned = (f"r_{str(self.at)[5]}", "r_xy")
        return [f"{vector}.{axis}" for vector in vectors for axis in (inside if vector in turned else normal)]

    def check_coordinates(self, element: str) -> None:
        """Raise `InputError` if the nodes of the element have no such coordinates."""
        vectors = NODAL_VECTORS[element]
        known = {*vectors, *(f"{vector}.{axis}" for vector in vectors for axis in "xyz")}
        mistakes = Mistakes()
        for index, name in enumerate(self.fix):
            if name not in known:
                mistakes.add(("fix", index), f"allowed are {', '.join(vectors)} and their components, as r.x", name)
        mistakes.check()

    def check_symmetry(self, core: _core.Model, element: str) -> None:
        """Raise `InputError` if the edge is not in its plane of symmetry or the body does not cross it squarely."""
        if self.symmetry is None or (wrong := self._unsymmetric(core, element)) is None:
            return
        others = [self.model_copy(update={"symmetry": axis}) for axis in "xyz"]
        fitting = [str(other.symmetry) for other in others if other._unsymmetric(core, element) is None]
        reason = (
            f"the edge must lie in a plane normal to {self.symmetry}"
            if wrong == "r"
            else f"the body must cross the plane normal to {self.symmetry} squarely, its {wrong} does not"
        )
        allowed = one_of(fitting) if fitting else "here no axis is allowed"
        raise InputError(Mistake(("symmetry",), f"{reason}; {allowed}", show(self.symmetry)))

    def _unsymmetric(self, core: _core.Model, element: str) -> str | None:
        """Return the first nodal vector that at rest is not its own mirror image, None if there is none."""
        side, end = str(self.at)[5], str(self.at)[6]
        natural = core.nodes(self.body)[:, "xy".index(side)]
        edge = natural == (natural.max() if end == "1" else natural.min())
        vectors = core.reference()[core.vectors(self.body)[:, :, None] + np.arange(3, dtype=np.uint64)]
        names = NODAL_VECTORS[element]
        size = np.ptp(vectors[:, 0], axis=0).max()
        largest = dict(zip(names, np.linalg.norm(vectors, axis=2).max(axis=0), strict=True))
        scales = largest | {"r": size, "r_xy": largest["r_x"] * largest["r_y"] / size}
        for name in self.coordinates(element):
            vector, _, axis = name.partition(".")
            values = vectors[edge, names.index(vector), "xyz".index(axis)]
            off = np.ptp(values) if vector == "r" else np.abs(values).max()
            if off > _FLAT * scales[vector]:
                return vector
        return None

    def add(self, core: _core.Model, element: str) -> None:
        """Add the support to the compiled model."""
        if not self.moves:
            core.fix(self.body, self.at, self.coordinates(element))
            return
        shake, turn = self.shake, self.rotation
        core.move_support(
            self.body,
            self.at,
            self.coordinates(element),
            translation=self.translation,
            shake=(shake.amplitude, shake.frequency) if shake else None,
            rotation=(turn.point, turn.axis, turn.angle) if turn else None,
        )
