"""Motion in fixed steps: M q'' + F(q, t) = 0 with F = Q_k - Q_e; the methods are in `integrators`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from .arrays import FloatArray, IndexArray, einsum
from .model import Model
from .newton import NewtonOptions, Residual, Tangent, solve


class State(NamedTuple):
    """Time t, nodal coordinates q, velocities v, accelerations a and forces F = Q_k - Q_e, each (n,)."""

    t: float
    q: FloatArray
    v: FloatArray
    a: FloatArray
    F: FloatArray


class Equations:
    """The equations of motion of a model.

    Parameters
    ----------
    model : Model
    options : NewtonOptions
    """

    def __init__(self, model: Model, options: NewtonOptions) -> None:
        self.model = model
        self.options = options
        self._mass = splu(model.mass[model.free][:, model.free])

    def force(self, q: FloatArray, t: float) -> FloatArray:
        """F = Q_k - Q_e, shape (n,)."""
        return self.model.internal_force(q) - self.model.external_force(q, t)

    def at(self, t: float, q: FloatArray, v: FloatArray) -> State:
        """Return a state with the accelerations of the equations of motion."""
        F, free = self.force(q, t), self.model.free
        # Fixed coordinates leave the system before it is solved: their reactions must not reach the accelerations.
        a = np.zeros_like(q)
        a[free] = self._mass.solve(-F[free])
        return State(t, q, v, a, F)

    def solve(self, residual: Residual, tangent: Tangent, q: FloatArray) -> tuple[FloatArray, int]:
        """Solve for the coordinates at the end of a stage, beginning with q; return also the iterations."""
        return solve(self.model, q, residual, tangent, self.options)

    def stiffness(self, q: FloatArray, t: float, stress: Sequence[FloatArray]) -> sp.csc_array:
        """dF/dq with the given stress in its geometric part, shape (n, n)."""
        K: sp.csc_array = self.model.tangent(q, stress) - self.model.load_stiffness(q, t)
        return K


class Method(Protocol):
    """A way to make a step."""

    def advance(self, equations: Equations, start: State, t: float) -> tuple[State, int]:
        """Make one step to the time t; return its end and the number of Newton iterations."""
        ...


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
    method: Method,
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
    method : Method
        One of `integrators`.
    velocity : ndarray, shape (n,), optional
        Velocity at t = 0; rest if not given. Must vanish on fixed coordinates.
    options : NewtonOptions, optional

    Raises
    ------
    NewtonError
        If a step has no solution.
    """
    t: FloatArray = step * np.arange(round(until / step) + 1, dtype=np.float64)
    equations = Equations(model, options or NewtonOptions())
    v = np.zeros(model.coordinates) if velocity is None else velocity
    states, iterations = [equations.at(0.0, model.reference, v)], []
    for end in t[1:]:
        state, count = method.advance(equations, states[-1], end)
        states.append(state)
        iterations.append(count)
    q, v, a = (np.array([state[k] for state in states]) for k in (1, 2, 3))
    return Motion(t, q, v, a, np.array(iterations, dtype=np.intp))
