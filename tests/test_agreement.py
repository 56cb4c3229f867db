"""The Rust core against the NumPy path, which shares no code with it: random elements and states, and whole runs."""

from collections.abc import Callable
from itertools import product
from typing import Any, Literal

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import ancf
from ancf import _core, reference
from ancf.reference.loads import History
from ancf.reference.thin import CurvatureKind, MembraneRule

FloatArray = NDArray[np.float64]
Pair = tuple[_core.Model, reference.Model]

MEMBRANES: list[MembraneRule] = ["projected", "full", "lobatto"]
CURVATURES: list[CurvatureKind] = ["paper", "koiter"]
EDGES = ["x0", "x1", "y0", "y1"]
variants = pytest.mark.parametrize(("membrane", "curvature"), list(product(MEMBRANES, CURVATURES)))
meshes = pytest.mark.parametrize("divisions", [(1, 1), (3, 2)])
seeds = pytest.mark.parametrize("seed", range(4))


def pair(
    rng: np.random.Generator,
    divisions: tuple[int, int],
    membrane: MembraneRule = "projected",
    curvature: CurvatureKind = "paper",
    E: float | None = None,
) -> Pair:
    """The same plate in Rust and in NumPy, of random size, thickness and material."""
    size = (rng.uniform(0.2, 2.0), rng.uniform(0.2, 2.0))
    thickness = 10 ** rng.uniform(-3, -0.5)
    E = E or 10 ** rng.uniform(3, 11)
    nu, density = rng.uniform(-0.3, 0.49), rng.uniform(1e2, 1e4)
    rust = _core.Model()
    rust.add_body(
        "plate",
        _core.Shape.rectangle(size),
        divisions,
        thickness=thickness,
        E=E,
        nu=nu,
        density=density,
        mass_damping=0.0,
        viscosity=0.0,
        element="thin36",
        membrane=membrane,
        curvature=curvature,
    )
    plain = reference.Model(
        reference.RectangleMesh(size, divisions),
        thickness=thickness,
        E=E,
        nu=nu,
        density=density,
        membrane=membrane,
        curvature=curvature,
    )
    return rust, plain


def moved(rng: np.random.Generator, model: reference.Model, deformation: float = 0.2) -> FloatArray:
    """Any rotation and translation, and a random change of all nodal vectors that is large for gradients."""
    vectors = model.reference.reshape(-1, 3, 3).copy()
    vectors[:, 0] += deformation * model.mesh.sides.min() * rng.normal(size=vectors[:, 0].shape)
    vectors[:, 1:] += deformation * rng.normal(size=vectors[:, 1:].shape)
    vectors = vectors @ Rotation.random(rng=rng).as_matrix().T
    vectors[:, 0] += rng.normal(size=3)
    return vectors.ravel()


def matrix(triplets: tuple[NDArray[np.uint64], NDArray[np.uint64], FloatArray], n: int) -> FloatArray:
    rows, columns, values = triplets
    return sp.coo_array((values, (rows.astype(np.intp), columns.astype(np.intp))), shape=(n, n)).toarray()


