"""Element `thin36`: thin plates and shells with nodal vectors r, r_x, r_y; Dufva and Shabana (2005)."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from .arrays import FloatArray, einsum
from .energy import StrainEnergy
from .quadrature import Rule, gauss, lobatto3, square
from .shape import THIN36
from .strain import Curvature, Membrane, StrainMeasure, normal

MembraneRule: TypeAlias = Literal["full", "lobatto", "projected"]
CurvatureKind: TypeAlias = Literal["paper", "koiter"]

AREA_POWER: dict[CurvatureKind, int] = {"paper": 2, "koiter": 0}


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material: Young's modulus E in Pa, Poisson's ratio nu, density in kg/m3."""

    E: float
    nu: float
    density: float


@dataclass(frozen=True)
class Thin36:
    """A block of `thin36` elements over equal rectangles of parameters.

    Attributes
    ----------
    l, w : float
        Ranges of the parameters x and y in an element.
    reference : ndarray, shape (elements, 12, 3)
        Nodal coordinates e_0 of the reference configuration: nodes A, B, C, D, vectors r, r_x, r_y.
    thickness : float
        In m.
    material : Material
    membrane : {"projected", "full", "lobatto"}
        Treatment of the membrane energy.
    curvature : {"paper", "koiter"}
        Power of the area stretch in the curvature.
    """

    l: float
    w: float
    reference: FloatArray
    thickness: float
    material: Material
    membrane: MembraneRule = "projected"
    curvature: CurvatureKind = "paper"

    def mass(self) -> FloatArray:
        """Mass of each element, int rho h N_a N_b sqrt(det A) dx dy, kg, shape (elements, 12, 12).

        It multiplies the 3x3 identity; Dufva and Shabana (2005), (37), (38).
        """
        rule = square(gauss(5))
        N = THIN36.table(rule.points, self.l, self.w)[:, 0]
        scale = self.material.density * self.thickness * self.area_weights(rule)
        return einsum("es,sa,sb->eab", scale, N, N, optimize=True)

    def area_weights(self, rule: Rule) -> FloatArray:
        """Weights of a rule times the reference area sqrt(det A) dx dy, m2, shape (elements, samples)."""
        return self.l * self.w * rule.weights * self._area(rule)

    def membrane_energy(self) -> StrainEnergy:
        """Membrane energy, with the rule that `membrane` names."""
        rule = square(lobatto3() if self.membrane == "lobatto" else gauss(4))
        energy = self._strain_energy(rule, Membrane(), self.thickness)
        if self.membrane != "projected":
            return energy
        Pi = projection()
        delta = np.minimum(1, (self.thickness / self._larger_side()) ** 2)
        weight = (1 - delta) * Pi.T @ energy.weight @ Pi + delta * energy.weight
        return StrainEnergy(energy.table, energy.measure, weight, energy.reference)

    def bending_energy(self) -> StrainEnergy:
        """Bending energy."""
        rule = square(gauss(2 if self.membrane == "lobatto" else 3))
        measure = Curvature(AREA_POWER[self.curvature], self._area(rule))
        return self._strain_energy(rule, measure, self.thickness**3 / 12)

    def _strain_energy(self, rule: Rule, measure: StrainMeasure, stiffness: float) -> StrainEnergy:
        """Sample at the points of a rule, with the weight stiffness * D sqrt(det A) dx dy, full quadrature."""
        g = self._reference_vectors(rule)
        blocks = stiffness * self.area_weights(rule)[..., None, None] * plane_stress(self.material, g)
        elements, samples = blocks.shape[:2]
        weight = einsum("escd,st->esctd", blocks, np.eye(samples)).reshape(elements, 3 * samples, 3 * samples)
        reference = measure.value(g).reshape(elements, -1)
        return StrainEnergy(self._table(rule), measure, weight, reference)

    def _table(self, rule: Rule) -> FloatArray:
        """Tables of the gradient vectors r_x, r_y, r_xx, r_yy, r_xy."""
        return THIN36.table(rule.points, self.l, self.w)[:, 1:]

    def _reference_vectors(self, rule: Rule) -> FloatArray:
        return einsum("sva,eai->esvi", self._table(rule), self.reference)

    def _area(self, rule: Rule) -> FloatArray:
        """|N| = |R_x x R_y| = sqrt(det A), shape (elements, samples)."""
        return np.asarray(np.linalg.norm(normal(self._reference_vectors(rule)), axis=-1))

    def _larger_side(self) -> FloatArray:
        """Larger side of each element, as a chord between reference nodes, m, shape (elements, 1, 1)."""
        r = self.reference[:, ::3]
        sides: FloatArray = np.linalg.norm(r - np.roll(r, 1, axis=1), axis=-1)
        return np.asarray(sides.max(axis=1)[:, None, None])


def plane_stress(material: Material, g: FloatArray) -> FloatArray:
    """Plane-stress stiffness D in the parameters of the reference surface, Pa, shape (..., 3, 3).

    The tensor E/(1 - nu**2) (nu A^ab A^cd + (1 - nu)/2 (A^ac A^bd + A^ad A^bc)) with A^ab the inverse metric of the
    reference vectors g: D of an orthonormal frame, transformed to (R_x, R_y); Dufva and Shabana (2005), (33), (34).
    """
    R = g[..., :2, :]
    A = np.linalg.inv(R @ np.swapaxes(R, -1, -2))
    nu = material.nu
    product = einsum("...ab,...cd->...abcd", A, A)
    exchange = einsum("...ac,...bd->...abcd", A, A) + einsum("...ad,...bc->...abcd", A, A)
    tensor = material.E / (1 - nu**2) * (nu * product + (1 - nu) / 2 * exchange)
    a, b = np.array([0, 1, 0]), np.array([0, 1, 1])
    return np.asarray(tensor[..., a[:, None], b[:, None], a, b])


def projection() -> FloatArray:
    """L2 projection of the membrane strain, in the element's parameters, at the 4x4 Gauss points, shape (48, 48).

    E_xx on P1(x) P3(y), E_yy on P3(x) P1(y), E_xy on P1(x) P1(y); rank 20.
    """
    rule = square(gauss(4))
    samples = len(rule.weights)
    Pi = np.zeros((samples, 3, samples, 3))
    for component, (p, q) in enumerate([(1, 3), (3, 1), (1, 1)]):
        basis = np.polynomial.legendre.legvander2d(2 * rule.points[:, 0] - 1, 2 * rule.points[:, 1] - 1, [p, q])
        moments = basis.T * rule.weights
        Pi[:, component, :, component] = basis @ np.linalg.solve(moments @ basis, moments)
    return Pi.reshape(3 * samples, 3 * samples)
