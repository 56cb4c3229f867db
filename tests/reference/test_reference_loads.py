"""Loads: their sums, their virtual work, their stiffness."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ancf.reference import Model, RectangleMesh
from ancf.reference.arrays import FloatArray
from ancf.reference.elements import ElementKind
from ancf.reference.quadrature import gauss

EDGES = ["x0", "x1", "y0", "y1"]
every_element = pytest.mark.parametrize("element", ["thin36", "thin48", "full48a", "full48b"])


def plate(nx: int = 2, ny: int = 3, element: ElementKind = "thin36") -> Model:
    mesh = RectangleMesh((1.0, 0.6), (nx, ny))
    return Model(mesh, thickness=0.1, E=1.0, nu=0.3, density=5.0, element=element)


def bent(model: Model, seed: int = 0) -> FloatArray:
    return model.reference + 0.1 * np.random.default_rng(seed).normal(size=model.coordinates)


def resultant(model: Model, Q: FloatArray) -> FloatArray:
    """Sum of forces: the work done on a unit translation."""
    return np.asarray(Q.reshape(-1, len(model.vectors), 3)[:, 0].sum(axis=0))


def moment(q: FloatArray, Q: FloatArray) -> FloatArray:
    """Moment about the origin: the work done on a unit rotation."""
    return np.asarray(np.cross(q.reshape(-1, 3), Q.reshape(-1, 3)).sum(axis=0))


@every_element
def test_dead_loads(element: ElementKind) -> None:
    model = plate(element=element)
    model.add_gravity([0, 0, -10], "ramp")
    model.add_line_load("y1", [1, 2, 3], [(0.0, 0.0), (2.0, 4.0)])
    model.add_force((0.35, 0.1), [0, 0, 7])
    Q = model.external_force(model.reference, 0.5)
    weight = 0.5 * 10 * 5.0 * 0.1 * 0.6
    np.testing.assert_allclose(resultant(model, Q), np.array([1, 2, 3]) * 1.0 + [0, 0, 7 - weight], rtol=1e-13)
    expected = np.cross([0.5, 0.6, 0], [1, 2, 3]) + np.cross([0.35, 0.1, 0], [0, 0, 7])
    expected += np.cross([0.5, 0.3, 0], [0, 0, -weight])
    np.testing.assert_allclose(moment(model.reference, Q), expected, atol=1e-13)


@every_element
def test_gravity_does_its_work_at_every_mass(element: ElementKind) -> None:
    """Reference: sum of m N g over the quadrature points; lumped, each node has a share and its gradients have none."""
    model, g = plate(element=element), np.array([1, 2, 3])
    model.add_gravity(g)
    N, mass = model.element.mass_points()
    expected = np.zeros_like(model.reference)
    np.add.at(expected, model._index, np.einsum("es,sa,i->eai", mass, N, g))
    np.testing.assert_allclose(model.external_force(model.reference, 0), expected, atol=1e-15)
    model.lump_mass()
    Q = model.external_force(model.reference, 0).reshape(-1, len(model.vectors), 3)
    assert not Q[:, 1:].any()
    assert (Q[:, 0] > 0).all()
    np.testing.assert_allclose(Q[:, 0].sum(axis=0), mass.sum() * g, rtol=1e-13)


@every_element
def test_work_of_a_point_force(element: ElementKind) -> None:
    """The same on any mesh: F times the displacement of the loaded point, for a cubic displacement field.

    Without twist: `full48b` has no functions for it.
    """
    works, mixed = [], 0 if element == "full48b" else 1
    for divisions in ((1, 1), (3, 2)):
        model = plate(*divisions, element)
        model.add_force((0.35, 0.1), [0, 0, 2.0])
        x, y = model.mesh.nodes.T
        dq = np.zeros((len(x), len(model.vectors), 3))
        dq[:, :3, 2] = np.stack([x**3 + mixed * x**2 * y, 3 * x**2 + mixed * 2 * x * y, mixed * x**2], axis=1)
        if element == "thin48":
            dq[:, 3, 2] = 2 * x
        works.append(model.external_force(model.reference, 0) @ dq.ravel())
    np.testing.assert_allclose(works, 2.0 * (0.35**3 + mixed * 0.35**2 * 0.1), rtol=1e-13)


@every_element
def test_pressure(element: ElementKind) -> None:
    """Pressure on a rotated flat plate is p A n."""
    model = plate(element=element)
    model.add_pressure(3.0)
    R = Rotation.random(rng=np.random.default_rng(1)).as_matrix()
    q = (model.reference.reshape(-1, 3) @ R.T).ravel()
    np.testing.assert_allclose(resultant(model, model.external_force(q, 0)), 3.0 * 0.6 * R[:, 2], rtol=1e-13)


@every_element
@pytest.mark.parametrize("edge", EDGES)
def test_moment_of_an_edge(edge: str, element: ElementKind) -> None:
    """A flat plate in any attitude: no resultant, and the moment M L along the edge, outward x normal."""
    model = plate(element=element)
    model.add_moment(edge, 2.0)
    R = Rotation.random(rng=np.random.default_rng(2)).as_matrix()
    q = (model.reference.reshape(-1, 3) @ R.T).ravel()
    Q = model.external_force(q, 0)
    outward = {"x0": [-1, 0, 0], "x1": [1, 0, 0], "y0": [0, -1, 0], "y1": [0, 1, 0]}[edge]
    length = 0.6 if edge[0] == "x" else 1.0
    np.testing.assert_allclose(resultant(model, Q), 0, atol=1e-15)
    np.testing.assert_allclose(moment(q, Q), 2.0 * length * R @ np.cross(outward, [0, 0, 1]), atol=1e-14)


@every_element
@pytest.mark.parametrize("edge", EDGES)
def test_work_of_a_moment(edge: str, element: ElementKind) -> None:
    """Of a bent, stretched and sheared element: M times the turn about the edge, by differences.

    What turns is the gradient across the edge between its two nodes, linear for `thin36` and cubic for `thin48`, and
    the vector through the thickness of a solid; the edge itself is a cubic for all of them.
    """
    model = plate(1, 1, element)
    model.add_moment(edge, 2.0)
    q = bent(model)
    dq, d = np.random.default_rng(3).normal(size=q.shape), 1e-6
    rule = gauss(4)
    s = rule.points
    length, across, along = (0.6, 1, 2) if edge[0] == "x" else (1.0, 2, 1)
    ends = {"x0": [0, 3], "x1": [1, 2], "y0": [0, 1], "y1": [3, 2]}[edge]
    sign = {"x0": 1, "x1": -1, "y0": -1, "y1": 1}[edge]

    def frame(q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The unit tangent (outward x normal at rest) and the unit vector that turns about it."""
        first, last = q.reshape(-1, len(model.vectors), 3)[model.mesh.cells[0][ends]]
        tangent = (6 * s - 6 * s**2) * (last[0] - first[0]) / length
        tangent = tangent + (1 - 4 * s + 3 * s**2) * first[along] + (3 * s**2 - 2 * s) * last[along]
        if element == "thin48":
            turning = (1 - 3 * s**2 + 2 * s**3) * first[across] + (3 * s**2 - 2 * s**3) * last[across]
            turning = turning + length * (s * (1 - s) ** 2 * first[3] - s**2 * (1 - s) * last[3])
        else:
            turned = across if element == "thin36" else 3
            turning = (1 - s) * first[turned] + s * last[turned]
        tangent = sign * tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
        turning = turning - np.sum(turning * tangent, axis=1, keepdims=True) * tangent
        return tangent, turning / np.linalg.norm(turning, axis=1, keepdims=True)

    change = (frame(q + d * dq)[1] - frame(q - d * dq)[1]) / (2 * d)
    turn = np.sum(np.cross(*frame(q)) * change, axis=1)
    expected = 2.0 * length * rule.weights @ turn
    assert model.external_force(q, 0) @ dq == pytest.approx(expected, rel=1e-8)


