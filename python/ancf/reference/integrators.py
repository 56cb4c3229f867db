"""Time integration: generalised-alpha with averaged forces, Runge-Kutta, energy-momentum, Stormer-Verlet."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy.sparse as sp
from scipy.integrate import RK45

from .arrays import FloatArray
from .dynamics import Equations, State

Rows = tuple[tuple[float, ...], ...]


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

    def advance(self, equations: Equations, start: State, t: float) -> tuple[State, int]:
        """Make one step to the time t; return its end and the number of Newton iterations."""
        am, af, beta, gamma = self.alpha_m, self.alpha_f, self.beta, self.gamma
        h, M = t - start.t, equations.model.mass

        def acceleration(q: FloatArray) -> FloatArray:
            return (q - start.q - h * start.v) / (beta * h**2) - (1 / (2 * beta) - 1) * start.a

        def residual(q: FloatArray) -> FloatArray:
            inertia: FloatArray = M @ ((1 - am) * acceleration(q) + am * start.a)
            return inertia + (1 - af) * equations.force(q, t) + af * start.F

        def tangent(q: FloatArray, stress: Sequence[FloatArray]) -> sp.csc_array:
            total: sp.csc_array = (1 - am) / (beta * h**2) * M + (1 - af) * equations.stiffness(q, t, stress)
            return total

        q, iterations = equations.solve(residual, tangent, start.q)
        a = acceleration(q)
        v = start.v + h * ((1 - gamma) * start.a + gamma * a)
        return State(t, q, v, a, equations.force(q, t)), iterations


@dataclass(frozen=True)
class RungeKutta:
    """Runge-Kutta for q' = v, v' = a(q, t): rows of coefficients up to the diagonal, the last are the weights.

    A diagonal entry g makes a stage implicit: without its velocity it reads M (Q - Q*) / (g h)**2 + F(Q) = 0.
    """

    rows: Rows

    @classmethod
    def tr_bdf2(cls) -> Self:
        """Trapezoidal rule to (2 - sqrt 2) h, then the second backward difference; Bank et al. (1985)."""
        w, d = 2**0.5 / 4, 1 - 2**0.5 / 2
        return cls(((0.0,), (d, d), (w, w, d)))

    @classmethod
    def esdirk(cls) -> Self:
        """ESDIRK4(3)6L[2]SA, implicit part; Kennedy and Carpenter (2003)."""
        return cls(
            (
                (0.0,),
                (1 / 4, 1 / 4),
                (8611 / 62500, -1743 / 31250, 1 / 4),
                (5012029 / 34652500, -654441 / 2922500, 174375 / 388108, 1 / 4),
                (
                    15267082809 / 155376265600,
                    -71443401 / 120774400,
                    730878875 / 902184768,
                    2285395 / 8070912,
                    1 / 4,
                ),
                (82889 / 524892, 0.0, 15625 / 83664, 69875 / 102672, -2260 / 8211, 1 / 4),
            )
        )

    @classmethod
    def dormand_prince(cls) -> Self:
        """Fifth order, explicit; Dormand and Prince (1980), with SciPy's coefficients."""
        rows = tuple((*(float(a) for a in row[:i]), 0.0) for i, row in enumerate(RK45.A))
        return cls((*rows, (*(float(b) for b in RK45.B), 0.0)))

    def advance(self, equations: Equations, start: State, t: float) -> tuple[State, int]:
        """Make one step to the time t; return its end and the number of Newton iterations."""
        h, M = t - start.t, equations.model.mass
        stages, iterations = [start], 0
        for row in self.rows[1:]:
            *known, diagonal = row
            at, g = start.t + sum(row) * h, diagonal * h
            v = start.v + h * sum(a * stage.a for a, stage in zip(known, stages, strict=True))
            q = start.q + h * sum(a * stage.v for a, stage in zip(known, stages, strict=True))
            if g == 0:
                stages.append(equations.at(at, q, v))
                continue
            origin = q + g * v

            def residual(Q: FloatArray, at: float = at, g: float = g, origin: FloatArray = origin) -> FloatArray:
                inertia: FloatArray = M @ ((Q - origin) / g**2)
                return inertia + equations.force(Q, at)

            def tangent(Q: FloatArray, stress: Sequence[FloatArray], at: float = at, g: float = g) -> sp.csc_array:
                total: sp.csc_array = M / g**2 + equations.stiffness(Q, at, stress)
                return total

            Q, count = equations.solve(residual, tangent, stages[-1].q)
            stages.append(State(at, Q, (Q - q) / g, (Q - origin) / g**2, equations.force(Q, at)))
            iterations += count
        return stages[-1]._replace(t=t), iterations


@dataclass(frozen=True)
class EnergyMomentum:
    """M (v1 - v0) / h + f - Q_e = 0 and q1 - q0 = h (v0 + v1) / 2, where f does the work U1 - U0.

    f = B.T (S + a W B dq) with B at the mean coordinates, S the mean stress and dq = q1 - q0; Simo and Tarnow (1994).
    The first part is all where strains are quadratic in q, the second, at most a quarter of what the stress gains,
    makes up for the rest; Laursen and Meng (2001).
    """

    def advance(self, equations: Equations, start: State, t: float) -> tuple[State, int]:
        """Make one step to the time t; return its end and the number of Newton iterations."""
        model, h = equations.model, t - start.t
        M, middle = model.mass, (t + start.t) / 2
        origin = start.q + h * start.v
        first_stress, first_energy = model.stress(start.q), sum(model.energy(start.q))

        def mean_stress(q: FloatArray) -> list[FloatArray]:
            return [(a + b) / 2 for a, b in zip(first_stress, model.stress(q), strict=True)]

        def force(q: FloatArray) -> FloatArray:
            mean, dq = (q + start.q) / 2, q - start.q
            f = model.internal_force(mean, mean_stress(q))
            changed = zip(model.extrapolated_stress(mean, dq), model.stress(mean), strict=True)
            g = model.internal_force(mean, [after - before for after, before in changed])
            missed = sum(model.energy(q)) - first_energy - f @ dq
            a = np.clip(missed / (g @ dq), -0.25, 0.25) if g @ dq else 0.0
            return f + a * g - model.external_force(mean, middle)

        def residual(q: FloatArray) -> FloatArray:
            inertia: FloatArray = M @ (2 / h**2 * (q - origin))
            return inertia + force(q)

        def tangent(q: FloatArray, _: Sequence[FloatArray]) -> sp.csc_array:
            # B at the mean coordinates stands for the one at the end, the price is linear convergence.
            K = equations.stiffness((q + start.q) / 2, middle, mean_stress(q))
            total: sp.csc_array = 2 / h**2 * M + K / 2
            return total

        q, iterations = equations.solve(residual, tangent, start.q)
        a = 2 / h**2 * (q - origin)
        return State(t, q, start.v + h * a, a, force(q)), iterations


@dataclass(frozen=True)
class Verlet:
    """Velocity Verlet with the mass matrix of the model: explicit; Hairer, Lubich and Wanner (2003)."""

    def advance(self, equations: Equations, start: State, t: float) -> tuple[State, int]:
        """Make one step to the time t; return its end and the number of Newton iterations, none."""
        h = t - start.t
        v = start.v + h / 2 * start.a
        end = equations.at(t, start.q + h * v, v)
        return end._replace(v=v + h / 2 * end.a), 0
