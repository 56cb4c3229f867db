"""The elastic energy of a block of elements, U = 1/2 (eps - eps_0)^T W (eps - eps_0).

Everything an element computes follows from its shape tables, its strain measure and its weight W. Axes: e element,
s sample, c strain component, v gradient vector, a, b nodal vector, i, j direction in space; m counts (s, c).
"""

from dataclasses import dataclass

import numpy as np

from .arrays import FloatArray, einsum
from .strain import StrainMeasure


@dataclass(frozen=True)
class StrainEnergy:
    """Strain samples of a block of elements with equal shape tables.

    Attributes
    ----------
    table : ndarray, shape (s, v, a)
        The gradient vectors at the samples are table @ e.
    measure : StrainMeasure
    weight : ndarray, shape (e, m, m)
        W: symmetric, positive semidefinite; material, quadrature and projection in one.
    reference : ndarray, shape (e, m)
        eps_0, the strain of the reference configuration.
    """

    table: FloatArray
    measure: StrainMeasure
    weight: FloatArray
    reference: FloatArray

    def strain(self, e: FloatArray) -> FloatArray:
        """Strain eps - eps_0, shape (e, m), for nodal coordinates e of shape (e, a, 3)."""
        return self.measure.value(self._vectors(e)).reshape(len(e), -1) - self.reference

    def gradient(self, e: FloatArray) -> FloatArray:
        """B = d eps / de, shape (e, m, a, 3)."""
        local = self.measure.gradient(self._vectors(e))
        B = local.reshape(*local.shape[:3], -1) @ self._vector_gradient()
        return B.reshape(len(e), -1, *e.shape[1:])

    def stress(self, e: FloatArray) -> FloatArray:
        """S = W (eps - eps_0), shape (e, m)."""
        return self._weighted(self.strain(e))

    def extrapolated_stress(self, e: FloatArray, de: FloatArray) -> FloatArray:
        """W (eps(e) + B(e) de - eps_0), shape (e, m); Magisano, Leonetti and Garcea (2017)."""
        return self._weighted(self.strain(e) + einsum("emai,eai->em", self.gradient(e), de))

    def energy(self, e: FloatArray) -> FloatArray:
        """Energy of each element, J, shape (e,)."""
        return einsum("em,em->e", self.strain(e), self.stress(e)) / 2

    def force(self, e: FloatArray, stress: FloatArray | None = None) -> FloatArray:
        """Elastic force Q_k = B^T S, shape (e, a, 3); Dufva and Shabana (2005), (25), (35).

        S is `stress`, of shape (e, m), when it is given in place of the true one.
        """
        return einsum("emai,em->eai", self.gradient(e), self.stress(e) if stress is None else stress)

    def tangent(self, e: FloatArray, stress: FloatArray | None = None) -> FloatArray:
        """Tangent B^T W B + sum_m S_m d2 eps_m / de2, shape (e, a, 3, b, 3).

        The geometric part takes `stress`, of shape (e, m), when it is given in place of the true one.
        """
        S = self.stress(e) if stress is None else stress
        B = self.gradient(e).reshape(*S.shape, -1)
        material = np.swapaxes(B, 1, 2) @ self.weight @ B
        hessian = self.measure.hessian(self._vectors(e))
        local = einsum("esc,escviuj->esviuj", S.reshape(hessian.shape[:3]), hessian)
        dg = self._vector_gradient()
        samples, vectors, nodal = dg.shape
        local = local.reshape(len(e), samples, vectors, vectors) @ dg
        geometric = dg.reshape(-1, nodal).T @ local.reshape(len(e), -1, nodal)
        return (material + geometric).reshape(*e.shape, *e.shape[1:])

    def _vectors(self, e: FloatArray) -> FloatArray:
        """Gradient vectors at the samples, shape (e, s, v, 3)."""
        return einsum("sva,eai->esvi", self.table, e)

    def _vector_gradient(self) -> FloatArray:
        """Differentiate the gradient vectors with respect to e, shape (s, v * 3, a * 3)."""
        return np.asarray(np.kron(self.table, np.eye(3)), dtype=np.float64)

    def _weighted(self, strain: FloatArray) -> FloatArray:
        return einsum("emn,en->em", self.weight, strain)
