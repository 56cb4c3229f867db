"""What an element is: shape functions, a strain measure and a weight W, over equal rectangles of parameters."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from .arrays import FloatArray, einsum
from .energy import StrainEnergy
from .material import Material, stiffness
from .quadrature import Rule
from .shape import BILINEAR, ShapeFunctions
from .strain import GreenLagrange, StrainMeasure


@dataclass(frozen=True)
class Element(ABC):
    """A block of elements of one type over equal rectangles of parameters.

    Attributes
    ----------
    shape : ShapeFunctions
        Of the (middle) surface.
    l, w : float
        Ranges of the parameters x and y in an element.
    reference : ndarray, shape (elements, a, 3)
        Nodal coordinates e_0 of the reference configuration: nodes A, B, C, D, vector after vector.
    thickness : float
        In m.
    material : Material
    """

    shape: ShapeFunctions
    l: float
    w: float
    reference: FloatArray
    thickness: float
    material: Material

    @abstractmethod
    def table(self, points: FloatArray) -> FloatArray:
        """N, N_x, N_y, N_xx, N_yy, N_xy on the (middle) surface at unit coordinates (p, 2), shape (p, 6, a)."""

    @abstractmethod
    def director(self, edge: str, points: FloatArray) -> FloatArray:
        """Table of the vector that a moment about an edge turns, at unit coordinates (p, 2) on it, shape (p, a)."""

    @abstractmethod
    def mass_points(self) -> tuple[FloatArray, FloatArray]:
        """Table N of shape (s, a) at quadrature points, and the mass there, kg, shape (elements, s)."""

    @abstractmethod
    def energies(self) -> tuple[StrainEnergy, ...]:
        """Return the elastic energies: membrane and bending, or the one of a solid."""

    def split(self, energies: tuple[StrainEnergy, ...], e: FloatArray) -> tuple[float, float]:
        """Membrane and bending energy, J, of `energies` for nodal coordinates e of shape (e, a, 3)."""
        membrane, bending = (float(energy.energy(e).sum()) for energy in energies)
        return membrane, bending

    def mass(self) -> FloatArray:
        """Mass of each element, int rho N_a N_b dV, kg, shape (elements, a, a).

        It multiplies the 3x3 identity; Dufva and Shabana (2005), (37), (38).
        """
        N, mass = self.mass_points()
        return einsum("es,sa,sb->eab", mass, N, N, optimize=True)

    def nodal_values(self, vector: int, points: FloatArray) -> FloatArray:
        """Table of one nodal vector interpolated bilinearly, shape (p, a); linearly along an edge."""
        table = np.zeros((len(points), *self.reference.shape[1:2]))
        table[:, vector :: self.reference.shape[1] // 4] = BILINEAR.table(points, self.l, self.w)[:, 0]
        return table

    def sampled(
        self,
        table: FloatArray,
        measure: StrainMeasure,
        metric: GreenLagrange,
        lame: tuple[float, float],
        weights: FloatArray,
    ) -> StrainEnergy:
        """Energy by full quadrature: at each sample W is the material's stiffness times a weight.

        Parameters
        ----------
        table : ndarray, shape (s, v, a)
            Gradient vectors at the samples; the first of them span the surface or the solid.
        measure : StrainMeasure
        metric : GreenLagrange
            Its pairs are those of the components of the measure.
        lame : pair of float
        weights : ndarray, shape (elements, s)
            Quadrature weights times area (or volume), times the thickness or h**3 / 12.
        """
        g = einsum("sva,eai->esvi", table, self.reference)
        dimension = metric.pairs.max() + 1
        blocks = weights[..., None, None] * stiffness(lame, g[..., :dimension, :], metric.pairs)
        elements, samples, components, _ = blocks.shape
        weight = einsum("escd,st->esctd", blocks, np.eye(samples))
        size = samples * components
        return StrainEnergy(
            table, measure, weight.reshape(elements, size, size), measure.value(g).reshape(elements, -1)
        )

    def quadrature_weights(self, rule: Rule) -> FloatArray:
        """Weights of a rule over the parameters, shape (s,)."""
        return self.l * self.w * rule.weights
