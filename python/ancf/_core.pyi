"""Type stubs of the compiled module: the mechanics in Rust.

Internal: users import `ancf`. Units are SI. `n` is the number of nodal coordinates of a model, body after body, node
after node (x fastest), vector after vector (r, r_x, r_y, ...), three components each.
"""

import os
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_FloatArray: TypeAlias = NDArray[np.float64]
_IndexArray: TypeAlias = NDArray[np.uint64]
_At: TypeAlias = str | tuple[float, float]
_History: TypeAlias = str | Sequence[tuple[float, float]]

__all__ = ["InputError", "Model", "Run", "Shape", "__version__", "curve", "info", "modes", "simulate", "solve_static"]

__version__: str

class InputError(ValueError):
    """A value that cannot be used. `argument` names it, `value` shows it, `allowed` says what would do."""

    argument: str
    value: str
    allowed: str

@final
class Shape:
    """A reference surface over two natural coordinates."""

    @staticmethod
    def rectangle(size: tuple[float, float]) -> Shape: ...
    @staticmethod
    def annulus(radii: tuple[float, float], angle: float) -> Shape: ...
    @staticmethod
    def cylinder(radius: float, angle: tuple[float, float], length: tuple[float, float]) -> Shape: ...
    @staticmethod
    def sphere(radius: float, longitude: tuple[float, float], latitude: tuple[float, float]) -> Shape: ...
    @staticmethod
    def nodes(
        domain: tuple[tuple[float, float], tuple[float, float]], divisions: tuple[int, int], points: _FloatArray
    ) -> Shape: ...  # points: (nodes, 12), r, r_x, r_y, r_xy of each node, x fastest

@final
class Model:
    """Bodies, supports and loads."""

    def __new__(cls) -> Model: ...
    def add_body(
        self,
        name: str,
        shape: Shape,
        divisions: tuple[int, int],
        *,
        thickness: float,
        E: float,
        nu: float,
        density: float,
        mass_damping: float,
        viscosity: float,
        element: str,
        membrane: str | None,
        curvature: str | None,
    ) -> None: ...
    def fix(self, body: str, at: _At, coordinates: Sequence[str]) -> None: ...
    def move_support(
        self,
        body: str,
        at: _At,
        coordinates: Sequence[str],  # empty: all
        *,
        translation: Sequence[tuple[float, float, float, float]] | None,  # rows t, x, y, z
        shake: tuple[tuple[float, float, float], float] | None,  # amplitude, m, and frequency, Hz
        rotation: tuple[tuple[float, float, float], tuple[float, float, float], Sequence[tuple[float, float]]]
        | None,  # a point of the axis, its direction, rows t, angle
    ) -> None: ...
    def add_gravity(self, acceleration: tuple[float, float, float], history: _History) -> None: ...
    def add_force(self, body: str, at: _At, force: tuple[float, float, float], history: _History) -> None: ...
    def add_line_load(self, body: str, at: _At, per_length: tuple[float, float, float], history: _History) -> None: ...
    def add_moment(self, body: str, at: _At, per_length: float, history: _History) -> None: ...
    def add_pressure(self, body: str, pressure: float, history: _History) -> None: ...
    @property
    def coordinates(self) -> int: ...  # all nodal coordinates, n
    @property
    def dofs(self) -> int: ...  # coordinates that are not fixed
    @property
    def elements(self) -> int: ...
    def reference(self) -> _FloatArray: ...  # (n,) nodal coordinates at rest
    def free(self) -> _IndexArray: ...  # (dofs,) indices of the coordinates that are not fixed
    def nodes(self, body: str) -> _FloatArray: ...  # (nodes, 2) natural coordinates
    def vectors(self, body: str) -> _IndexArray: ...  # (nodes, vectors) index of each nodal vector's first component
    def cells(self, body: str) -> _IndexArray: ...  # (elements, 4) node numbers A, B, C, D
    def domain(self, body: str) -> tuple[tuple[float, float], tuple[float, float]]: ...  # ranges of x and y
    def rigid_motions(self) -> list[tuple[str, str]]: ...  # body and motion, for each that no support holds
    def energy(self, q: _FloatArray) -> tuple[float, float]: ...  # membrane, bending, J
    def internal_force(self, q: _FloatArray) -> _FloatArray: ...  # (n,) Q_k
    def external_force(self, q: _FloatArray, t: float) -> _FloatArray: ...  # (n,) Q_e; t in s, or the load factor
    def tangent(
        self, q: _FloatArray, t: float = 0.0, previous: _FloatArray | None = None
    ) -> tuple[_IndexArray, _IndexArray, _FloatArray]: ...  # rows, columns, values of d(Q_k - Q_e)/dq, free coordinates
    def factorize(self) -> int: ...  # of the tangent that was made last: number of negative pivots
    def solve(self, right: _FloatArray) -> _FloatArray: ...  # (n,) with that factorisation, zero where fixed
    def mass(self) -> tuple[_IndexArray, _IndexArray, _FloatArray]: ...  # rows, cols, values over n coordinates
    def samples(self, body: str, of: str) -> _FloatArray: ...  # "membrane" | "bending": (elements, points, 2)
    def locate(self, body: str, points: _FloatArray) -> None: ...  # InputError if a point is outside the body
    def evaluate(
        self, body: str, points: _FloatArray, quantity: str, q: _FloatArray, v: _FloatArray | None = None
    ) -> _FloatArray: ...  # (states, points, components) for q, v of shape (states, n)

