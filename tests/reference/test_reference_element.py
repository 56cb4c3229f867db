"""Energy, force, tangent and mass of every element."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ancf.reference import Material, Model, RectangleMesh, cylinder, plane, sphere
from ancf.reference.arrays import FloatArray
from ancf.reference.elements import ElementKind
from ancf.reference.quadrature import gauss, square
from ancf.reference.shape import QUARTIC
from ancf.reference.surface import SurfacePoints
from ancf.reference.thin import PROJECTED, CurvatureKind, MembraneRule, Thin, projection

MEMBRANES: list[MembraneRule] = ["full", "lobatto", "projected"]
CURVATURES: list[CurvatureKind] = ["paper", "koiter"]
THIN: list[tuple[ElementKind, MembraneRule]] = [
    *(("thin36", membrane) for membrane in MEMBRANES),
    ("thin48", "full"),
    ("thin48", "projected"),
]
SOLID: list[tuple[ElementKind, MembraneRule, CurvatureKind]] = [
    ("full48a", "projected", "paper"),
    ("full48b", "projected", "paper"),
]
thin = pytest.mark.parametrize(("element", "membrane", "curvature"), [(*t, c) for t, c in product(THIN, CURVATURES)])
options = pytest.mark.parametrize(
    ("element", "membrane", "curvature"), [*((*t, c) for t, c in product(THIN, CURVATURES)), *SOLID]
)


def plate(
    element: ElementKind = "thin36",
    membrane: MembraneRule = "projected",
    curvature: CurvatureKind = "paper",
    thickness: float = 0.3,
) -> Model:
    return Model(
        RectangleMesh((1.0, 1.4), (1, 2)),
        thickness=thickness,
        E=2.0,
        nu=0.3,
        density=3.0,
        element=element,
        membrane=membrane,
        curvature=curvature,
    )


def moved(model: Model, seed: int, deformation: float) -> FloatArray:
    """Random rotation and translation, and a random change of all coordinates."""
    rng = np.random.default_rng(seed)
    vectors = model.reference.reshape(-1, 3) @ Rotation.random(rng=rng).as_matrix().T
    vectors[:: len(model.vectors)] += rng.normal(size=3)
    return (vectors + deformation * rng.normal(size=vectors.shape)).ravel()


def test_energy_written_out() -> None:
    """(25) to (34) of the paper, point by point, for full quadrature and the paper's curvature."""
    model = plate(membrane="full", thickness=0.1)
    q = moved(model, 0, 0.2)
    E, nu, h = 2.0, 0.3, 0.1
    membrane = bending = 0.0
    nodal = q.reshape(-1, 3, 3)
    for cell in model.mesh.cells:
        e = nodal[cell].reshape(12, 3)
        for n in (4, 3):
            rule = square(gauss(n))
            for weight, T in zip(rule.weights * 1.0 * 0.7, QUARTIC.table(rule.points, 1.0, 0.7), strict=True):
                r_x, r_y, r_xx, r_yy, r_xy = T[1:] @ e
                if n == 4:
                    xx, yy, xy = (r_x @ r_x - 1) / 2, (r_y @ r_y - 1) / 2, r_x @ r_y
                else:
                    normal = np.cross(r_x, r_y)
                    xx, yy, xy = (b @ normal / np.linalg.norm(normal) ** 3 for b in (r_xx, r_yy, 2 * r_xy))
                density = E / (1 - nu**2) * (xx**2 + yy**2 + 2 * nu * xx * yy + (1 - nu) / 2 * xy**2) / 2
                if n == 4:
                    membrane += weight * h * density
                else:
                    bending += weight * h**3 / 12 * density
    np.testing.assert_allclose(model.energy(q), (membrane, bending), rtol=1e-13)


@options
def test_rigid_motion(element: ElementKind, membrane: MembraneRule, curvature: CurvatureKind) -> None:
    model = plate(element, membrane, curvature)
    q = moved(model, 1, 0.0)
    np.testing.assert_allclose(model.energy(q), 0, atol=1e-28)
    np.testing.assert_allclose(model.internal_force(q), 0, atol=1e-14)


