"""Bodies: a reference surface, its thickness and material, and the elements that carry it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, ClassVar, Literal

from pydantic import PlainValidator

from ancf import _core
from ancf.inputs import Input, Pair, PairOfInts, Point, Positive, table
from ancf.materials import Material

NODAL_VECTORS = {
    "thin36": ("r", "r_x", "r_y"),
    "thin48": ("r", "r_x", "r_y", "r_xy"),
    "full48a": ("r", "r_x", "r_y", "r_z"),
    "full48b": ("r", "r_x", "r_y", "r_z"),
}


class Plate(Input, ABC):
    """What bodies of every shape have in common; the arguments are described in `Rectangle`."""

    shape: ClassVar[str]

    divisions: PairOfInts
    thickness: Positive
    material: Annotated[Material, PlainValidator(table(Material))]
    element: Literal["thin36", "thin48", "full48a", "full48b"] = "thin36"
    membrane: Literal["projected", "full", "lobatto"] | None = None
    curvature: Literal["paper", "koiter"] | None = None

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
            mass_damping=self.material.mass_damping,
            viscosity=self.material.viscosity,
            element=self.element,
            membrane=self.membrane,
            curvature=self.curvature,
        )


class Rectangle(Plate):
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
    element : {"thin36", "thin48", "full48a", "full48b"}, default "thin36"
        "thin36" is the plate of Dufva and Shabana (2005), Appendix 2, with r, r_x and r_y at each of four nodes;
        "thin48" has r_xy besides and a continuous slope. "full48a" and "full48b" have r_z besides and are solids, for
        comparison: they converge slowly when bent.
    membrane : {"projected", "full", "lobatto"}, optional
        How the membrane strain of a thin element is sampled: "projected", the default, bends without locking, "full" is
        the paper's, "lobatto", for "thin36" only, the cheapest. Where bending in the plane or uneven tension decides,
        take "full": coarse meshes of "projected" are too soft there.
    curvature : {"paper", "koiter"}, optional
        The measure of curvature of a thin element: "paper", the default, is r_ab . n/abs(n)^3, Dufva and Shabana
        (2005), (32), "koiter" r_ab . n/abs(n).

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


class Annulus(Plate):
    """A sector of an annulus, at rest flat in the X-Y plane about the origin.

    The natural coordinates are the radius in [inner, outer], m, and the angle in [0, angle], rad. At a full turn it is
    slit along the X axis.

    Parameters
    ----------
    radii : pair of float
        Inner and outer radius, m, greater than 0 and increasing.
    angle : float
        rad, greater than 0, at most 2 pi.
    divisions, thickness, material, element, membrane, curvature
        As for `Rectangle`.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> from ancf import Material
    >>> steel = Material(E=2.1e11, nu=0.3)
    >>> ring = Annulus(radii=(6, 10), angle=6.28, divisions=(3, 24), thickness=0.03, material=steel)
    """

    shape: ClassVar[str] = "annulus"

    radii: Pair
    angle: float

    def reference(self) -> _core.Shape:
        """Return the reference surface."""
        return _core.Shape.annulus(self.radii, self.angle)


class Cylinder(Plate):
    """A part of a circular cylinder about the Z axis: (R cos x, R sin x, y), the normal outwards.

    The natural coordinates are the angle x, rad, and the coordinate y along the axis, m. At a full turn it is slit.

    Parameters
    ----------
    radius : float
        R, m, greater than 0.
    angle : pair of float
        First and last angle, rad, increasing and at most 2 pi apart.
    length : pair of float
        First and last coordinate along the axis, m, increasing.
    divisions, thickness, material, element, membrane, curvature
        As for `Rectangle`.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> from ancf import Material
    >>> steel = Material(E=2.1e11, nu=0.3)
    >>> roof = Cylinder(
    ...     radius=2.54, angle=(-0.1, 0.1), length=(0, 0.5), divisions=(8, 8), thickness=0.01, material=steel
    ... )
    """

    shape: ClassVar[str] = "cylinder"

    radius: Positive
    angle: Point
    length: Point

    def reference(self) -> _core.Shape:
        """Return the reference surface."""
        return _core.Shape.cylinder(self.radius, self.angle, self.length)


class Sphere(Plate):
    """A part of a sphere about the origin: R (cos y cos x, cos y sin x, sin y), the normal outwards.

    The natural coordinates are the longitude x and the latitude y, rad. At a full turn it is slit.

    Parameters
    ----------
    radius : float
        R, m, greater than 0.
    longitude : pair of float
        First and last longitude, rad, increasing and at most 2 pi apart.
    latitude : pair of float
        First and last latitude, rad, increasing, above -pi/2 and below pi/2: the poles themselves are left out.
    divisions, thickness, material, element, membrane, curvature
        As for `Rectangle`.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> from ancf import Material
    >>> steel = Material(E=2.1e11, nu=0.3)
    >>> dome = Sphere(
    ...     radius=10, longitude=(0, 1.57), latitude=(0, 1.25), divisions=(16, 16), thickness=0.04, material=steel
    ... )
    """

    shape: ClassVar[str] = "sphere"

    radius: Positive
    longitude: Point
    latitude: Point

    def reference(self) -> _core.Shape:
        """Return the reference surface."""
        return _core.Shape.sphere(self.radius, self.longitude, self.latitude)


SHAPES: tuple[type[Plate], ...] = (Rectangle, Annulus, Cylinder, Sphere)
"""The shapes that scene files name."""
