"""Motion: generalised-alpha with averaged forces, HHT-alpha and Newmark as special cases, fixed steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from .arrays import FloatArray, IndexArray, einsum
from .model import Model
from .newton import NewtonOptions, solve


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Parameters of M[(1 - am) a1 + am a0] + (1 - af) F1 + af F0 = 0, F = Q_k - Q_e, 0 and 1 the ends of a step.

    Positions and velocities follow Newmark's formulas with beta and gamma.
    """

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float

    @classmethod
    def hht(cls, alpha: float) -> Self:
        """HHT-alpha with alpha in [-1/3, 0]; Hilber, Hughes and Taylor (1977). 0 is the trapezoidal rule."""
        return cls(0.0, -alpha, (1 - alpha) ** 2 / 4, 0.5 - alpha)

    @classmethod
    def generalized_alpha(cls, rho_inf: float) -> Self:
        """Generalised-alpha with the spectral radius rho_inf in [0, 1] at infinity; Chung and Hulbert (1993)."""
        alpha_m = (2 * rho_inf - 1) / (rho_inf + 1)
        alpha_f = rho_inf / (rho_inf + 1)
        return cls(alpha_m, alpha_f, (1 - alpha_m + alpha_f) ** 2 / 4, 0.5 - alpha_m + alpha_f)


class State(NamedTuple):
    """Time t, nodal coordinates q, velocities v, accelerations a and forces F = Q_k - Q_e, each (n,)."""

    t: float
    q: FloatArray
    v: FloatArray
    a: FloatArray
    F: FloatArray


@dataclass(frozen=True)
class Motion:
    """Every step of a motion: t (states,); q, v, a (states, n); Newton iterations (steps,)."""

    t: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    iterations: IndexArray

    def energies(self, model: Model) -> dict[str, FloatArray]:
        """Kinetic, membrane and bending energy and the work done by the loads, J, each (states,).

        The work takes the mean force over a step: exact for constant dead loads, of second order for others.
        """
        forces = np.array([model.external_force(q, t) for q, t in zip(self.q, self.t, strict=True)])
        work = einsum("kn,kn->k", (forces[1:] + forces[:-1]) / 2, np.diff(self.q, axis=0))
        membrane, bending = np.array([model.energy(q) for q in self.q]).T
        kinetic = np.array([v @ (model.mass @ v) / 2 for v in self.v])
        loads = np.concatenate([[0.0], np.cumsum(work)])
        return {"kinetic": kinetic, "membrane": membrane, "bending": bending, "loads": loads}


def simulate(
    model: Model,
    until: float,
    step: float,
    method: GeneralizedAlpha,
    *,
    velocity: FloatArray | None = None,
    options: NewtonOptions | None = None,
) -> Motion:
    """Integrate M q'' + Q_k(q) = Q_e(q, t) from the reference configuration; Dufva and Shabana (2005), (37).

    Each step starts Newton's method from its first state, whose stress is true, not from a prediction.

    Parameters
    ----------
    model : Model
    until, step : float
        End of the motion and step, s; `until` is rounded to a whole number of steps.
    method : GeneralizedAlpha
    velocity : ndarray, shape (n,), optional
        Velocity at t = 0; rest if not given. Must vanish on fixed coordinates.
    options : NewtonOptions, optional

    Raises
    ------
    NewtonError
        If a step has no solution.
    """
    t: FloatArray = step * np.arange(round(until / step) + 1, dtype=np.float64)
    v = np.zeros(model.coordinates) if velocity is None else velocity
    state = _initial(model, v)
    states, iterations = [state], []
    for end in t[1:]:
        state, count = _advance(model, method, state, end, options or NewtonOptions())
        states.append(state)
        iterations.append(count)
    q, v, a = (np.array([state[k] for state in states]) for k in (1, 2, 3))
    return Motion(t, q, v, a, np.array(iterations, dtype=np.intp))


def _initial(model: Model, v: FloatArray) -> State:
    """Compute the consistent acceleration of the reference configuration, M a = -F."""
    q, free = model.reference, model.free
    F = model.internal_force(q) - model.external_force(q, 0.0)
    # Fixed coordinates leave the system before it is solved: their reactions must not reach the accelerations.
    a = np.zeros_like(q)
    a[free] = splu(model.mass[free][:, free]).solve(-F[free])
    return State(0.0, q, v, a, F)


def _advance(
    model: Model, method: GeneralizedAlpha, start: State, t: float, options: NewtonOptions
) -> tuple[State, int]:
    """Make one step to the time t; return its end and the number of Newton iterations."""
    am, af, beta, gamma = method.alpha_m, method.alpha_f, method.beta, method.gamma
    h = t - start.t
    M = model.mass

    def acceleration(q: FloatArray) -> FloatArray:
        return (q - start.q - h * start.v) / (beta * h**2) - (1 / (2 * beta) - 1) * start.a

    def force(q: FloatArray) -> FloatArray:
        return model.internal_force(q) - model.external_force(q, t)

    def residual(q: FloatArray) -> FloatArray:
        inertia: FloatArray = M @ ((1 - am) * acceleration(q) + am * start.a)
        return inertia + (1 - af) * force(q) + af * start.F

    def tangent(q: FloatArray, stress: Sequence[FloatArray]) -> sp.csc_array:
        K = model.tangent(q, stress) - model.load_stiffness(q, t)
        total: sp.csc_array = (1 - am) / (beta * h**2) * M + (1 - af) * K
        return total

    q, iterations = solve(model, start.q, residual, tangent, options)
    a = acceleration(q)
    v = start.v + h * ((1 - gamma) * start.a + gamma * a)
    return State(t, q, v, a, force(q)), iterations
