"""The Rust core against the NumPy path, which shares no code with it: random elements and states, and whole runs."""

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import ancf
from ancf import _core, reference
from ancf.bodies import NODAL_VECTORS
from ancf.reference.elements import ElementKind
from ancf.reference.loads import History
from ancf.reference.surface import Surface, SurfacePoints
from ancf.reference.thin import CurvatureKind, MembraneRule

FloatArray = NDArray[np.float64]
Pair = tuple[_core.Model, reference.Model]


class Variant(NamedTuple):
    """An element with its membrane and curvature, which a solid has not."""

    element: ElementKind
    membrane: MembraneRule | None = None
    curvature: CurvatureKind | None = None

    def plain(self) -> dict[str, Any]:
        """Arguments of the NumPy model."""
        return {key: value for key, value in self._asdict().items() if value is not None}


ELEMENTS: list[ElementKind] = list(get_args(ElementKind))
MEMBRANES: list[tuple[ElementKind, MembraneRule | None]] = [
    ("thin36", "projected"),
    ("thin36", "full"),
    ("thin36", "lobatto"),
    ("thin48", "projected"),
    ("thin48", "full"),
    ("full48a", None),
    ("full48b", None),
]
CURVATURES: list[CurvatureKind] = ["paper", "koiter"]
VARIANTS = [
    Variant(element, membrane, curvature)
    for element, membrane in MEMBRANES
    for curvature in (CURVATURES if membrane else [None])
]
EDGES = ["x0", "x1", "y0", "y1"]


class Shape(NamedTuple):
    """A reference shape for both paths, over a rectangle of parameters."""

    mesh: reference.RectangleMesh
    surface: Surface
    compiled: _core.Shape


def saddle(x: FloatArray, y: FloatArray) -> SurfacePoints:
    """A sheared patch with z = x y / 2 + x**2 / 3."""
    one, zero = np.ones_like(x), np.zeros_like(x)
    return SurfacePoints(
        np.stack([x + 0.3 * y, y, x * y / 2 + x**2 / 3], axis=-1),
        np.stack([one, zero, y / 2 + 2 * x / 3], axis=-1),
        np.stack([0.3 * one, one, x / 2], axis=-1),
        np.stack([zero, zero, one / 2], axis=-1),
    )


def make_shape(name: str, rng: np.random.Generator, divisions: tuple[int, int]) -> Shape:
    """One of the shapes with random sizes."""
    a, b = rng.uniform(0.2, 2.0, size=2)
    start, turn, width, R = rng.uniform(-1.0, 0.3), rng.uniform(0.1, 1.0), rng.uniform(0.2, 1.0), rng.uniform(0.5, 2.0)
    if name == "rectangle":
        return Shape(reference.RectangleMesh((a, b), divisions), reference.plane, _core.Shape.rectangle((a, b)))
    if name == "annulus":
        mesh = reference.RectangleMesh((a, turn), divisions, (R, 0.0))
        return Shape(mesh, reference.annulus, _core.Shape.annulus((R, R + a), turn))
    if name == "cylinder":
        mesh = reference.RectangleMesh((turn, a), divisions, (start, -b))
        compiled = _core.Shape.cylinder(R, (start, start + turn), (-b, a - b))
        return Shape(mesh, reference.cylinder(R), compiled)
    if name == "sphere":
        mesh = reference.RectangleMesh((turn, width), divisions, (start, -0.4))
        compiled = _core.Shape.sphere(R, (start, start + turn), (-0.4, width - 0.4))
        return Shape(mesh, reference.sphere(R), compiled)
    mesh = reference.RectangleMesh((a, b), divisions, (-0.3, 0.1))
    points = np.concatenate(saddle(*mesh.nodes.T), axis=1)
    return Shape(mesh, saddle, _core.Shape.nodes(((-0.3, a - 0.3), (0.1, b + 0.1)), divisions, points))


SHAPES = ["rectangle", "annulus", "cylinder", "sphere", "saddle"]
variants = pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: "-".join(variant.plain().values()))
elements = pytest.mark.parametrize("element", ELEMENTS)
shapes = pytest.mark.parametrize("shape", SHAPES)
seeds_and_meshes = pytest.mark.parametrize(("seed", "divisions"), [(0, (1, 1)), (1, (3, 2))])