def assert_agree(found: FloatArray, expected: FloatArray) -> None:
    """To 1e-10 of the largest entry."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@variants
@meshes
@seeds
def test_energy_and_its_derivatives(
    membrane: MembraneRule, curvature: CurvatureKind, divisions: tuple[int, int], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    rust, plain = pair(rng, divisions, membrane, curvature)
    np.testing.assert_allclose(rust.reference(), plain.reference, rtol=0, atol=1e-15)
    q = moved(rng, plain)
    np.testing.assert_allclose(rust.energy(q), plain.energy(q), rtol=1e-10)
    assert_agree(rust.internal_force(q), plain.internal_force(q))
    assert_agree(matrix(rust.tangent(q), len(q)), plain.tangent(q).toarray())


@variants
@meshes
@seeds
def test_tangent_of_mixed_integration_points(
    membrane: MembraneRule, curvature: CurvatureKind, divisions: tuple[int, int], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    rust, plain = pair(rng, divisions, membrane, curvature)
    previous = moved(rng, plain)
    q = previous + 0.1 * rng.normal(size=previous.shape)
    expected = plain.tangent(q, plain.extrapolated_stress(previous, q - previous)).toarray()
    assert np.abs(expected - plain.tangent(q).toarray()).max() > 1e-3 * np.abs(expected).max()
    assert_agree(matrix(rust.tangent(q, previous=previous), len(q)), expected)


@meshes
@seeds
def test_mass(divisions: tuple[int, int], seed: int) -> None:
    rust, plain = pair(np.random.default_rng(seed), divisions)
    assert_agree(matrix(rust.mass(), rust.coordinates), plain.mass.toarray())


def add_gravity(rust: _core.Model, plain: reference.Model, history: History) -> None:
    rust.add_gravity((1.0, 2.0, -9.81), history)
    plain.add_gravity((1.0, 2.0, -9.81), history)


def add_force(rust: _core.Model, plain: reference.Model, history: History) -> None:
    x, y = plain.mesh.size
    rust.add_force("plate", (0.45 * x, 0.8 * y), (3.0, -1.0, 2.0), history)
    plain.add_force((0.45 * x, 0.8 * y), (3.0, -1.0, 2.0), history)


def add_line_loads(rust: _core.Model, plain: reference.Model, history: History) -> None:
    for edge, size in zip(EDGES, (1.0, -2.0, 3.0, 4.0), strict=True):
        rust.add_line_load("plate", f"edge:{edge}", (size, 2.0, -size), history)
        plain.add_line_load(edge, (size, 2.0, -size), history)


def add_moments(rust: _core.Model, plain: reference.Model, history: History) -> None:
    for edge, size in zip(EDGES, (1.0, -2.0, 3.0, 4.0), strict=True):
        rust.add_moment("plate", f"edge:{edge}", size, history)
        plain.add_moment(edge, size, history)


def add_pressure(rust: _core.Model, plain: reference.Model, history: History) -> None:
    rust.add_pressure("plate", 7.0, history)
    plain.add_pressure(7.0, history)


@pytest.mark.parametrize("history", ["constant", "ramp", [(0.0, 1.0), (0.5, -2.0), (1.0, 4.0)]])
@pytest.mark.parametrize("add", [add_gravity, add_force, add_line_loads, add_moments, add_pressure])
@meshes
@seeds
def test_loads_and_their_stiffness(
    add: Callable[[_core.Model, reference.Model, History], None],
    history: History,
    divisions: tuple[int, int],
    seed: int,
) -> None:
    """On a material so soft that the elastic tangent does not hide that of the loads, whose symmetric part counts."""
    rng = np.random.default_rng(seed)
    rust, plain = pair(rng, divisions, E=1.0)
    add(rust, plain, history)
    q, t = moved(rng, plain), 0.7
    assert_agree(rust.external_force(q, t), plain.external_force(q, t))
    expected = plain.tangent(q) - plain.load_stiffness(q, t)
    assert_agree(matrix(rust.tangent(q, t), len(q)), expected.toarray())


def plate(model: reference.Model, membrane: MembraneRule) -> ancf.Rectangle:
    """The body of a NumPy model for the public interface."""
    material = model.element.material
    return ancf.Rectangle(
        size=model.mesh.size,
        divisions=model.mesh.divisions,
        thickness=model.element.thickness,
        material=ancf.Material(E=material.E, nu=material.nu, density=material.density),
        membrane=membrane,
    )


@pytest.mark.parametrize("newton", ["mip", "plain"])
@pytest.mark.parametrize("membrane", MEMBRANES)
def test_static_run(membrane: MembraneRule, newton: Literal["mip", "plain"]) -> None:
    """The cantilever of Dufva and Shabana (2005), 2 x 1 elements."""
    factors, mesh = [0.25, 0.5, 1.0], reference.RectangleMesh((0.5, 0.15), (2, 1))
    plain = reference.Model(mesh, thickness=1e-3, E=2.07e11, nu=0.3, density=7810, membrane=membrane)
    plain.clamp("edge:x0")
    plain.add_line_load("x1", (0, 0, -200), "ramp")
    expected = reference.solve_static(plain, factors, reference.NewtonOptions(newton, tolerance=1e-10))
    model = ancf.Model(
        bodies={"plate": plate(plain, membrane)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
    )
    result = ancf.solve_static(model, load_factors=factors, newton=newton, tolerance=1e-10)
    assert np.abs(expected.q[-1] - plain.reference).max() > 0.2
    np.testing.assert_allclose(result.q[1:], expected.q, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("options", "method"),
    [
        ({"method": "hht", "alpha": 0.0}, reference.GeneralizedAlpha.hht(0.0)),
        ({"method": "hht", "alpha": -0.3}, reference.GeneralizedAlpha.hht(-0.3)),
        ({"method": "generalized_alpha", "rho_inf": 0.6}, reference.GeneralizedAlpha.generalized_alpha(0.6)),
    ],
)
@pytest.mark.parametrize("newton", ["mip", "plain"])
@pytest.mark.parametrize("membrane", MEMBRANES)
def test_dynamic_run(
    membrane: MembraneRule,
    newton: Literal["mip", "plain"],
    options: dict[str, Any],
    method: reference.GeneralizedAlpha,
) -> None:
    """The pendulum of Dufva and Shabana (2005), 2 x 2 elements, with a start that bends and stretches it."""
    mesh, until, step = reference.RectangleMesh((0.3, 0.3), (2, 2)), 0.05, 5e-3
    plain = reference.Model(mesh, thickness=0.01, E=1e5, nu=0.3, density=7810, membrane=membrane)
    plain.fix("corner:x0y0", ["r"])
    plain.add_gravity((0, 0, -9.81))
    x, y = mesh.nodes.T
    velocity = np.zeros((len(x), 3, 3))
    velocity[:, 0, 0], velocity[:, 1, 0] = 2 * x, 2
    velocity[:, 0, 2], velocity[:, 1, 2], velocity[:, 2, 2] = 20 * x * y, 20 * y, 20 * x
    start = velocity.ravel()
    tight = reference.NewtonOptions(newton, tolerance=1e-11)
    expected = reference.simulate(plain, until, step, method, velocity=start, options=tight)
    model = ancf.Model(
        bodies={"plate": plate(plain, membrane)},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
    )
    result = ancf.simulate(
        model, until=until, step=step, velocity=start, newton=newton, tolerance=1e-11, every=step, **options
    )
    np.testing.assert_allclose(result.t, expected.t, rtol=1e-12)
    for found, known in ((result.q, expected.q), (result.v, expected.v), (result.a, expected.a)):
        np.testing.assert_allclose(found, known, rtol=0, atol=1e-8 * np.abs(known).max())
    energies = expected.energies(plain)
    scale = energies["kinetic"].max()
    for name, known in energies.items():
        np.testing.assert_allclose(getattr(result.energy, name), known, rtol=0, atol=1e-8 * scale)
    momentum = np.array([plain.momentum(v) for v in expected.v])
    angular = np.array([plain.angular_momentum(q, v) for q, v in zip(expected.q, expected.v, strict=True)])
    for found, known in ((result.momentum, momentum), (result.angular_momentum, angular)):
        np.testing.assert_allclose(found, known, rtol=0, atol=1e-8 * np.abs(known).max())