@every_element
@pytest.mark.parametrize("edge", ["x", "y"])
def test_constant_moments(edge: str, element: ElementKind) -> None:
    """Moments on all edges of a plate hold the cylinder w = kappa x**2 / 2 (or y) exactly, to first order."""
    model = plate(3, 2, element)
    x = model.mesh.nodes[:, "xy".index(edge)]
    kappa, zero = 1e-3, 0 * x
    slope = {"x": (kappa * x, zero), "y": (zero, kappa * x)}[edge]
    bend = np.zeros((len(x), len(model.vectors), 3))
    bend[:, 0, 2], bend[:, 1, 2], bend[:, 2, 2] = kappa * x**2 / 2, *slope
    lame = model.element.material.plane_stress()
    if "r_z" in model.vectors:
        # Fibres that keep their length make it plane strain.
        lame = model.element.material.solid()
        bend[:, 3, 0], bend[:, 3, 1] = -slope[0], -slope[1]
    along, across = (kappa * 0.1**3 / 12 * modulus for modulus in (lame[0] + 2 * lame[1], lame[0]))
    for name in EDGES:
        model.add_moment(name, along if name[0] == edge else across)
    Q = model.external_force(model.reference, 0)
    # Relative to the forces of the elements, which cancel inside.
    K = model.tangent(model.reference)
    scale = (abs(K) @ abs(bend.ravel())).max()
    np.testing.assert_allclose(K @ bend.ravel(), Q, atol=1e-14 * scale)
    assert np.abs(Q).max() > 1e-6 * scale


@every_element
@pytest.mark.parametrize("load", ["pressure", *EDGES])
def test_load_stiffness(load: str, element: ElementKind) -> None:
    """The symmetric part of the derivative of the external force, by differences."""
    model = plate(1, 2, element)
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