@options
def test_force_and_tangent(element: ElementKind, membrane: MembraneRule, curvature: CurvatureKind) -> None:
    model = plate(element, membrane, curvature)
    q, h = moved(model, 2, 0.1), 1e-5
    force, K = model.internal_force(q), model.tangent(q).toarray()
    for i in range(0, model.coordinates, 4):
        step = np.zeros_like(q)
        step[i] = h
        energy = (sum(model.energy(q + step)) - sum(model.energy(q - step))) / (2 * h)
        assert force[i] == pytest.approx(energy, abs=1e-8 * np.abs(force).max())
        column = (model.internal_force(q + step) - model.internal_force(q - step)) / (2 * h)
        np.testing.assert_allclose(K[:, i], column, atol=1e-8 * np.abs(K).max())
    np.testing.assert_allclose(K, K.T, atol=1e-14 * np.abs(K).max())


@options
def test_six_zero_modes(element: ElementKind, membrane: MembraneRule, curvature: CurvatureKind) -> None:
    """Of a free square with thickness / side 0.3, one element and four."""
    for n in (1, 2):
        mesh = RectangleMesh((1.0, 1.0), (n, n))
        model = Model(
            mesh, thickness=0.3, E=1.0, nu=0.3, density=1.0, element=element, membrane=membrane, curvature=curvature
        )
        K = model.tangent(model.reference).toarray()
        # In units of the diagonal, so that positions and gradients of any order can be compared.
        units = np.sqrt(np.diag(K))
        eigenvalues = np.linalg.eigvalsh(K / np.outer(units, units))
        assert np.sum(np.abs(eigenvalues) < 1e-10 * eigenvalues[-1]) == 6
        assert eigenvalues[0] > -1e-14 * eigenvalues[-1]


def test_extrapolated_stress_is_of_second_order() -> None:
    model = plate()
    q = moved(model, 3, 0.1)
    dq = np.random.default_rng(4).normal(size=q.shape)
    errors = []
    for size in (1e-3, 1e-4):
        pairs = zip(model.extrapolated_stress(q, size * dq), model.stress(q + size * dq), strict=True)
        errors.append(max(np.abs(a - b).max() for a, b in pairs))
    assert errors[0] / errors[1] == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize("element", ["thin36", "thin48", "full48a", "full48b"])
def test_mass(element: ElementKind) -> None:
    """Mass, first and second moments of a rectangle a x b about its corner: m, m a/2, m (a2 + b2)/3; m h2/12 across."""
    model = plate(element)
    m = 3.0 * 0.3 * 1.0 * 1.4
    v = np.zeros((6, len(model.vectors), 3))
    v[:, 0, 2] = 1
    np.testing.assert_allclose(model.momentum(v.ravel()), [0, 0, m], atol=1e-14)
    np.testing.assert_allclose(model.angular_momentum(model.reference, v.ravel()), [m * 0.7, -m * 0.5, 0], atol=1e-14)
    moment = model.reference @ (model.mass @ model.reference)
    across = m * 0.3**2 / 12 if "r_z" in model.vectors else 0
    assert moment == pytest.approx(m * (1.0**2 + 1.4**2) / 3 + across, rel=1e-14)


def test_projection() -> None:
    Pi = projection(PROJECTED)
    np.testing.assert_allclose(Pi @ Pi, Pi, atol=1e-14)
    assert np.linalg.matrix_rank(Pi) == 22
    x, y = 2 * square(gauss(4)).points.T - 1
    kept = np.stack([x * y**3, x**3 * y, x * y + x**2 - 3 * y**2], axis=1)
    np.testing.assert_allclose(Pi @ kept.ravel(), kept.ravel(), atol=1e-14)
    lost = np.stack([x**2, y**2, x**2 * y**2 - x**2 / 3 - y**2 / 3 + 4 / 9], axis=1)
    np.testing.assert_allclose(Pi @ lost.ravel(), np.full(48, 1 / 3), atol=1e-14)


