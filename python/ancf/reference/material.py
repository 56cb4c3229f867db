"""Isotropic elastic material in the parameters of a surface or a solid."""

from dataclasses import dataclass

import numpy as np

from .arrays import FloatArray, IndexArray, einsum


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material: Young's modulus E in Pa, Poisson's ratio nu, density in kg/m3."""

    E: float
    nu: float
    density: float

    def plane_stress(self) -> tuple[float, float]:
        """Lame's constants of plane stress, Pa: nu E / (1 - nu**2) and the shear modulus."""
        return self.nu * self.E / (1 - self.nu**2), self._shear()

    def solid(self) -> tuple[float, float]:
        """Lame's constants, Pa: nu E / ((1 + nu) (1 - 2 nu)) and the shear modulus."""
        return self.nu * self.E / ((1 + self.nu) * (1 - 2 * self.nu)), self._shear()

    def _shear(self) -> float:
        return self.E / (2 * (1 + self.nu))


def stiffness(lame: tuple[float, float], R: FloatArray, pairs: IndexArray) -> FloatArray:
    """Stiffness for strains with doubled shear in the parameters of the reference, Pa, shape (..., c, c).

    The tensor lambda A^ab A^cd + mu (A^ac A^bd + A^ad A^bc), A^ab the inverse metric of the reference vectors R of
    shape (..., d, 3): Hooke's law of an orthonormal frame transformed to them; Dufva and Shabana (2005), (33), (34).
    `pairs` are the indices a, b of the components.
    """
    A = np.linalg.inv(R @ np.swapaxes(R, -1, -2))
    volumetric = einsum("...ab,...cd->...abcd", A, A)
    deviatoric = einsum("...ac,...bd->...abcd", A, A) + einsum("...ad,...bc->...abcd", A, A)
    tensor = lame[0] * volumetric + lame[1] * deviatoric
    a, b = pairs.T
    return np.asarray(tensor[..., a[:, None], b[:, None], a, b])
