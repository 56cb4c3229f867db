"""Fully parametrised elements: a middle surface with a vector through the thickness, the strain of a solid."""

from dataclasses import dataclass

import numpy as np

from .arrays import FloatArray, einsum
from .element import Element
from .energy import StrainEnergy
from .quadrature import Rule, gauss, product
from .shape import BILINEAR
from .strain import SOLID


@dataclass(frozen=True)
class Solid(Element):
    """`full48a` (S_A) and `full48b` (S_B): r = r_middle(x, y) + z r_z(x, y); Mikkola and Shabana (2003).

    The middle surface takes the functions of `shape` for r, r_x, r_y, without those of the twist; r_z is bilinear.
    """

    def table(self, points: FloatArray) -> FloatArray:
        """N, N_x, N_y, N_xx, N_yy, N_xy on the middle surface, shape (p, 6, 16)."""
        return self._table(points, np.zeros(len(points)))

    def director(self, edge: str, points: FloatArray) -> FloatArray:
        """Table of r_z, shape (p, 16): tractions that are linear over the thickness do work on it alone."""
        return self.nodal_values(3, points)

    def mass_points(self) -> tuple[FloatArray, FloatArray]:
        """Table N of shape (s, 16) at quadrature points, and the mass rho dV there, kg, shape (elements, s)."""
        rule = product(gauss(5), gauss(5), gauss(3))
        return self._table(rule.points[:, :2], self._height(rule))[:, 0], self.material.density * self._volume(rule)

    def energies(self) -> tuple[StrainEnergy, ...]:
        """Energy of St. Venant and Kirchhoff, Dufva and Shabana (2005), (13), (25)."""
        rule = self._rule()
        return (self.sampled(self._gradients(rule), SOLID, SOLID, self.material.solid(), self._volume(rule)),)

    def split(self, energies: tuple[StrainEnergy, ...], e: FloatArray) -> tuple[float, float]:
        """Membrane and bending energy, J: bending is that of the part of the strain that is odd in z."""
        (energy,) = energies
        upper = self._height(self._rule()) > 0
        strain = energy.strain(e).reshape(len(e), len(upper), -1)
        odd = (strain[:, upper] - strain[:, ~upper]) / 2
        part = np.zeros_like(strain)
        part[:, upper], part[:, ~upper] = odd, -odd
        m = part.reshape(len(e), -1)
        bending = float(einsum("em,emn,en->", m, energy.weight, m, optimize=True)) / 2
        return float(energy.energy(e).sum()) - bending, bending

    def _rule(self) -> Rule:
        """Points of the strain: two layers, the places in the plane in the same order."""
        return product(gauss(4), gauss(4), gauss(2))

    def _height(self, rule: Rule) -> FloatArray:
        """Return z in [-h/2, h/2] at the points of a rule."""
        return np.asarray(self.thickness * (rule.points[:, 2] - 0.5))

    def _table(self, points: FloatArray, z: FloatArray) -> FloatArray:
        """N, N_x, N_y, N_xx, N_yy, N_xy at the height z, shape (p, 6, 16)."""
        middle = self.shape.table(points, self.l, self.w).reshape(len(points), 6, 4, -1)[..., :3]
        across = z[:, None, None, None] * BILINEAR.table(points, self.l, self.w)[..., None]
        return np.concatenate([middle, across], axis=-1).reshape(len(points), 6, 16)

    def _gradients(self, rule: Rule) -> FloatArray:
        """Tables of r_x, r_y, r_z, shape (s, 3, 16)."""
        points = rule.points[:, :2]
        along = self._table(points, self._height(rule))[:, 1:3]
        return np.concatenate([along, self.nodal_values(3, points)[:, None]], axis=1)

    def _volume(self, rule: Rule) -> FloatArray:
        """Weights of a rule times the reference volume det(R_x, R_y, R_z) dx dy dz, m3, shape (elements, s)."""
        R = einsum("sva,eai->esvi", self._gradients(rule), self.reference)
        return np.asarray(self.thickness * self.quadrature_weights(rule) * np.linalg.det(R))
