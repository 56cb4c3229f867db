"""Thin elements: membrane strain and curvature of a surface; Dufva and Shabana (2005), section 3."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from .arrays import FloatArray, einsum
from .element import Element
from .energy import StrainEnergy
from .quadrature import Rule, gauss, lobatto3, square
from .strain import MEMBRANE, Curvature, StrainMeasure, normal

MembraneRule: TypeAlias = Literal["full", "lobatto", "projected"]
CurvatureKind: TypeAlias = Literal["paper", "koiter"]

AREA_POWER: dict[CurvatureKind, int] = {"paper": 2, "koiter": 0}

Space: TypeAlias = list[tuple[int, int]]
"""Polynomials spanned by products of Legendre polynomials of these degrees in x and y."""


def degrees(p: int, q: int) -> Space:
    """P_p(x) P_q(y)."""
    return [(i, j) for i in range(p + 1) for j in range(q + 1)]


BILINEAR = (degrees(1, 1), degrees(1, 1), degrees(1, 1))
PROJECTED = (degrees(1, 3), degrees(3, 1), degrees(1, 1))
"""What is kept of E_xx, E_yy and E_xy: 20 of 48 dimensions, beside `SQUARES`."""

SQUARES = [(2, 0), (0, 2)]
"""What is kept of E_xy besides. Without it the lines across a strip of one element may bend to cubics for nothing, and
with them a strip is three times too soft in its plane."""


@dataclass(frozen=True)
class Thin(Element):
    """Thin elements: `thin36` with nodal vectors r, r_x, r_y, `thin48` with r_xy besides.

    Attributes
    ----------
    membrane : {"projected", "full", "lobatto"}
        Treatment of the membrane energy.
    curvature : {"paper", "koiter"}
        Power of the area stretch in the curvature.
    """

    membrane: MembraneRule = "projected"
    curvature: CurvatureKind = "paper"

    def table(self, points: FloatArray) -> FloatArray:
        """N, N_x, N_y, N_xx, N_yy, N_xy, shape (p, 6, a)."""
        return self.shape.table(points, self.l, self.w)

    def director(self, edge: str, points: FloatArray) -> FloatArray:
        """Table of the gradient across an edge, as the vectors at the edge's own nodes give it, shape (p, a).

        For bicubic functions this is r_x (or r_y) itself. That of the incomplete quartic depends on the far nodes,
        too: its part that is not linear along the edge is the same on both sides of an element, does no work on a
        constant moment inside and must do none outside, or plates under constant moments bend too far.
        """
        across = "xy".index(edge[0])
        return self.table(points)[:, 1 + across] if self._twist() else self.nodal_values(1 + across, points)

    def mass_points(self) -> tuple[FloatArray, FloatArray]:
        """Table N of shape (s, a) at quadrature points, and the mass rho h dA there, kg, shape (elements, s)."""
        rule = square(gauss(5))
        return self.table(rule.points)[:, 0], self.material.density * self.thickness * self.area_weights(rule)

    def energies(self) -> tuple[StrainEnergy, ...]:
        """Membrane and bending energy."""
        return self.membrane_energy(), self.bending_energy()

    def area_weights(self, rule: Rule) -> FloatArray:
        """Weights of a rule times the reference area sqrt(det A) dx dy, m2, shape (elements, samples)."""
        return self.quadrature_weights(rule) * self._area(rule)

    def membrane_energy(self) -> StrainEnergy:
        """Membrane energy, with the rule that `membrane` names."""
        rule = square(lobatto3() if self.membrane == "lobatto" else gauss(4))
        energy = self._strain_energy(rule, MEMBRANE, self.thickness)
        if self.membrane != "projected":
            return energy
        normal, *squares = np.sqrt(self._rough_shares())
        Pi = projection(BILINEAR) + normal * (projection(PROJECTED) - projection(BILINEAR))
        for power, share in zip(SQUARES, squares, strict=False):
            Pi = Pi + share * projection(([], [], [power]))
        own = self._sampled_part(energy.weight, normal**2)
        weight = Pi.swapaxes(1, 2) @ (energy.weight - own) @ Pi + own
        return StrainEnergy(energy.table, energy.measure, weight, energy.reference)

    def bending_energy(self) -> StrainEnergy:
        """Bending energy."""
        rule = square(gauss(2 if self.membrane == "lobatto" else 3))
        measure = Curvature(AREA_POWER[self.curvature], self._area(rule))
        return self._strain_energy(rule, measure, self.thickness**3 / 12)

    def _strain_energy(self, rule: Rule, measure: StrainMeasure, factor: float) -> StrainEnergy:
        """Sample at the points of a rule, with the weight factor * D sqrt(det A) dx dy."""
        weights = factor * self.area_weights(rule)
        table = self.table(rule.points)[:, 1:]
        return self.sampled(table, measure, MEMBRANE, self.material.plane_stress(), weights)

    def _area(self, rule: Rule) -> FloatArray:
        """|N| = |R_x x R_y| = sqrt(det A), shape (elements, samples)."""
        return np.asarray(np.linalg.norm(normal(self._reference_vectors(rule)), axis=-1))

    def _reference_vectors(self, rule: Rule) -> FloatArray:
        """R_x, R_y and the second derivatives, shape (elements, samples, 5, 3)."""
        return einsum("sva,eai->esvi", self.table(rule.points)[:, 1:], self.reference)

    def _sides(self) -> FloatArray:
        """Mean lengths of the element along x and along y, m, shape (2, elements, 1, 1)."""
        rule = square(gauss(5))
        lengths = np.linalg.norm(self._reference_vectors(rule)[..., :2, :], axis=-1)
        sides = einsum("s,esv->ev", rule.weights, lengths) * [self.l, self.w]
        return np.asarray(sides.T[..., None, None])

    def _rough_shares(self) -> FloatArray:
        """Shares of the energy of strains that are not bilinear, shape (3, elements, 1, 1).

        Of those in E_xx and E_yy, of the square of x and of that of y in E_xy: min(1, h^2 k^4 / (12 C)). Inextensional
        bending of a curved surface is out of the element's reach in these parts, for waves of the wave number k and
        more. With l the larger side, for the squares the side in their direction, k is 12^(1/4) / l for bicubic
        functions and 1 / l for the incomplete quartic. C is the mean Gaussian curvature abs(K) of the reference, for
        the squares at least that of the mean normal curvature in their direction, squared.
        """
        rule = square(gauss(3))
        vectors = self._reference_vectors(rule)
        n = normal(vectors)
        area = np.linalg.norm(n, axis=-1)[..., None]
        second = einsum("esvi,esi->esv", vectors[..., 2:, :], n) / area
        xx, yy, xy = np.moveaxis(second, -1, 0)
        gaussian = np.abs(((xx * yy - xy**2) / area[..., 0] ** 2) @ rule.weights)
        first = np.linalg.norm(vectors[..., :2, :], axis=-1) ** 2
        along = einsum("s,esv->ve", rule.weights, second[..., :2] / first)
        sides = self._sides()
        curvature = np.stack([gaussian, *np.maximum(gaussian, along**2)])[..., None, None]
        wave = (12 if self._twist() else 1) / np.stack([sides.max(axis=0), *sides]) ** 4
        with np.errstate(divide="ignore"):
            return np.asarray(np.minimum(1, self.thickness**2 / 12 * wave / curvature))

    def _sampled_part(self, weight: FloatArray, smooth: FloatArray) -> FloatArray:
        """Part of the weight W for the strain as it is, not projected, shape (elements, m, m).

        A share delta = min(1, (h / l)^2), l the larger side, of all. Besides, where lines along x are curved within the
        surface, a share of the stiffness that E_yy has where no stress holds the other components, and likewise of
        E_xx: (k w)^2, k the mean geodesic curvature of these lines, w the side across them, times the share `smooth` of
        what is not bilinear. Without it lines across a curved strip of one element may stretch to cubics for nothing,
        which takes part of the bending strain along the strip away.
        """
        sides = self._sides()
        delta = np.minimum(1, (self.thickness / sides.max(axis=0)) ** 2)
        rule = square(gauss(3))
        vectors = self._reference_vectors(rule)
        along, second = vectors[..., :2, :], vectors[..., 2:4, :]
        across = np.cross(normal(vectors)[..., None, :], along)
        curved = einsum("esvi,esvi->esv", second, across) / np.linalg.norm(across, axis=-1)
        geodesic = einsum("s,esv->ve", rule.weights, curved / np.linalg.norm(along, axis=-1) ** 2)
        share = np.zeros((*weight.shape[:1], weight.shape[1] // 3, 3))
        for component in range(2):
            bent = geodesic[1 - component, :, None, None] * sides[component]
            share[..., component] = np.minimum(1 - delta, smooth * bent**2)[..., 0]
        compliance = np.diagonal(np.linalg.inv(weight), axis1=1, axis2=2)
        own = share.reshape(compliance.shape) / compliance
        return np.asarray(delta * weight + own[:, :, None] * np.eye(weight.shape[1]))

    def _twist(self) -> bool:
        """Whether r_xy is a nodal vector: the functions are bicubic."""
        return bool((self.shape.vectors == 1).all(axis=1).any())


def projection(spaces: tuple[Space, Space, Space]) -> FloatArray:
    """L2 projection of the membrane strain, in the element's parameters, at the 4x4 Gauss points, shape (48, 48).

    E_xx, E_yy and E_xy each on its space.
    """
    rule = square(gauss(4))
    samples = len(rule.weights)
    Pi = np.zeros((samples, 3, samples, 3))
    x, y = 2 * rule.points.T - 1
    products = np.polynomial.legendre.legvander2d(x, y, [3, 3]).reshape(samples, 4, 4)
    for component, space in enumerate(spaces):
        basis = np.array([products[:, p, q] for p, q in space]).reshape(len(space), samples).T
        moments = basis.T * rule.weights
        Pi[:, component, :, component] = basis @ np.linalg.solve(moments @ basis, moments)
    return Pi.reshape(3 * samples, 3 * samples)
