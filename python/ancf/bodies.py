"""Bodies: a reference surface, its thickness and material, and the elements that carry it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, ClassVar, Literal, TypeAlias

from pydantic import PlainValidator

from ancf import _core
from ancf.inputs import Input, Pair, PairOfInts, Positive, table
from ancf.materials import Material

NODAL_VECTORS = {"thin36": ("r", "r_x", "r_y")}


class Surface(Input, ABC):
    """What bodies of every shape have in common; the arguments are described in `Rectangle`."""

    shape: ClassVar[str]

    divisions: PairOfInts
    thickness: Positive
    material: Annotated[Material, PlainValidator(table(Material))]
    element: Literal["thin36"] = "thin36"
    membrane: Literal["projected", "full", "lobatto"] = "projected"
    curvature: Literal["paper", "koiter"] = "paper"

    @abstractmethod
    def reference(self) -> _core.Shape:
        """Return the reference surface."""

    def add(self, core: _core.Model, name: str) -> None:
        """Add the body to the compiled model."""
        core.add_body(
            name,
            self.reference(),
            self.divisions,
            thickness=self.thickness,
            E=self.material.E,
            nu=self.material.nu,
            density=self.material.density,
            element=self.element,
            membrane=self.membrane,
            curvature=self.curvature,
        )


class Rectangle(Surface):
    """A rectangle, at rest flat in the X-Y plane with the corner x0y0 at the origin.

    The natural coordinates are x in [0, lx] and y in [0, ly], m.

    Parameters
    ----------
    size : pair of float
        lx and ly, m, greater than 0.
    divisions : pair of int
        Elements along x and y.
    thickness : float
        m, greater than 0.
    material : Material
        What it is made of; in a scene file the name of a [material] table.
    element : {"thin36"}, default "thin36"
        Dufva and Shabana (2005), Appendix 2: r, r_x and r_y at each of four nodes.
    membrane : {"projected", "full", "lobatto"}, default "projected"
        How the membrane strain is sampled: "projected" bends without locking, "full" is the paper's, "lobatto" the
        cheapest.
    curvature : {"paper", "koiter"}, default "paper"
        The measure of curvature: r_ab . n/abs(n)^3, Dufva and Shabana (2005), (32), or Koiter's r_ab . n/abs(n).

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> from ancf import Material
    >>> rubber = Material(E=1e5, nu=0.3, density=7810.0)
    >>> plate = Rectangle(size=(0.3, 0.3), divisions=(8, 8), thickness=0.01, material=rubber)
    """

    shape: ClassVar[str] = "rectangle"

    size: Pair

    def reference(self) -> _core.Shape:
        """Return the reference surface."""
        return _core.Shape.rectangle(self.size)


Body: TypeAlias = Annotated[Rectangle, PlainValidator(table(Rectangle, key="shape"))]
