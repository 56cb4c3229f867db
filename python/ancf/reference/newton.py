"""Newton's method for thin structures: plain, and with mixed integration points."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from .arrays import FloatArray
from .model import Model

NewtonKind: TypeAlias = Literal["mip", "plain"]
Residual: TypeAlias = Callable[[FloatArray], FloatArray]
Tangent: TypeAlias = Callable[[FloatArray, Sequence[FloatArray]], sp.csc_array]


class NewtonError(RuntimeError):
    """Newton's method found no solution."""


@dataclass(frozen=True)
class NewtonOptions:
    """How to iterate and when to stop.

    Attributes
    ----------
    kind : {"mip", "plain"}
        "mip": from the second iteration on, the geometric part of the tangent takes the stress extrapolated from the
        last iterate; Magisano, Leonetti and Garcea (2017). "plain": the true stress always.
    tolerance : float
        Of the correction relative to the size of the model, and of the energy |dq . r| relative to its first value.
    max_iterations : int
    """

    kind: NewtonKind = "mip"
    tolerance: float = 1e-8
    max_iterations: int = 50


def solve(
    model: Model, q: FloatArray, residual: Residual, tangent: Tangent, options: NewtonOptions
) -> tuple[FloatArray, int]:
    """Solve residual(q) = 0 for the free coordinates.

    Parameters
    ----------
    model : Model
    q : ndarray, shape (n,)
        Where to start; its fixed coordinates stay.
    residual : callable
        Of shape (n,).
    tangent : callable
        Derivative of the residual at q, with the given stress in its geometric part.
    options : NewtonOptions

    Returns
    -------
    q : ndarray, shape (n,)
    iterations : int

    Raises
    ------
    NewtonError
        If an iterate is not finite, or there are too many iterations.
    """
    free, scale = model.free, model.correction_scale
    stress = model.stress(q)
    first_energy = 0.0
    settled = False
    for iteration in range(1, options.max_iterations + 1):
        r = residual(q)[free]
        dq = np.zeros_like(q)
        dq[free] = -splu(tangent(q, stress)[free][:, free]).solve(r)
        if not np.isfinite(dq).all():
            raise NewtonError(f"the correction of iteration {iteration} is not finite")
        stress = model.extrapolated_stress(q, dq) if options.kind == "mip" else model.stress(q + dq)
        q = q + dq
        energy = abs(float(dq[free] @ r))
        first_energy = first_energy or energy
        small = bool(np.max(np.abs(dq) / scale) <= options.tolerance)
        # A start at the solution has nothing but rounding in its first energy: two small corrections will do.
        if small and (settled or energy <= options.tolerance * first_energy):
            return q, iteration
        settled = small
    raise NewtonError(f"no convergence in {options.max_iterations} iterations")
