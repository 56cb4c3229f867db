"""A plate or shell with supports and loads: the global system."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike

from .arrays import FloatArray, IndexArray, einsum
from .elements import NODAL_VECTORS, ElementKind, make
from .loads import Density, History, Load, dead, edge_moment, pressure
from .material import Material
from .mesh import At, Points, RectangleMesh
from .quadrature import gauss, square
from .surface import Surface, plane
from .thin import CurvatureKind, MembraneRule

DIRECTIONS = ("x", "y", "z")


class Reaction(NamedTuple):
    """What a support exerts: a force (N) at the mean position of its nodes (m), a moment (N m) about it; each (3,)."""

    point: FloatArray
    force: FloatArray
    moment: FloatArray


class Model:
    """One body with its supports and loads.

    Nodal coordinates are numbered node after node, vector after vector (r, r_x, r_y, ...), three components each; n is
    their number.

    Parameters
    ----------
    mesh : RectangleMesh
        Elements over the natural coordinates.
    thickness : float
        In m.
    E, nu, density : float
        Young's modulus in Pa, Poisson's ratio, density in kg/m3.
    element : {"thin36", "thin48", "full48a", "full48b"}
    membrane : {"projected", "full", "lobatto"}
    curvature : {"paper", "koiter"}
        Of thin elements.
    surface : callable
        The reference shape; the flat rectangle in the X-Y plane if not given.
    """

    def __init__(
        self,
        mesh: RectangleMesh,
        *,
        thickness: float,
        E: float,
        nu: float,
        density: float,
        element: ElementKind = "thin36",
        membrane: MembraneRule = "projected",
        curvature: CurvatureKind = "paper",
        surface: Surface = plane,
    ) -> None:
        self.mesh = mesh
        self.vectors = NODAL_VECTORS[element]
        self.reference = surface(*mesh.nodes.T).vectors(self.vectors).ravel()
        size = 3 * len(self.vectors)
        nodal = size * mesh.cells[:, :, None] + np.arange(size)
        self._index: IndexArray = nodal.reshape(len(mesh.cells), -1, 3)
        l, w = mesh.sides
        e_0 = self._local(self.reference)
        material = Material(E, nu, density)
        self.element = make(element, (l, w), e_0, thickness, material, membrane=membrane, curvature=curvature)
        self._energies = self.element.energies()
        self.mass = self._assemble_matrix(self._index, einsum("eab,ij->eaibj", self.element.mass(), np.eye(3)))
        self._fixed = np.zeros(self.coordinates, dtype=np.bool_)
        self._supports: list[tuple[IndexArray, IndexArray]] = []
        self._loads: list[Load] = []
        self._lumped = False

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
        scale = np.ones_like(self._nodal(self.reference))
        scale[:, 0] = np.ptp(self._nodal(self.reference)[:, 0], axis=0).max()
        return scale.ravel()

    def lump_mass(self) -> None:
        """Make the mass matrix diagonal, scaled to the mass of the body; Hinton, Rock and Zienkiewicz (1976).

        Gravity that is added afterwards acts on it: on the positions alone.
        """
        along = np.zeros_like(self._nodal(self.reference))
        along[:, 0, 0] = 1
        translation, diagonal = along.ravel(), self.mass.diagonal()
        scale = translation @ (self.mass @ translation) / (translation @ diagonal)
        self.mass = sp.diags_array(scale * diagonal).tocsc()
        self._lumped = True

    def fix(self, at: At, coordinates: Sequence[str]) -> None:
        """Fix vectors ("r", "r_x", ...) or components ("r.x", "r_y.z", ...) of the nodes at a place."""
        held = np.zeros_like(self._fixed)
        nodes = self.mesh.select(at)
        for name in coordinates:
            vector, _, direction = name.partition(".")
            component = DIRECTIONS.index(direction) if direction else slice(None)
            held.reshape(-1, len(self.vectors), 3)[nodes, self.vectors.index(vector), component] = True
        # What two supports hold belongs to the first.
        self._supports.append((nodes, np.flatnonzero(held & ~self._fixed)))
        self._fixed |= held

    def clamp(self, at: At) -> None:
        """Fix all vectors of the nodes at a place."""
        self.fix(at, self.vectors)

    def add_gravity(self, acceleration: ArrayLike, history: History = "constant") -> None:
        """Gravity: a force rho g per volume, or on lumped masses; acceleration g in m/s2."""
        if self._lumped:
            self._add_weights(acceleration, history)
            return
        N, mass = self.element.mass_points()
        elements, samples = mass.shape
        cells = np.repeat(np.arange(elements), samples)
        table = np.tile(N[:, None], (elements, 1, 1))
        self._loads.append(Load(cells, table, mass.ravel(), dead(acceleration), False, history))

    def _add_weights(self, acceleration: ArrayLike, history: History) -> None:
        """Gravity on the lumped masses of the positions: a force at every node, from one of the cells around it."""
        nodes, first = np.unique(self.mesh.cells, return_index=True)
        cells, corners = np.unravel_index(first, self.mesh.cells.shape)
        table = np.zeros((len(nodes), 1, self._index.shape[1]))
        table[np.arange(len(nodes)), 0, corners * len(self.vectors)] = 1
        mass = self._nodal(self.mass.diagonal())[nodes, 0, 0]
        self._loads.append(Load(cells, table, mass, dead(acceleration), False, history))

    def add_force(self, at: tuple[float, float], force: ArrayLike, history: History = "constant") -> None:
        """Add a dead force (N) at the material point (x, y)."""
        self._add(self.mesh.locate(at), dead(force), False, history)

    def add_line_load(self, edge: str, per_length: ArrayLike, history: History = "constant") -> None:
        """Add a dead force per reference length (N/m) on an edge "x0", "x1", "y0" or "y1"."""
        self._add(self._edge(edge), dead(per_length), False, history)

    def add_moment(self, edge: str, per_length: float, history: History = "constant") -> None:
        """Add a moment per reference length (N m/m) that turns the outward direction of an edge towards the normal."""
        points = self._edge(edge)
        surface = self._surface_table(points)
        table = np.stack([surface[:, 0], self.element.director(edge, points.unit), surface[:, _along(edge)]], axis=1)
        density = edge_moment(per_length, edge)
        self._loads.append(Load(points.cells, table, points.weights, density, True, history))

    def add_pressure(self, p: float, history: History = "constant") -> None:
        """Add a pressure (Pa) along the current normal."""
        self._add(self.mesh.on_area(square(gauss(5))), pressure(p), True, history)

    def energy(self, q: FloatArray) -> tuple[float, float]:
        """Membrane and bending energy, J."""
        return self.element.split(self._energies, self._local(q))

    def stress(self, q: FloatArray) -> list[FloatArray]:
        """Weighted stress W (eps - eps_0) of the samples of each energy, each (elements, m)."""
        return [energy.stress(self._local(q)) for energy in self._energies]

    def extrapolated_stress(self, q: FloatArray, dq: FloatArray) -> list[FloatArray]:
        """Stress extrapolated linearly from q to q + dq; Magisano, Leonetti and Garcea (2017)."""
        return [energy.extrapolated_stress(self._local(q), self._local(dq)) for energy in self._energies]

    def internal_force(self, q: FloatArray, stress: Sequence[FloatArray] | None = None) -> FloatArray:
        """Elastic force Q_k, shape (n,); of the stress S that is given, as `stress` gives it, B^T S."""
        e = self._local(q)
        stresses = self.stress(q) if stress is None else stress
        forces = (energy.force(e, S) for energy, S in zip(self._energies, stresses, strict=True))
        return sum((self._assemble_vector(self._index, force) for force in forces), np.zeros(self.coordinates))

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

    def reactions(self, q: FloatArray, t: float, a: FloatArray | None = None) -> list[Reaction]:
        """Return what each support exerts: the residual M a + Q_k - Q_e of the coordinates that it holds."""
        residual = self.internal_force(q) - self.external_force(q, t)
        if a is not None:
            residual = residual + self.mass @ a
        found = []
        for nodes, held in self._supports:
            forces, arms = np.zeros_like(q), self._nodal(q).copy()
            forces[held] = residual[held]
            point = arms[nodes, 0].mean(axis=0)
            arms[:, 0] -= point
            moment = np.cross(arms, self._nodal(forces)).sum(axis=(0, 1))
            found.append(Reaction(point, self._nodal(forces)[:, 0].sum(axis=0), moment))
        return found

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
        positions = np.zeros_like(self._nodal(v))
        positions[:, 0] = 1
        return np.asarray((positions.ravel() * (self.mass @ v)).reshape(-1, 3).sum(axis=0))

    def angular_momentum(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Angular momentum about the origin, kg m2/s, shape (3,)."""
        return np.asarray(np.cross(q.reshape(-1, 3), (self.mass @ v).reshape(-1, 3)).sum(axis=0))

    def position(self, point: tuple[float, float], q: FloatArray) -> FloatArray:
        """Position of the material point (x, y) for q of shape (..., n), m, shape (..., 3)."""
        points = self.mesh.locate(point)
        N = self.element.table(points.unit)[0, 0]
        return einsum("a,...ai->...i", N, q[..., self._index[points.cells[0]]])

    def _local(self, q: FloatArray) -> FloatArray:
        """Nodal coordinates of each element, shape (elements, a, 3)."""
        return q[self._index]

    def _nodal(self, q: FloatArray) -> FloatArray:
        """Vectors of each node, shape (nodes, vectors, 3)."""
        return q.reshape(-1, len(self.vectors), 3)

    def _edge(self, edge: str) -> Points:
        """Points along an edge, weighted by its reference length."""
        points = self.mesh.on_edge(edge, gauss(4))
        along = self._surface_table(points)[:, _along(edge)]
        R = einsum("pa,pai->pi", along, self._local(self.reference)[points.cells])
        return points._replace(weights=points.weights * np.linalg.norm(R, axis=-1))

    def _surface_table(self, points: Points) -> FloatArray:
        """Tables of r, r_x, r_y at material points, shape (p, 3, a)."""
        return self.element.table(points.unit)[:, :3]

    def _add(self, points: Points, density: Density, follows: bool, history: History) -> None:
        table = self._surface_table(points)
        self._loads.append(Load(points.cells, table, points.weights, density, follows, history))

    def _assemble_vector(self, index: IndexArray, local: FloatArray) -> FloatArray:
        total = np.bincount(index.ravel(), weights=local.ravel(), minlength=self.coordinates)
        return np.asarray(total, dtype=np.float64)

    def _assemble_matrix(self, index: IndexArray, local: FloatArray) -> sp.csc_array:
        flat = index.reshape(len(index), -1)
        rows, cols = np.broadcast_arrays(flat[:, :, None], flat[:, None, :])
        n = self.coordinates
        return sp.coo_array((local.ravel(), (rows.ravel(), cols.ravel())), shape=(n, n)).tocsc()


def _along(edge: str) -> int:
    """Row of a shape table that holds the derivative along an edge."""
    return 2 if edge[0] == "x" else 1
