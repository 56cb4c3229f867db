"""Supports: nodal coordinates that keep their value at rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from pydantic import model_validator

from ancf import _core
from ancf.bodies import NODAL_VECTORS
from ancf.errors import InputError, Mistake, Mistakes
from ancf.inputs import OnBody
from ancf.places import Anywhere


class Support(OnBody):
    """Nodal coordinates that keep their value at rest, at a place of a body.

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

    @model_validator(mode="after")
    def _fix_or_clamp(self) -> Self:
        if self.clamp == bool(self.fix):
            raise InputError(Mistake(("fix",), "give either the coordinates to fix or clamp = true"))
        return self

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
        if self.clamp:
            core.clamp(self.body, self.at)
        else:
            core.fix(self.body, self.at, self.fix)
