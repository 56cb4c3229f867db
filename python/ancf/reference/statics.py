"""Equilibrium at given load factors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from .arrays import FloatArray, IndexArray
from .model import Model
from .newton import NewtonOptions, solve


@dataclass(frozen=True)
class StaticResult:
    """Equilibria: load factors (states,), nodal coordinates q (states, n), Newton iterations (states,)."""

    load_factors: FloatArray
    q: FloatArray
    iterations: IndexArray


def solve_static(
    model: Model, load_factors: Sequence[float], options: NewtonOptions | None = None, start: FloatArray | None = None
) -> StaticResult:
    """Solve Q_k(q) = Q_e(q, load factor), each step from the solution of the last.

    Parameters
    ----------
    model : Model
        Its loads take the load factor for t: give what shall grow with it the history "ramp".
    load_factors : sequence of float
    options : NewtonOptions, optional
    start : ndarray, shape (n,), optional
        Where the first step starts; the reference configuration if not given.

    Raises
    ------
    NewtonError
        If a step has no solution.
    """
    q = model.reference if start is None else start
    states, iterations = [], []
    for factor in load_factors:
        q, count = _equilibrium(model, q, factor, options or NewtonOptions())
        states.append(q)
        iterations.append(count)
    return StaticResult(np.array(load_factors, dtype=np.float64), np.array(states), np.array(iterations, dtype=np.intp))


def _equilibrium(model: Model, start: FloatArray, factor: float, options: NewtonOptions) -> tuple[FloatArray, int]:
    def residual(q: FloatArray) -> FloatArray:
        return model.internal_force(q) - model.external_force(q, factor)

    def tangent(q: FloatArray, stress: Sequence[FloatArray]) -> sp.csc_array:
        K: sp.csc_array = model.tangent(q, stress) - model.load_stiffness(q, factor)
        return K

    return solve(model, start, residual, tangent, options)


def negative_eigenvalues(model: Model, q: FloatArray, t: float) -> int:
    """Count negative eigenvalues of the tangent on the free coordinates; none where an equilibrium is stable."""
    free = model.free
    K = (model.tangent(q) - model.load_stiffness(q, t))[free][:, free].toarray()
    return int(np.sum(np.linalg.eigvalsh(K) < 0))