@thin
def test_any_parameters_of_the_same_plate(
    element: ElementKind, membrane: MembraneRule, curvature: CurvatureKind
) -> None:
    """Parameters that are not lengths: the gradients change, the energy and the mass do not."""

    def stretched(x: FloatArray, y: FloatArray) -> SurfacePoints:
        flat = plane(2.5 * x, 0.4 * y)
        return SurfacePoints(flat.r, 2.5 * flat.r_x, 0.4 * flat.r_y, flat.r_xy)

    model = plate(element, membrane, curvature)
    q = moved(model, 5, 0.1)
    mesh = RectangleMesh((1.0 / 2.5, 1.4 / 0.4), (1, 2))
    rescaled = Model(
        mesh,
        thickness=0.3,
        E=2.0,
        nu=0.3,
        density=3.0,
        element=element,
        membrane=membrane,
        curvature=curvature,
        surface=stretched,
    )
    scale = np.array([1.0, 2.5, 0.4, 2.5 * 0.4])[: len(model.vectors), None]
    p = (q.reshape(-1, len(scale), 3) * scale).ravel()
    np.testing.assert_allclose(rescaled.energy(p), model.energy(q), rtol=1e-12)
    assert p @ (rescaled.mass @ p) == pytest.approx(q @ (model.mass @ q), rel=1e-12)


def test_stretched_parallelogram() -> None:
    """An oblique reference under E = diag(e, 0) in space has the energy E h A e**2 / (2 (1 - nu**2))."""
    edges = np.array([[1.0, 0.2, 0.0], [0.5, 0.8, 0.0]])
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) @ edges
    e_0 = np.stack([corners, *(np.tile(edge, (4, 1)) for edge in edges)], axis=1).reshape(1, 12, 3)
    element = Thin(QUARTIC, 1.0, 1.0, e_0, 0.1, Material(2.0, 0.3, 1.0), "full")
    stretch, area = 1.1, 1.0 * 0.8 - 0.2 * 0.5
    strain = (stretch**2 - 1) / 2
    energy = element.membrane_energy().energy(e_0 * [stretch, 1, 1])
    np.testing.assert_allclose(energy, 2.0 * 0.1 * area * strain**2 / (2 * (1 - 0.3**2)), rtol=1e-13)
    assert element.mass()[0, ::3, ::3].sum() == pytest.approx(0.1 * area, rel=1e-13)


def test_unrolled_cylinder() -> None:
    """A quarter cylinder of radius R, flattened, has the energy E h**3 A / (24 (1 - nu**2) R**2)."""
    R, height, h, n = 2.0, 1.0, 0.01, 8
    mesh = RectangleMesh((np.pi / 2, height), (n, 1))

    def unrolled(x: FloatArray, y: FloatArray) -> SurfacePoints:
        flat = plane(R * x, y)
        return flat._replace(r_x=R * flat.r_x)

    model = Model(mesh, thickness=h, E=2.0, nu=0.3, density=1.0, curvature="koiter", surface=cylinder(R))
    flat = unrolled(*mesh.nodes.T).vectors(model.vectors)
    _, bending = model.energy(flat.ravel())
    area = R * np.pi / 2 * height
    assert bending == pytest.approx(2.0 * h**3 * area / (24 * (1 - 0.3**2) * R**2), rel=2e-3)


@pytest.mark.parametrize("element", ["full48a", "full48b"])
def test_volume_of_a_curved_solid(element: ElementKind) -> None:
    """A patch of a spherical shell weighs rho A ((R + h/2)**3 - (R - h/2)**3) / (3 R**2).

    Directors between nodes are chords of the unit sphere: the error is of second order.
    """
    R, h, rho = 2.0, 0.4, 3.0
    area = 0.5 * R**2 * (np.sin(0.3) + np.sin(0.2))
    weight = rho * area * ((R + h / 2) ** 3 - (R - h / 2) ** 3) / (3 * R**2)
    errors = []
    for n in (4, 8):
        mesh = RectangleMesh((0.5, 0.5), (n, n), (0.3, -0.2))
        model = Model(mesh, thickness=h, E=1.0, nu=0.3, density=rho, element=element, surface=sphere(R))
        v = np.zeros((len(mesh.nodes), 4, 3))
        v[:, 0, 2] = 1
        errors.append(model.momentum(v.ravel())[2] / weight - 1)
    assert abs(errors[0]) < 3e-3
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.05)