@final
class Run:
    """What a solve leaves: every output up to its end, and how it ended."""

    @property
    def status(self) -> str: ...  # "ok" | "failed" | "interrupted"
    @property
    def reason(self) -> str: ...
    @property
    def advice(self) -> str: ...
    @property
    def reached(self) -> float: ...  # s, or load factor
    @property
    def jumps(self) -> _FloatArray: ...  # load factors at which a structure in statics jumped
    @property
    def t(self) -> _FloatArray: ...  # (states,)
    @property
    def q(self) -> _FloatArray: ...  # (states, n)
    @property
    def v(self) -> _FloatArray: ...  # (states, n); zeros in statics
    @property
    def a(self) -> _FloatArray: ...  # (states, n); zeros in statics
    @property
    def energy(
        self,
    ) -> dict[
        str, _FloatArray
    ]: ...  # kinetic, membrane, bending, loads (their work), dissipated (by damping): (states,) J
    @property
    def momentum(self) -> _FloatArray: ...  # (states, 3) kg m/s
    @property
    def angular_momentum(self) -> _FloatArray: ...  # (states, 3) kg m2/s about the origin
    @property
    def reactions(self) -> _FloatArray: ...  # (states, supports, 9): point (m), force (N), moment about it (N m)
    @property
    def counts(self) -> dict[str, int]: ...  # of `Result.counts`
    @property
    def seconds(self) -> dict[str, float]: ...  # total, setup, assembly, factorization, solve
    @property
    def negative_pivots(
        self,
    ) -> NDArray[np.int64]: ...  # (states,) of the tangent at each state; -1 where it was not counted
    @property
    def unsaved(self) -> str | None: ...  # why the last checkpoint could not be written
    @property
    def exception(self) -> BaseException | None: ...  # what stopped an interrupted run

def solve_static(
    model: Model,
    *,
    load_factors: Sequence[float],
    path: str,  # "load" | "arc"
    newton: str,  # "mip" | "plain"
    tolerance: float,  # of the correction, relative to the size of the model
    max_iterations: int,
    first_step: float | None,  # load factor; None: up to the first load factor
    min_step: float,
    max_steps: int,  # of a path by arc length
    threads: int | None,
    progress: Callable[[float], Any] | None,  # called at most every 50 ms with the load factor reached
) -> Run: ...
def simulate(
    model: Model,
    *,
    until: float,
    # fixed: length (s), whether it may exceed the explicit limit; or rtol, atol, first, longest and shortest step
    steps: tuple[float, bool] | tuple[float, float, float | None, float | None, float],
    method: str,  # one of those of scene files
    alpha: float | None,
    rho_inf: float | None,
    lumped: bool,
    outputs: Sequence[float],
    velocity: _FloatArray | None,  # (n,) at t = 0; None: at rest
    newton: str,
    tolerance: float,
    max_iterations: int,
    reuse: bool,
    checkpoint: str | os.PathLike[str] | None,  # a file that is replaced about every second
    resume: str | os.PathLike[str] | None,  # such a file, to go on from
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> Run: ...
def modes(
    model: Model,
    *,
    count: int,
    q: _FloatArray,  # (n,) the state about which the model oscillates
    load_factor: float,  # of loads that follow the body
    threads: int | None,
    progress: Callable[[float], Any] | None,  # called with the number of modes found
) -> tuple[Run, _FloatArray, _FloatArray]: ...  # (modes,) eigenvalues, 1/s2; (modes, n) shapes, x . M x = 1
def curve(
    rows: _FloatArray,  # (rows, 2): t, value
    t: _FloatArray,  # (times,)
) -> _FloatArray: ...  # (times,) of the smooth curve on which supports move
def info() -> dict[str, str]: ...  # versions of ancf-core and faer, threads, CPU features, SIMD lanes
