"""A plate or shell of `thin36` elements with supports and loads: the global system."""

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike

from .arrays import FloatArray, IndexArray, einsum
from .loads import Density, History, Load, dead, edge_moment, pressure
from .mesh import At, Points, RectangleMesh
from .quadrature import gauss, square
from .shape import THIN36
from .thin36 import CurvatureKind, Material, MembraneRule, Thin36

VECTORS = ("r", "r_x", "r_y")
DIRECTIONS = ("x", "y", "z")


class Model:
    """One body with its supports and loads.

    Nodal coordinates are numbered node after node, vector after vector (r, r_x, r_y), three components each; n is
    their number.

    Parameters
    ----------
    mesh : RectangleMesh
        Elements over the natural coordinates.
    thickness : float
        In m.
    E, nu, density : float
        Young's modulus in Pa, Poisson's ratio, density in kg/m3.
    membrane : {"projected", "full", "lobatto"}
    curvature : {"paper", "koiter"}
    reference : ndarray, shape (n,), optional
        Nodal coordinates of the reference configuration; a flat rectangle in the X-Y plane if not given.
    """

    def __init__(
        self,
        mesh: RectangleMesh,
        *,
        thickness: float,
        E: float,
        nu: float,
        density: float,
        membrane: MembraneRule = "projected",
        curvature: CurvatureKind = "paper",
        reference: FloatArray | None = None,
    ) -> None:
        self.mesh = mesh
        self.reference = _flat(mesh) if reference is None else reference
        nodal = 9 * mesh.cells[:, :, None] + np.arange(9)
        self._index: IndexArray = nodal.reshape(len(mesh.cells), 12, 3)
        l, w = mesh.sides
        e_0 = self._local(self.reference)
        self.element = Thin36(l, w, e_0, thickness, Material(E, nu, density), membrane, curvature)
        self._energies = (self.element.membrane_energy(), self.element.bending_energy())
        self.mass = self._assemble_matrix(self._index, einsum("eab,ij->eaibj", self.element.mass(), np.eye(3)))
        self._fixed = np.zeros(self.coordinates, dtype=np.bool_)
        self._loads: list[Load] = []

    @property
    def coordinates(self) -> int:
        """Number of nodal coordinates, n."""
        return len(self.reference)

    @property
    def free(self) -> IndexArray:
        """Indices of the coordinates that are not fixed."""
        return np.flatnonzero(~self._fixed)

    @property
    def correction_scale(self) -> FloatArray:
        """What a correction is compared with: the largest extent of the body for r, 1 for gradients, shape (n,)."""
        scale = np.ones((len(self.mesh.nodes), 3, 3))
        scale[:, 0] = np.ptp(self.reference.reshape(-1, 3, 3)[:, 0], axis=0).max()
        return scale.ravel()

    def fix(self, at: At, coordinates: Sequence[str]) -> None:
        """Fix vectors ("r", "r_x", "r_y") or components ("r.x", "r_y.z", ...) of the nodes at a place."""
        fixed = self._fixed.reshape(-1, 3, 3)
        for name in coordinates:
            vector, _, direction = name.partition(".")
            component = DIRECTIONS.index(direction) if direction else slice(None)
            fixed[self.mesh.select(at), VECTORS.index(vector), component] = True

    def clamp(self, at: At) -> None:
        """Fix all vectors of the nodes at a place."""
        self.fix(at, VECTORS)

    def add_gravity(self, acceleration: ArrayLike, history: History = "constant") -> None:
        """Gravity: a force rho h g per reference area; acceleration g in m/s2."""
        material = self.element.material
        points = self._weighted_by_area(self.mesh.on_area(square(gauss(5))))
        self._add(points, dead(material.density * self.element.thickness * np.asarray(acceleration)), False, history)

    def add_force(self, at: tuple[float, float], force: ArrayLike, history: History = "constant") -> None:
        """Add a dead force (N) at the material point (x, y)."""
        self._add(self.mesh.locate(at), dead(force), False, history)

    def add_line_load(self, edge: str, per_length: ArrayLike, history: History = "constant") -> None:
        """Add a dead force per reference length (N/m) on an edge "x0", "x1", "y0" or "y1"."""
        self._add(self._edge(edge), dead(per_length), False, history)

    def add_moment(self, edge: str, per_length: float, history: History = "constant") -> None:
        """Add a moment per reference length (N m/m) that turns the outward direction of an edge towards the normal."""
        self._add(self._edge(edge), edge_moment(per_length, edge), True, history)

    def add_pressure(self, p: float, history: History = "constant") -> None:
        """Add a pressure (Pa) along the current normal."""
        self._add(self.mesh.on_area(square(gauss(5))), pressure(p), True, history)

    def energy(self, q: FloatArray) -> tuple[float, float]:
        """Membrane and bending energy, J."""
        membrane, bending = (float(energy.energy(self._local(q)).sum()) for energy in self._energies)
        return membrane, bending

    def stress(self, q: FloatArray) -> list[FloatArray]:
        """Weighted stress W (eps - eps_0) of the membrane and bending samples, each (elements, samples * 3)."""
        return [energy.stress(self._local(q)) for energy in self._energies]

    def extrapolated_stress(self, q: FloatArray, dq: FloatArray) -> list[FloatArray]:
        """Stress extrapolated linearly from q to q + dq; Magisano, Leonetti and Garcea (2017)."""
        return [energy.extrapolated_stress(self._local(q), self._local(dq)) for energy in self._energies]

    def internal_force(self, q: FloatArray) -> FloatArray:
        """Elastic force Q_k, shape (n,)."""
        return sum(
            (self._assemble_vector(self._index, energy.force(self._local(q))) for energy in self._energies),
            np.zeros(self.coordinates),
        )

    def tangent(self, q: FloatArray, stress: Sequence[FloatArray] | None = None) -> sp.csc_array:
        """Differentiate the elastic force: dQ_k/dq, shape (n, n).

        The geometric part takes `stress`, as `extrapolated_stress` gives it, in place of the true one.
        """
        e = self._local(q)
        stresses = self.stress(q) if stress is None else stress
        local = sum(energy.tangent(e, S) for energy, S in zip(self._energies, stresses, strict=True))
        return self._assemble_matrix(self._index, np.asarray(local))

    def external_force(self, q: FloatArray, t: float) -> FloatArray:
        """Generalised forces Q_e of the loads at the time, or load factor, t, shape (n,)."""
        e = self._local(q)
        return sum(
            (load.factor(t) * self._assemble_vector(self._index[load.cells], load.force(e)) for load in self._loads),
            np.zeros(self.coordinates),
        )

    def load_stiffness(self, q: FloatArray, t: float) -> sp.csc_array:
        """Symmetric part of dQ_e/dq, shape (n, n)."""
        e = self._local(q)
        total = sp.csc_array((self.coordinates, self.coordinates))
        for load in self._loads:
            if load.follows:
                total = total + load.factor(t) * self._assemble_matrix(self._index[load.cells], load.stiffness(e))
        return total

    def momentum(self, v: FloatArray) -> FloatArray:
        """Linear momentum of the velocities v, kg m/s, shape (3,)."""
        positions = np.zeros((len(self.mesh.nodes), 3, 3))
        positions[:, 0] = 1
        return np.asarray((positions.ravel() * (self.mass @ v)).reshape(-1, 3).sum(axis=0))

    def angular_momentum(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Angular momentum about the origin, kg m2/s, shape (3,)."""
        return np.asarray(np.cross(q.reshape(-1, 3), (self.mass @ v).reshape(-1, 3)).sum(axis=0))

    def position(self, point: tuple[float, float], q: FloatArray) -> FloatArray:
        """Position of the material point (x, y) for q of shape (..., n), m, shape (..., 3)."""
        points = self.mesh.locate(point)
        N = THIN36.table(points.unit, *self.mesh.sides)[0, 0]
        return einsum("a,...ai->...i", N, q[..., self._index[points.cells[0]]])

    def _local(self, q: FloatArray) -> FloatArray:
        """Nodal coordinates of each element, shape (elements, 12, 3)."""
        return q[self._index]

    def _edge(self, edge: str) -> Points:
        """Points along an edge, weighted by its reference length."""
        points = self.mesh.on_edge(edge, gauss(4))
        along = 2 if edge[0] == "x" else 1
        length = np.linalg.norm(self._reference_vectors(points)[:, along], axis=-1)
        return points._replace(weights=points.weights * length)

    def _weighted_by_area(self, points: Points) -> Points:
        """Points weighted by the reference area sqrt(det A)."""
        R = self._reference_vectors(points)
        return points._replace(weights=points.weights * np.linalg.norm(np.cross(R[:, 1], R[:, 2]), axis=-1))

    def _reference_vectors(self, points: Points) -> FloatArray:
        """R, R_x, R_y at material points, shape (p, 3, 3)."""
        return einsum("pva,pai->pvi", self._load_table(points), self._local(self.reference)[points.cells])

    def _load_table(self, points: Points) -> FloatArray:
        return THIN36.table(points.unit, *self.mesh.sides)[:, :3]

    def _add(self, points: Points, density: Density, follows: bool, history: History) -> None:
        self._loads.append(Load(points.cells, self._load_table(points), points.weights, density, follows, history))

    def _assemble_vector(self, index: IndexArray, local: FloatArray) -> FloatArray:
        total = np.bincount(index.ravel(), weights=local.ravel(), minlength=self.coordinates)
        return np.asarray(total, dtype=np.float64)

    def _assemble_matrix(self, index: IndexArray, local: FloatArray) -> sp.csc_array:
        flat = index.reshape(len(index), -1)
        rows, cols = np.broadcast_arrays(flat[:, :, None], flat[:, None, :])
        n = self.coordinates
        return sp.coo_array((local.ravel(), (rows.ravel(), cols.ravel())), shape=(n, n)).tocsc()


def _flat(mesh: RectangleMesh) -> FloatArray:
    """Nodal coordinates of the rectangle itself: r = (x, y, 0), r_x and r_y the unit vectors."""
    e = np.zeros((len(mesh.nodes), 3, 3))
    e[:, 0, :2] = mesh.nodes
    e[:, 1, 0] = e[:, 2, 1] = 1
    return e.ravel()
