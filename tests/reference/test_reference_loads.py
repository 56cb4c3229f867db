"""Loads: their sums, their virtual work, their stiffness."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ancf.reference import Model, RectangleMesh
from ancf.reference.arrays import FloatArray
from ancf.reference.quadrature import gauss
from ancf.reference.shape import THIN36

EDGES = ["x0", "x1", "y0", "y1"]


def plate(nx: int = 2, ny: int = 3) -> Model:
    return Model(RectangleMesh((1.0, 0.6), (nx, ny)), thickness=0.1, E=1.0, nu=0.3, density=5.0)


def bent(model: Model, seed: int = 0) -> FloatArray:
    return model.reference + 0.1 * np.random.default_rng(seed).normal(size=model.coordinates)


def resultant(Q: FloatArray) -> FloatArray:
    """Sum of forces: the work done on a unit translation."""
    return np.asarray(Q.reshape(-1, 3, 3)[:, 0].sum(axis=0))


def moment(q: FloatArray, Q: FloatArray) -> FloatArray:
    """Moment about the origin: the work done on a unit rotation."""
    return np.asarray(np.cross(q.reshape(-1, 3), Q.reshape(-1, 3)).sum(axis=0))


def test_dead_loads() -> None:
    model = plate()
    model.add_gravity([0, 0, -10], "ramp")
    model.add_line_load("y1", [1, 2, 3], [(0.0, 0.0), (2.0, 4.0)])
    model.add_force((0.35, 0.1), [0, 0, 7])
    Q = model.external_force(model.reference, 0.5)
    weight = 0.5 * 10 * 5.0 * 0.1 * 0.6
    np.testing.assert_allclose(resultant(Q), np.array([1, 2, 3]) * 1.0 + [0, 0, 7 - weight], rtol=1e-13)
    expected = np.cross([0.5, 0.6, 0], [1, 2, 3]) + np.cross([0.35, 0.1, 0], [0, 0, 7])
    expected += np.cross([0.5, 0.3, 0], [0, 0, -weight])
    np.testing.assert_allclose(moment(model.reference, Q), expected, atol=1e-13)


def test_gravity_is_mass_times_acceleration() -> None:
    model = plate()
    model.add_gravity([1, 2, 3])
    a = np.zeros((len(model.mesh.nodes), 3, 3))
    a[:, 0] = [1, 2, 3]
    np.testing.assert_allclose(model.external_force(model.reference, 0), model.mass @ a.ravel(), atol=1e-15)


def test_work_of_a_point_force() -> None:
    """The same on any mesh: F times the displacement of the loaded point, for a cubic displacement field."""
    works = []
    for divisions in ((1, 1), (3, 2)):
        model = plate(*divisions)
        model.add_force((0.35, 0.1), [0, 0, 2.0])
        x, y = model.mesh.nodes.T
        dq = np.zeros((len(x), 3, 3))
        dq[:, :, 2] = np.stack([x**3 + x**2 * y, 3 * x**2 + 2 * x * y, x**2], axis=1)
        works.append(model.external_force(model.reference, 0) @ dq.ravel())
    np.testing.assert_allclose(works, 2.0 * (0.35**3 + 0.35**2 * 0.1), rtol=1e-13)


def test_pressure() -> None:
    """Pressure on a rotated flat plate is p A n."""
    model = plate()
    model.add_pressure(3.0)
    R = Rotation.random(rng=np.random.default_rng(1)).as_matrix()
    q = (model.reference.reshape(-1, 3) @ R.T).ravel()
    np.testing.assert_allclose(resultant(model.external_force(q, 0)), 3.0 * 0.6 * R[:, 2], rtol=1e-13)


@pytest.mark.parametrize("edge", EDGES)
def test_moment_of_an_edge(edge: str) -> None:
    """A flat plate in any attitude: no resultant, and the moment M L along the edge, outward x normal."""
    model = plate()
    model.add_moment(edge, 2.0)
    R = Rotation.random(rng=np.random.default_rng(2)).as_matrix()
    q = (model.reference.reshape(-1, 3) @ R.T).ravel()
    Q = model.external_force(q, 0)
    outward = {"x0": [-1, 0, 0], "x1": [1, 0, 0], "y0": [0, -1, 0], "y1": [0, 1, 0]}[edge]
    length = 0.6 if edge[0] == "x" else 1.0
    np.testing.assert_allclose(resultant(Q), 0, atol=1e-15)
    np.testing.assert_allclose(moment(q, Q), 2.0 * length * R @ np.cross(outward, [0, 0, 1]), atol=1e-14)


@pytest.mark.parametrize("edge", EDGES)
def test_work_of_a_moment(edge: str) -> None:
    """Of a bent, stretched and sheared element: M times the turn of the unit conormal towards n, by differences."""
    model = plate(1, 1)
    model.add_moment(edge, 2.0)
    q = bent(model)
    dq, d = np.random.default_rng(3).normal(size=q.shape), 1e-6
    points = model.mesh.on_edge(edge, gauss(4))
    table = THIN36.table(points.unit, 1.0, 0.6)
    corners = model.mesh.cells[0]
    sign = 1 if edge[1] == "1" else -1

    def conormal(q: FloatArray) -> tuple[FloatArray, FloatArray]:
        r_x, r_y = (table[:, k] @ q.reshape(-1, 3, 3)[corners].reshape(12, 3) for k in (1, 2))
        n = np.cross(r_x, r_y)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        nu = sign * (np.cross(r_y, n) if edge[0] == "x" else np.cross(n, r_x))
        return nu / np.linalg.norm(nu, axis=1, keepdims=True), n

    turn = np.sum((conormal(q + d * dq)[0] - conormal(q - d * dq)[0]) / (2 * d) * conormal(q)[1], axis=1)
    assert model.external_force(q, 0) @ dq == pytest.approx(2.0 * points.weights @ turn, rel=1e-8)


@pytest.mark.parametrize("load", ["pressure", *EDGES])
def test_load_stiffness(load: str) -> None:
    """The symmetric part of the derivative of the external force, by differences."""
    model = plate(1, 2)
    if load == "pressure":
        model.add_pressure(3.0, "ramp")
    else:
        model.add_moment(load, 2.0, "ramp")
    q, h, t = bent(model), 1e-6, 0.7
    columns = [
        (model.external_force(q + step, t) - model.external_force(q - step, t)) / (2 * h)
        for step in h * np.eye(model.coordinates)
    ]
    full = np.stack(columns, axis=1)
    np.testing.assert_allclose(model.load_stiffness(q, t).toarray(), (full + full.T) / 2, atol=1e-8)
