"""Supports: nodal coordinates that keep their value at rest, or move as prescribed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Self

from pydantic import PlainValidator, model_validator

from ancf import _core
from ancf.bodies import NODAL_VECTORS
from ancf.errors import InputError, Mistake, Mistakes
from ancf.inputs import Input, OnBody, Positive, Vector, table
from ancf.places import Anywhere


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
    angle: Sequence[tuple[float, float]]


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
        If neither or both of `fix` and `clamp` are given, or a value is impossible.

    Examples
    --------
    >>> pin = Support(at="corner:x0y0", fix=["r"])
    >>> wall = Support(at="edge:x0", clamp=True)
    """

    at: Anywhere
    fix: Sequence[str] = ()
    clamp: bool = False
    translation: Sequence[tuple[float, float, float, float]] | None = None
    shake: Annotated[Shake | None, PlainValidator(table(Shake))] = None
    rotation: Annotated[Rotation | None, PlainValidator(table(Rotation))] = None

    @model_validator(mode="after")
    def _fix_or_clamp(self) -> Self:
        if self.clamp == bool(self.fix):
            raise InputError(Mistake(("fix",), "give either the coordinates to fix or clamp = true"))
        return self

    @property
    def moves(self) -> bool:
        """Whether its motion is prescribed."""
        return bool(self.translation or self.shake or self.rotation)

    def check_coordinates(self, element: str) -> None:
        """Raise `InputError` if the nodes of the element have no such coordinates."""
        vectors = NODAL_VECTORS[element]
        known = {*vectors, *(f"{vector}.{axis}" for vector in vectors for axis in "xyz")}
        mistakes = Mistakes()
        for index, name in enumerate(self.fix):
            if name not in known:
                mistakes.add(("fix", index), f"allowed are {', '.join(vectors)} and their components, as r.x", name)
        mistakes.check()

    def add(self, core: _core.Model) -> None:
        """Add the support to the compiled model."""
        if self.moves:
            shake, turn = self.shake, self.rotation
            core.move_support(
                self.body,
                self.at,
                self.fix,
                translation=self.translation,
                shake=(shake.amplitude, shake.frequency) if shake else None,
                rotation=(turn.point, turn.axis, turn.angle) if turn else None,
            )
        elif self.clamp:
            core.clamp(self.body, self.at)
        else:
            core.fix(self.body, self.at, self.fix)
