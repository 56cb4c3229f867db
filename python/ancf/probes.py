"""Probes: quantities to record at material points."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple, TypeAlias

from pydantic import Field

from ancf.inputs import OnBody, Point

Quantity: TypeAlias = Literal[
    "position",
    "displacement",
    "velocity",
    "normal",
    "membrane_strain",
    "curvature",
    "membrane_force",
    "moment",
    "shear_force",
    "stress_top",
    "stress_middle",
    "stress_bottom",
    "cauchy_stress_top",
    "cauchy_stress_middle",
    "cauchy_stress_bottom",
    "principal_stress_top",
    "principal_stress_middle",
    "principal_stress_bottom",
    "von_mises_top",
    "von_mises_middle",
    "von_mises_bottom",
]


class Meaning(NamedTuple):
    """What the values of a quantity are."""

    unit: str
    components: tuple[str, ...]


_VECTOR = ("x", "y", "z")
_SYMMETRIC = ("xx", "yy", "xy")
_PRINCIPAL = ("1", "2")

QUANTITIES: dict[Quantity, Meaning] = {
    "position": Meaning("m", _VECTOR),
    "displacement": Meaning("m", _VECTOR),
    "velocity": Meaning("m/s", _VECTOR),
    "normal": Meaning("", _VECTOR),
    "membrane_strain": Meaning("", _SYMMETRIC),
    "curvature": Meaning("1/m", _SYMMETRIC),
    "membrane_force": Meaning("N/m", _SYMMETRIC),
    "moment": Meaning("N", _SYMMETRIC),
    "shear_force": Meaning("N/m", ("xz", "yz")),
    "stress_top": Meaning("Pa", _SYMMETRIC),
    "stress_middle": Meaning("Pa", _SYMMETRIC),
    "stress_bottom": Meaning("Pa", _SYMMETRIC),
    "cauchy_stress_top": Meaning("Pa", _SYMMETRIC),
    "cauchy_stress_middle": Meaning("Pa", _SYMMETRIC),
    "cauchy_stress_bottom": Meaning("Pa", _SYMMETRIC),
    "principal_stress_top": Meaning("Pa", _PRINCIPAL),
    "principal_stress_middle": Meaning("Pa", _PRINCIPAL),
    "principal_stress_bottom": Meaning("Pa", _PRINCIPAL),
    "von_mises_top": Meaning("Pa", ("",)),
    "von_mises_middle": Meaning("Pa", ("",)),
    "von_mises_bottom": Meaning("Pa", ("",)),
}


class Probe(OnBody):
    """A quantity to record at a material point.

    Parameters
    ----------
    name : str
        What the record is called in the result.
    body : str, optional
        Its name; may be left out where the model has just one.
    at : pair of float
        Natural coordinates of the material point.
    quantity : str, default "position"
        "position" or "displacement", m, "velocity", m/s, or the unit "normal", components x, y, z;
        "membrane_strain" or "curvature", 1/m, components xx, yy and doubled xy; "membrane_force", N/m, "moment",
        N m/m, components xx, yy, xy; "shear_force", N/m, components xz, yz, what the part beyond a cut exerts along the
        normal. Stresses, Pa, on the face that the normal points to, in the middle and on the other face, ending in
        "_top", "_middle" and "_bottom": "stress", second Piola-Kirchhoff, and "cauchy_stress", components xx, yy, xy;
        "principal_stress", the larger and the smaller principal value of the Cauchy stress in the surface; "von_mises"
        of it. Components are those of the orthonormal frame of the shape at rest: x along r_x, y across it in the
        tangent plane; of Cauchy stresses, of the same frame of the deformed surface. Curvature is positive towards the
        normal, so that a positive moment M presses the top: stress_top = N / h - 6 M / h**2, N the membrane force.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> corner = Probe(name="A", at=(0.3, 0.3))
    """

    name: Annotated[str, Field(min_length=1)]
    at: Point
    quantity: Quantity = "position"
