"""An experiment: TR-BDF2 with the error control of MATLAB's ode23tb, which sees all coordinates and velocities.

`ancf` controls the error of positions. Whether that is why Model II does not get slower here is not to be guessed: this
integrator differs in nothing else that matters, and is written for the few coordinates of 2 x 2 elements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ancf import _core

FloatArray = npt.NDArray[np.float64]

_DIAGONAL = 1 - np.sqrt(0.5)
_W = np.sqrt(0.125)
_STAGES = ((_DIAGONAL,), (_W, _W))
"""Coefficients of the derivatives that a stage knows; that of its own is the diagonal."""
_ERROR = (_W - (1 - _W) / 3, _W - (3 * _W + 1) / 3, _DIAGONAL * 2 / 3)
"""Weights of the solution less those of the third-order one beside it."""
_ITERATIONS = 12
_CONVERGED = 1e-9
"""Largest last correction of a coordinate; the plate is 0.3 m wide, its gradients are 1."""
_SAFETY, _LEAST, _MOST, _CUT = 0.9, 0.2, 5.0, 0.25


@dataclass(frozen=True)
class Steps:
    """What a run took.

    Parameters
    ----------
    steps, rejected, iterations : int
        Steps that were accepted and others, Newton iterations of both.
    q : ndarray, shape (n,)
        Nodal coordinates at the end.
    """

    steps: int
    rejected: int
    iterations: int
    q: FloatArray


class _Equations:
    """The equations of motion of the coordinates that are not fixed, in full matrices."""

    def __init__(self, core: _core.Model) -> None:
        self.core = core
        self.free = core.free()
        self.start = core.reference()
        self.mass = self._dense(*core.mass())

    def _dense(self, rows: npt.NDArray[np.uintp], columns: npt.NDArray[np.uintp], values: FloatArray) -> FloatArray:
        matrix = np.zeros((self.start.size, self.start.size))
        np.add.at(matrix, (rows, columns), values)
        return matrix[np.ix_(self.free, self.free)]

    def all(self, q: FloatArray) -> FloatArray:
        """Return all coordinates, the fixed ones included."""
        full = self.start.copy()
        full[self.free] = q
        return full

    def force(self, q: FloatArray) -> FloatArray:
        """Return external less internal forces."""
        full = self.all(q)
        return (self.core.external_force(full, 0.0) - self.core.internal_force(full))[self.free]

    def tangent(self, q: FloatArray) -> FloatArray:
        """Return the stiffness."""
        return self._dense(*self.core.tangent(self.all(q)))

    def stage(self, known: FloatArray, guess: FloatArray, length: float, inverse: FloatArray) -> tuple[FloatArray, int]:
        """Solve ``y = known + length y'`` for positions and velocities; the derivative, and iterations or 0 if none."""
        n = self.free.size
        q, last = guess[:n].copy(), np.inf
        for iteration in range(1, _ITERATIONS + 1):
            inertia = self.mass @ (q - known[:n] - length * known[n:])
            correction = inverse @ (length**2 * self.force(q) - inertia)
            q += correction
            size = float(np.abs(correction).max())
            if size < _CONVERGED:
                v = (q - known[:n]) / length
                return np.concatenate([v, (v - known[n:]) / length]), iteration
            if iteration > 3 and size > 0.9 * last:
                break
            last = size
        return np.empty(0), 0


def integrate(core: _core.Model, until: float, rtol: float) -> Steps:
    """Move a body from rest under constant loads.

    Parameters
    ----------
    core : ancf._core.Model
        The body.
    until : float
        The end, s.
    rtol : float
        The error of a step that is allowed, relative to each coordinate and each velocity, or to 1e-3 where that is
        more: MATLAB's defaults are rtol = 1e-3 and 1e-6 for the absolute tolerance.

    Returns
    -------
    Steps
        What it took.

    Notes
    -----
    M. E. Hosea and L. F. Shampine, Analysis and implementation of TR-BDF2, Applied Numerical Mathematics 20 (1996)
    21-37; the error estimate is theirs, without the filter that takes out what is stiff.
    """
    equations = _Equations(core)
    n = equations.free.size
    y = np.concatenate([equations.start[equations.free], np.zeros(n)])
    slope = np.concatenate([np.zeros(n), np.linalg.solve(equations.mass, equations.force(y[:n]))])
    t, step = 0.0, 1e-4
    steps = rejected = iterations = 0
    while t < until * (1 - 1e-12):
        step = min(step, until - t)
        length = _DIAGONAL * step
        inverse = np.linalg.inv(equations.mass + length**2 * equations.tangent(y[:n]))
        slopes, end = [slope], y
        for weights in _STAGES:
            known = y + step * sum(w * s for w, s in zip(weights, slopes, strict=True))
            made, took = equations.stage(known, end + length * slopes[-1], length, inverse)
            if not took:
                break
            iterations += took
            slopes.append(made)
            end = known + length * made
        if len(slopes) <= len(_STAGES):
            step *= _CUT
            rejected += 1
            continue
        difference = step * sum(w * s for w, s in zip(_ERROR, slopes, strict=True))
        size = np.maximum(np.maximum(np.abs(y), np.abs(end)), 1e-3)
        error = max(float(np.abs(difference / size).max()) / rtol, 1e-6)
        factor = min(max(_SAFETY * error ** (-1 / 3), _LEAST), _MOST)
        if error <= 1:
            t, y, slope = t + step, end, slopes[-1]
            steps += 1
        else:
            rejected += 1
        step *= factor
    return Steps(steps, rejected, iterations, equations.all(y[:n]))