def pair(
    rng: np.random.Generator,
    shape: str,
    divisions: tuple[int, int],
    variant: Variant,
    E: float | None = None,
) -> Pair:
    """The same body in Rust and in NumPy, of random size, thickness and material."""
    mesh, surface, compiled = make_shape(shape, rng, divisions)
    thickness = 10 ** rng.uniform(-3, -0.5)
    E = E or 10 ** rng.uniform(3, 11)
    nu, density = rng.uniform(-0.3, 0.45), rng.uniform(1e2, 1e4)
    rust = _core.Model()
    rust.add_body(
        "plate",
        compiled,
        divisions,
        thickness=thickness,
        E=E,
        nu=nu,
        density=density,
        mass_damping=0.0,
        viscosity=0.0,
        **variant._asdict(),
    )
    plain = reference.Model(mesh, thickness=thickness, E=E, nu=nu, density=density, surface=surface, **variant.plain())
    return rust, plain


def moved(rng: np.random.Generator, model: reference.Model, deformation: float = 0.2) -> FloatArray:
    """Any rotation and translation, and a random change of all nodal vectors that is large for gradients."""
    vectors = model.reference.reshape(-1, len(model.vectors), 3).copy()
    # Each kind of vector has its own unit: positions those of an element, gradients those of the parameters.
    extent = np.ptp(vectors[model.mesh.cells[0], 0], axis=0).max()
    unit = np.linalg.norm(vectors, axis=2, keepdims=True).mean(axis=0, keepdims=True)
    unit[0, 0] = extent
    if "r_xy" in model.vectors:
        unit[0, 3] = extent / np.prod(model.mesh.sides)
    vectors += deformation * unit * rng.normal(size=vectors.shape)
    vectors = vectors @ Rotation.random(rng=rng).as_matrix().T
    vectors[:, 0] += rng.normal(size=3)
    return vectors.ravel()


def matrix(triplets: tuple[NDArray[np.uint64], NDArray[np.uint64], FloatArray], n: int) -> FloatArray:
    rows, columns, values = triplets
    return sp.coo_array((values, (rows.astype(np.intp), columns.astype(np.intp))), shape=(n, n)).toarray()


def assert_agree(found: FloatArray, expected: FloatArray) -> None:
    """To 1e-10 of the largest entry."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_both_know_the_same_elements(element: ElementKind) -> None:
    assert list(NODAL_VECTORS) == ELEMENTS
    _, plain = pair(np.random.default_rng(0), "rectangle", (1, 1), Variant(element))
    assert plain.vectors == NODAL_VECTORS[element]


@variants
@shapes
@seeds_and_meshes
def test_energy_and_its_derivatives(variant: Variant, shape: str, seed: int, divisions: tuple[int, int]) -> None:
    rng = np.random.default_rng(seed)
    rust, plain = pair(rng, shape, divisions, variant)
    np.testing.assert_allclose(rust.reference(), plain.reference, rtol=0, atol=1e-14)
    q = moved(rng, plain)
    np.testing.assert_allclose(rust.energy(q), plain.energy(q), rtol=1e-10)
    assert_agree(rust.internal_force(q), plain.internal_force(q))
    assert_agree(matrix(rust.tangent(q), len(q)), plain.tangent(q).toarray())


@variants
@shapes
def test_tangent_of_mixed_integration_points(variant: Variant, shape: str) -> None:
    rng = np.random.default_rng(2)
    rust, plain = pair(rng, shape, (2, 1), variant)
    previous = moved(rng, plain)
    q = previous + 0.1 * rng.normal(size=previous.shape)
    expected = plain.tangent(q, plain.extrapolated_stress(previous, q - previous)).toarray()
    assert np.abs(expected - plain.tangent(q).toarray()).max() > 1e-3 * np.abs(expected).max()
    assert_agree(matrix(rust.tangent(q, previous=previous), len(q)), expected)


@elements
@shapes
def test_mass(element: ElementKind, shape: str) -> None:
    rust, plain = pair(np.random.default_rng(3), shape, (3, 2), Variant(element))
    assert_agree(matrix(rust.mass(), rust.coordinates), plain.mass.toarray())


def add_gravity(rust: _core.Model, plain: reference.Model, history: History) -> None:
    rust.add_gravity((1.0, 2.0, -9.81), history)
    plain.add_gravity((1.0, 2.0, -9.81), history)


def add_force(rust: _core.Model, plain: reference.Model, history: History) -> None:
    x, y = np.array(plain.mesh.origin) + np.array((0.45, 0.8)) * plain.mesh.size
    rust.add_force("plate", (x, y), (3.0, -1.0, 2.0), history)
    plain.add_force((x, y), (3.0, -1.0, 2.0), history)


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


@pytest.mark.parametrize("add", [add_gravity, add_force, add_line_loads, add_moments, add_pressure])
@elements
@shapes
def test_loads_and_their_stiffness(
    add: Callable[[_core.Model, reference.Model, History], None], element: ElementKind, shape: str
) -> None:
    """On a material so soft that the elastic tangent does not hide that of the loads, whose symmetric part counts."""
    rng = np.random.default_rng(4)
    rust, plain = pair(rng, shape, (2, 1), Variant(element), E=1.0)
    add(rust, plain, "constant")
    q, t = moved(rng, plain), 0.7
    assert_agree(rust.external_force(q, t), plain.external_force(q, t))
    expected = plain.tangent(q) - plain.load_stiffness(q, t)
    assert_agree(matrix(rust.tangent(q, t), len(q)), expected.toarray())


@pytest.mark.parametrize("history", ["ramp", [(0.0, 1.0), (0.5, -2.0), (1.0, 4.0)]])
@pytest.mark.parametrize("add", [add_gravity, add_moments])
def test_histories(add: Callable[[_core.Model, reference.Model, History], None], history: History) -> None:
    rng = np.random.default_rng(0)
    rust, plain = pair(rng, "rectangle", (1, 1), Variant("thin36"))
    add(rust, plain, history)
    q = moved(rng, plain)
    for t in (-0.3, 0.2, 0.7, 1.5):
        assert_agree(rust.external_force(q, t), plain.external_force(q, t))


class Common(NamedTuple):
    """Thickness and material of both paths."""

    thickness: float
    E: float
    nu: float
    density: float

    @property
    def body(self) -> dict[str, Any]:
        """Arguments of a body of the public interface."""
        return {
            "thickness": self.thickness,
            "material": ancf.Material(E=self.E, nu=self.nu, density=self.density),
        }


STEEL, RUBBER = Common(1e-3, 2.07e11, 0.3, 7810.0), Common(0.01, 1e5, 0.3, 7810.0)
runs = pytest.mark.parametrize(("element", "membrane"), MEMBRANES)
newtons = pytest.mark.parametrize("newton", ["mip", "plain"])


@runs
@newtons
def test_static_run(element: ElementKind, membrane: MembraneRule | None, newton: Literal["mip", "plain"]) -> None:
    """The cantilever of Dufva and Shabana (2005), 2 x 1 elements."""
    factors, mesh = [0.25, 0.5, 1.0], reference.RectangleMesh((0.5, 0.15), (2, 1))
    plain = reference.Model(mesh, **STEEL._asdict(), **Variant(element, membrane).plain())
    plain.clamp("edge:x0")
    plain.add_line_load("x1", (0, 0, -200), "ramp")
    expected = reference.solve_static(plain, factors, reference.NewtonOptions(newton, tolerance=1e-10))
    body = ancf.Rectangle(size=mesh.size, divisions=mesh.divisions, element=element, membrane=membrane, **STEEL.body)
    model = ancf.Model(
        bodies={"plate": body},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
    )
    result = ancf.solve_static(model, load_factors=factors, newton=newton, tolerance=1e-10)
    assert np.abs(expected.q[-1] - plain.reference).max() > (0.2 if membrane else 0.02)
    np.testing.assert_allclose(result.q[1:], expected.q, rtol=0, atol=1e-8)


@runs
def test_static_run_of_a_shell(element: ElementKind, membrane: MembraneRule | None) -> None:
    """A curved panel clamped at one end, bent by a moment and a pressure, which both follow it."""
    factors = [0.5, 1.0]
    mesh = reference.RectangleMesh((0.8, 0.5), (2, 2), (0.2, -0.1))
    plain = reference.Model(
        mesh, **RUBBER._asdict(), **Variant(element, membrane).plain(), surface=reference.cylinder(0.3)
    )
    plain.clamp("edge:y0")
    plain.add_moment("y1", 0.005, "ramp")
    plain.add_pressure(0.05, "ramp")
    expected = reference.solve_static(plain, factors, reference.NewtonOptions(tolerance=1e-11))
    body = ancf.Cylinder(
        radius=0.3,
        angle=(0.2, 1.0),
        length=(-0.1, 0.4),
        divisions=(2, 2),
        element=element,
        membrane=membrane,
        **RUBBER.body,
    )
    model = ancf.Model(
        bodies={"shell": body},
        supports=[ancf.Support(at="edge:y0", clamp=True)],
        loads=[ancf.Moment(at="edge:y1", per_length=0.005), ancf.Pressure(pressure=0.05)],
    )
    result = ancf.solve_static(model, load_factors=factors, tolerance=1e-11)
    assert np.abs(expected.q[-1] - plain.reference).max() > 1e-3
    np.testing.assert_allclose(result.q[1:], expected.q, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("newton", "step", "options", "method"),
    [
        ("mip", 5e-3, {"method": "hht", "alpha": 0.0}, reference.GeneralizedAlpha.hht(0.0)),
        ("plain", 5e-3, {"method": "hht", "alpha": -0.3}, reference.GeneralizedAlpha.hht(-0.3)),
        (
            "mip",
            5e-3,
            {"method": "generalized_alpha", "rho_inf": 0.6},
            reference.GeneralizedAlpha.generalized_alpha(0.6),
        ),
        ("mip", 5e-3, {"method": "tr_bdf2"}, reference.RungeKutta.tr_bdf2()),
        ("mip", 5e-3, {"method": "esdirk"}, reference.RungeKutta.esdirk()),
        ("mip", 5e-3, {"method": "energy_momentum"}, reference.EnergyMomentum()),
        ("mip", 5e-4, {"method": "verlet"}, reference.Verlet()),
        ("mip", 5e-4, {"method": "verlet", "lumped": True}, reference.Verlet()),
        ("mip", 5e-4, {"method": "rk"}, reference.RungeKutta.dormand_prince()),
    ],
)
@runs
def test_dynamic_run(
    *,
    element: ElementKind,
    membrane: MembraneRule | None,
    newton: Literal["mip", "plain"],
    step: float,
    options: dict[str, Any],
    method: reference.Method,
) -> None:
    """The pendulum of Dufva and Shabana (2005), 2 x 2 elements, with a start that bends and stretches it.

    Explicit methods take steps below the limit of every element.
    """
    mesh, until = reference.RectangleMesh((0.3, 0.3), (2, 2)), 10 * step
    plain = reference.Model(mesh, **RUBBER._asdict(), **Variant(element, membrane).plain())
    plain.fix("corner:x0y0", ["r"])
    if options.get("lumped"):
        plain.lump_mass()
    plain.add_gravity((0, 0, -9.81))
    x, y = mesh.nodes.T
    velocity = np.zeros((len(x), len(plain.vectors), 3))
    velocity[:, 0, 0], velocity[:, 1, 0] = 2 * x, 2
    velocity[:, 0, 2], velocity[:, 1, 2], velocity[:, 2, 2] = 20 * x * y, 20 * y, 20 * x
    if element == "thin48":
        velocity[:, 3, 2] = 20
    if membrane is None:
        velocity[:, 3, 0], velocity[:, 3, 1] = -20 * y, -20 * x
    start = velocity.ravel()
    tight = reference.NewtonOptions(newton, tolerance=1e-11)
    expected = reference.simulate(plain, until, step, method, velocity=start, options=tight)
    body = ancf.Rectangle(size=mesh.size, divisions=mesh.divisions, element=element, membrane=membrane, **RUBBER.body)
    model = ancf.Model(
        bodies={"plate": body},
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
