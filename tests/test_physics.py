"""What mechanics says of statics and motion, through the public interface: closed forms, conservation, invariance."""

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

import ancf

FloatArray = NDArray[np.float64]
Membrane = Literal["projected", "full", "lobatto"]
Curvature = Literal["paper", "koiter"]

MEMBRANES: list[Membrane] = ["projected", "full", "lobatto"]
METHODS: list[dict[str, Any]] = [
    *({"method": "hht", "alpha": alpha} for alpha in (0.0, -0.05, -0.2, -1 / 3)),
    *({"method": "generalized_alpha", "rho_inf": rho} for rho in (0.0, 0.5, 0.8, 1.0)),
]
every_membrane = pytest.mark.parametrize("membrane", MEMBRANES)
every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: "-".join(map(str, method.values())))

STEEL = ancf.Material(E=2.07e11, nu=0.3, density=7810.0)
RUBBER = ancf.Material(E=1e5, nu=0.3, density=7810.0)
GRAVITY = ancf.Gravity(acceleration=(0.0, 0.0, -9.81))


def cantilever(divisions: tuple[int, int], membrane: Membrane, curvature: Curvature = "paper") -> ancf.Model:
    """Steel, 30 N as a dead line load on the free edge; Dufva and Shabana (2005)."""
    plate = ancf.Rectangle(
        size=(0.5, 0.15), divisions=divisions, thickness=1e-3, material=STEEL, membrane=membrane, curvature=curvature
    )
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
        probes=[ancf.Probe(name="corner", at=(0.5, 0.15), quantity="displacement")],
    )


@pytest.mark.parametrize(
    ("element", "membrane", "tolerance"),
    [
        ("thin36", "projected", 1e-4),
        ("thin36", "full", 3e-4),
        ("thin36", "lobatto", 1e-3),
        ("thin48", "projected", 1e-4),
        ("thin48", "full", 1e-4),
    ],
)
@pytest.mark.parametrize("elements", [1, 2, 8])
def test_a_strip_of_one_element_across_bends_in_its_plane_as_a_beam(
    element: Any, membrane: Membrane, tolerance: float, elements: int
) -> None:
    """Timoshenko's beam, whose section is held at one end but may shear there, which a clamped one may not."""
    L, b, h, E, P = 1.0, 0.1, 0.002, 1e7, 1e-7
    strip = ancf.Rectangle(
        size=(L, b),
        divisions=(elements, 1),
        thickness=h,
        material=ancf.Material(E=E, nu=0.0),
        element=element,
        membrane=membrane,
    )
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", fix=["r", "r_y", "r_x.z"])],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, P / b, 0.0))],
        probes=[ancf.Probe(name="tip", at=(L, b / 2), quantity="displacement")],
    )
    tip = ancf.solve_static(model, tolerance=1e-10).probes["tip"].value[-1, 1]
    bending, shear = P * L**3 / (3 * E * h * b**3 / 12), 1.2 * P * L / (E / 2 * h * b)
    assert tip == pytest.approx(bending + shear, rel=tolerance)


@pytest.mark.parametrize(
    ("element", "membrane", "divisions", "tolerance"),
    [
        ("thin36", "projected", (8, 1), 0.016),
        ("thin36", "projected", (32, 4), 0.0015),
        ("thin48", "projected", (8, 1), 0.018),
        ("thin36", "full", (8, 1), 0.0015),
        ("thin36", "lobatto", (8, 1), 0.0015),
    ],
)
def test_a_strip_curved_in_its_plane_bends_as_a_curved_beam(
    element: Any, membrane: Membrane, divisions: tuple[int, int], tolerance: float
) -> None:
    """A quarter of a ring under a radial force in its plane: pi P R (R / e - 1 + 6 E / (5 G)) / (4 A E), by Winkler.

    Its end may shear. Where lines across stretch to cubics for nothing the strip bends much too far.
    """
    R, b, h, E, P = 1.0, 0.1, 0.002, 1e7, 1e-7
    quarter = np.pi / 2
    strip = ancf.Surface(
        domain=((0.0, quarter), (R - b / 2, R + b / 2)),
        position=lambda x, y: (y * np.cos(x), y * np.sin(x), 0 * x),
        divisions=divisions,
        thickness=h,
        material=ancf.Material(E=E, nu=0.0),
        element=element,
        membrane=membrane,
    )
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", fix=["r", "r_y", "r_x.z"])],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, P / b, 0.0))],
        probes=[ancf.Probe(name="tip", at=(quarter, R), quantity="displacement")],
    )
    tip = ancf.solve_static(model, tolerance=1e-10).probes["tip"].value[-1, 1]
    neutral = b / np.log((R + b / 2) / (R - b / 2))
    assert tip == pytest.approx(np.pi * P * R / (4 * b * h * E) * (R / (R - neutral) - 1 + 2.4), rel=tolerance)


def test_a_curved_strip_of_one_element_across_twists_as_a_beam() -> None:
    """A quarter of a ring, clamped, and a force across its plane: P R^3 ((3 pi / 4 - 2) / (G J) + pi / (4 E I))."""
    R, b, h, E = 1.0, 0.02, 0.0002, 2e11
    twisting, bending = E / 2 * b * h**3 / 3 * (1 - 0.63 * h / b), E * h * b**3 / 12
    P = 1e-4 * twisting
    quarter = np.pi / 2
    strip = ancf.Cylinder(
        radius=R,
        angle=(0.0, quarter),
        length=(0.0, b),
        divisions=(4, 1),
        thickness=h,
        material=ancf.Material(E=E, nu=0.0),
    )
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, P / b))],
        probes=[ancf.Probe(name="tip", at=(quarter, b / 2), quantity="displacement")],
    )
    result = ancf.solve_static(model)
    tip = result.probes["tip"].value[-1, 2]
    beam = P * R**3 * ((1.5 * quarter - 2) / twisting + quarter / (2 * bending))
    assert tip == pytest.approx(beam, rel=0.15)  # the coarse mesh; half of the beam where x^2 in E_xy counts fully
    # Nor does what carries no energy show as a force, which would be thousands of times as large.
    points = [(along * quarter, across * b) for along in (0.3, 0.45, 0.55, 0.7) for across in (0.2, 0.5, 0.8)]
    assert np.abs(result.evaluate("strip", points, "membrane_force")[-1, :, 2]).max() < 10 * P / b


def pendulum(divisions: tuple[int, int], acceleration: float = -9.81) -> ancf.Model:
    """Rubber, hung at a corner; Dufva and Shabana (2005)."""
    plate = ancf.Rectangle(size=(0.3, 0.3), divisions=divisions, thickness=0.01, material=RUBBER, membrane="full")
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, acceleration))],
        probes=[ancf.Probe(name="A", at=(0.3, 0.3))],
    )


@every_membrane
def test_a_narrow_strip_bends_as_a_beam(membrane: Membrane) -> None:
    """P L^3 / (3 E I) for nu = 0 and a deflection so small that the rest is linear."""
    L, b, h, E, P = 1.0, 0.05, 0.01, 1e7, 1e-6
    strip = ancf.Rectangle(
        size=(L, b), divisions=(8, 1), thickness=h, material=ancf.Material(E=E, nu=0.0), membrane=membrane
    )
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, P / b))],
    )
    result = ancf.solve_static(model)
    tip = result.positions("strip", [(L, 0.0), (L, b / 2), (L, b)])[-1, :, 2]
    np.testing.assert_allclose(tip, P * L**3 / (3 * E * b * h**3 / 12), rtol=1e-4)
    np.testing.assert_allclose(result.energy.bending[-1], P * tip[1] / 2, rtol=1e-4)


@pytest.mark.parametrize(
    ("membrane", "curvature", "elements", "deflection", "tolerance"),
    [
        # An independent prototype, to the digits that it prints.
        ("projected", "paper", 1, -0.2739, 5.1e-5),
        ("projected", "paper", 2, -0.2832, 5.1e-5),
        ("projected", "paper", 4, -0.2847, 5.1e-5),
        ("lobatto", "koiter", 1, -0.2949, 5.1e-5),
        ("lobatto", "koiter", 2, -0.2865, 5.1e-5),
        ("lobatto", "koiter", 4, -0.2850, 5.1e-5),
        ("full", "paper", 4, -0.2817, 5.1e-5),
        # The NumPy path.
        ("full", "paper", 1, -0.183114, 1e-6),
        ("full", "paper", 2, -0.261603, 1e-6),
    ],
)
def test_the_cantilever_of_the_paper(
    membrane: Membrane, curvature: Curvature, elements: int, deflection: float, tolerance: float
) -> None:
    model = cantilever((elements, 1), membrane, curvature)
    result = ancf.solve_static(model, load_factors=np.linspace(0.1, 1.0, 10).tolist())
    assert result.probes["corner"].value[-1, 2] == pytest.approx(deflection, abs=tolerance)


def test_the_cantilever_converges_to_that_of_a_fine_mesh() -> None:
    result = ancf.solve_static(cantilever((16, 4), "projected"))
    assert result.probes["corner"].value[-1, 2] == pytest.approx(-0.286, abs=5e-4)


@pytest.mark.parametrize(
    ("divisions", "position"),
    [((2, 2), (0.2262966, 0.2262966, -0.4415658)), ((4, 4), (0.2284436, 0.2284436, -0.4465149))],
)
def test_the_pendulum_of_the_paper(divisions: tuple[int, int], position: tuple[float, float, float]) -> None:
    """Its corner after 0.3 s as the NumPy path has it with the same step."""
    result = ancf.simulate(pendulum(divisions), until=0.3, step=1e-3, alpha=0.0, outputs=[0.3])
    np.testing.assert_allclose(result.probes["A"].value[-1], position, rtol=0, atol=1e-6)


@every_method
@every_membrane
@pytest.mark.parametrize(("material", "thickness"), [(STEEL, 1e-3), (RUBBER, 1e-2)])
def test_free_fall(material: ancf.Material, thickness: float, membrane: Membrane, method: dict[str, Any]) -> None:
    """An unsupported plate falls as a rigid body, from the first step on: the first acceleration is gravity's."""
    g, step = np.array([1.0, -2.0, -9.81]), 0.01
    plate = ancf.Rectangle(size=(0.3, 0.2), divisions=(3, 2), thickness=thickness, material=material, membrane=membrane)
    model = ancf.Model(bodies={"plate": plate}, loads=[ancf.Gravity(acceleration=tuple(g))])
    result = ancf.simulate(model, until=10 * step, step=step, every=step, **method)
    q, v, a = ((x - x0).reshape(11, -1, 3, 3) for x, x0 in ((result.q, result.q[0]), (result.v, 0.0), (result.a, 0.0)))
    t, noise = result.t[:, None, None], 10 * np.finfo(float).eps * material.E / material.density / 0.1**2
    np.testing.assert_allclose(q[:, :, 0], np.broadcast_to(g * t**2 / 2, q[:, :, 0].shape), rtol=0, atol=1e-12)
    np.testing.assert_allclose(q[:, :, 1:], 0, rtol=0, atol=1e-12)
    # The first acceleration comes from the forces at rest: rounding of strains times E / (rho l^2). It stays, as its
    # forces do in the averages. Velocities are differences of positions over a step, accelerations over two.
    np.testing.assert_allclose(
        v[:, :, 0], np.broadcast_to(g * t, v[:, :, 0].shape), rtol=0, atol=1e-12 / step + noise * step
    )
    np.testing.assert_allclose(a[:, :, 0], np.broadcast_to(g, a[:, :, 0].shape), rtol=0, atol=1e-12 / step**2 + noise)


def spinning(
    material: ancf.Material, thickness: float, spin: Sequence[float], drift: Sequence[float]
) -> tuple[ancf.Model, FloatArray]:
    """A free plate and the velocities of a rigid motion about its centre."""
    plate = ancf.Rectangle(size=(0.3, 0.2), divisions=(4, 4), thickness=thickness, material=material)
    model = ancf.Model(bodies={"plate": plate})
    arms = model.nodal_coordinates().reshape(-1, 3, 3)
    arms[:, 0] -= (0.15, 0.1, 0.0)
    velocity = np.cross(spin, arms)
    velocity[:, 0] += drift
    return model, velocity.ravel()


@pytest.mark.parametrize("spin", [(0.0, 0.0, 10.0), (6.0, 1.0, 8.0)])
@every_method
@pytest.mark.parametrize(("material", "thickness"), [(STEEL, 1e-3), (RUBBER, 1e-2)])
def test_free_flight(
    material: ancf.Material, thickness: float, method: dict[str, Any], spin: tuple[float, float, float]
) -> None:
    """Momentum stays to rounding. Angular momentum does not: averaged forces keep it to second order in the step.

    Once the plate has stretched in its spin, c (omega h)^2 of it is lost, with c from 0.4 to 0.7, and up to 2.8 for
    rho_inf = 0, whatever the material. Less than 1e-10 asks for omega h = 1e-5, where rounding, about 1e-16 / (omega h)
    a step, begins to be as large.
    """
    model, velocity = spinning(material, thickness, spin, (1.0, 0.5, -0.2))
    losses = []
    for step in (1e-3, 5e-4):
        result = ancf.simulate(model, until=0.05, step=step, velocity=velocity, every=step, **method)
        p, L = result.momentum, result.angular_momentum
        np.testing.assert_allclose(p, np.tile(p[0], (len(p), 1)), rtol=0, atol=1e-10 * float(np.linalg.norm(p[0])))
        losses.append(np.linalg.norm(L - L[0], axis=1).max() / np.linalg.norm(L[0]))
    assert losses[0] < 3 * (np.linalg.norm(spin) * 1e-3) ** 2
    assert np.log2(losses[0] / losses[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(("material", "thickness"), [(STEEL, 1e-3), (RUBBER, 1e-2)])
def test_what_the_trapezoidal_rule_does_to_angular_momentum(material: ancf.Material, thickness: float) -> None:
    """A step changes it by -h/4 (q_1 - q_0) x M (a_1 - a_0) and by nothing else, to 1e-10.

    It is what q x F = 0 at both ends, M a = -F and the formulas for q_1 and v_1 leave of q_1 x M v_1 - q_0 x M v_0.
    M a = -F holds to what the last iteration leaves, so factorisations are not kept.
    """
    step = 1e-3
    model, velocity = spinning(material, thickness, (6.0, 1.0, 8.0), (1.0, 0.5, -0.2))
    result = ancf.simulate(model, until=0.05, step=step, velocity=velocity, every=step, alpha=0.0, reuse=False)
    rows, columns, values = model.assemble("constant").mass()
    q, a = (np.diff(x, axis=0) for x in (result.q, result.a))
    inertia = np.zeros_like(a)
    np.add.at(inertia.T, rows.astype(np.intp), (values * a[:, columns]).T)
    change = -step / 4 * np.cross(q.reshape(len(q), -1, 3), inertia.reshape(len(q), -1, 3)).sum(axis=1)
    L = result.angular_momentum
    assert np.abs(change).max() > 1e-7 * np.abs(L).max()
    np.testing.assert_allclose(np.diff(L, axis=0), change, rtol=0, atol=1e-10 * np.abs(L).max())


@every_method
def test_the_energy_balance_closes_to_second_order(method: dict[str, Any]) -> None:
    """Kinetic + strain - work of the pendulum after 0.1 s."""

    def balance(step: float) -> float:
        energy = ancf.simulate(pendulum((2, 2)), until=0.1, step=step, outputs=[0.1], **method).energy
        return float((energy.kinetic + energy.membrane + energy.bending - energy.loads)[-1])

    first, second = balance(5e-4), balance(2.5e-4)
    assert np.log2(first / second) == pytest.approx(2.0, abs=0.1)


def monomial_field(model: ancf.Model, n: int, nodes: FloatArray) -> FloatArray:
    """A cubic displacement that vanishes on the clamped edge x = 0 with its slopes: z = x^2 (1 + y), y = x^2 y."""
    x, y = nodes.T
    field = np.zeros((n, 3, 3))
    field[:, :, 2] = np.stack([x**2 * (1 + y), 2 * x * (1 + y), x**2], axis=1)
    field[:, :, 1] = np.stack([x**2 * y, 2 * x * y, x**2], axis=1)
    return field.ravel()


@pytest.mark.parametrize("divisions", [(1, 1), (2, 2), (5, 3)])
@pytest.mark.parametrize(
    ("load", "work"),
    [
        # Of rho h g, the force at its point, the force along the edge and the pressure on z = x^2 (1 + y), y = x^2 y
        # over [0, 2] x [0, 1], where all nodes of the first element at x = 0 are fixed.
        (ancf.Gravity(acceleration=(0.0, 3.0, -9.81)), 5.0 * 0.1 * (3.0 * 8 / 3 / 2 - 9.81 * 8 / 3 * 3 / 2)),
        (ancf.Force(at=(0.7, 0.4), force=(5.0, 2.0, 3.0)), 0.49 * (2.0 * 0.4 + 3.0 * 1.4)),
        (ancf.LineLoad(at="edge:x1", per_length=(1.0, 2.0, 3.0)), 4.0 * (2.0 / 2 + 3.0 * 3 / 2)),
        (ancf.LineLoad(at="edge:y1", per_length=(1.0, 2.0, 3.0)), 8 / 3 * (2.0 + 3.0 * 2)),
        (ancf.Pressure(pressure=7.0), 7.0 * 8 / 3 * 3 / 2),
    ],
    ids=["gravity", "force", "line x1", "line y1", "pressure"],
)
def test_the_work_of_a_load_does_not_depend_on_the_mesh(
    load: ancf.Gravity | ancf.Force | ancf.LineLoad | ancf.Pressure, work: float, divisions: tuple[int, int]
) -> None:
    """On a displacement that every mesh can follow and that the supports allow."""
    material = ancf.Material(E=1e5, nu=0.3, density=5.0)
    model = ancf.Model(
        bodies={"plate": ancf.Rectangle(size=(2.0, 1.0), divisions=divisions, thickness=0.1, material=material)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[load],
    )
    core = model.assemble("constant")
    nodes = core.nodes("plate")
    field = monomial_field(model, len(nodes), nodes)
    fixed = np.setdiff1d(np.arange(core.coordinates), core.free())
    assert not field[fixed].any()
    assert core.external_force(core.reference(), 0.0) @ field == pytest.approx(work, rel=1e-12)


def loaded_plate() -> ancf.Model:
    """More than 64 elements and 64 nodes, with dead and following loads."""
    plate = ancf.Rectangle(
        size=(0.4, 0.3), divisions=(11, 9), thickness=2e-3, material=ancf.Material(E=1e8, nu=0.3, density=1000.0)
    )
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[GRAVITY, ancf.Pressure(pressure=-10.0), ancf.Moment(at="edge:x1", per_length=0.01)],
    )


@pytest.mark.parametrize(
    "run",
    [
        lambda model, threads: ancf.solve_static(model, threads=threads),
        lambda model, threads: ancf.simulate(model, until=0.02, step=2e-3, threads=threads),
    ],
    ids=["static", "dynamic"],
)
def test_threads_do_not_change_a_bit(run: Callable[[ancf.Model, int | None], ancf.Result]) -> None:
    model = loaded_plate()
    one, *others = (run(model, threads) for threads in (1, 2, 4, None))
    assert np.abs(one.q[-1] - one.q[0]).max() > 1e-3
    for other in others:
        for name in ("t", "q", "v", "a", "momentum", "angular_momentum"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name), err_msg=name)
        for name in ("kinetic", "membrane", "bending", "loads"):
            np.testing.assert_array_equal(getattr(other.energy, name), getattr(one.energy, name), err_msg=name)


def scene_in_units(kilogram: float, metre: float, second: float) -> tuple[ancf.Model, float]:
    """A plate under its weight and a pressure, and the time until which it moves, in units of one's own."""
    newton, pascal = kilogram * metre / second**2, kilogram / metre / second**2
    material = ancf.Material(E=2e7 * pascal, nu=0.3, density=1000.0 * kilogram / metre**3)
    plate = ancf.Rectangle(size=(0.4 * metre, 0.3 * metre), divisions=(4, 3), thickness=0.01 * metre, material=material)
    model = ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[
            ancf.Gravity(acceleration=(0.0, 1.0 * metre / second**2, -9.81 * metre / second**2)),
            ancf.Pressure(pressure=-20.0 * pascal),
            ancf.Force(at="corner:x1y1", force=(0.0, 0.0, -0.2 * newton)),
            ancf.Moment(at="edge:x1", per_length=-0.05 * newton),
        ],
        probes=[ancf.Probe(name="corner", at=(0.4 * metre, 0.3 * metre))],
    )
    return model, 0.1 * second


@pytest.mark.parametrize("units", [(1e-3, 1e3, 1.0), (1e3, 1e2, 1e6)], ids=["t mm s", "g cm us"])
@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_units_do_not_matter(kind: str, units: tuple[float, float, float]) -> None:
    def corner(units: tuple[float, float, float]) -> Any:
        model, until = scene_in_units(*units)
        if kind == "static":
            result = ancf.solve_static(model, tolerance=1e-10)
        else:
            result = ancf.simulate(model, until=until, step=until / 50, every=until / 10, tolerance=1e-10)
        return result.probes["corner"].value / units[1]

    expected = corner((1.0, 1.0, 1.0))
    assert np.abs(expected[-1] - expected[0]).max() > 0.01
    np.testing.assert_allclose(corner(units), expected, rtol=0, atol=1e-9)


def test_mirror_images_of_statics() -> None:
    """At the plane of the plate, at its middle, and at the diagonal of the axes."""

    def end(held: str, loaded: str, force: tuple[float, float, float], size: tuple[float, float]) -> FloatArray:
        divisions = (4, 3) if size[0] > size[1] else (3, 4)
        model = ancf.Model(
            bodies={"plate": ancf.Rectangle(size=size, divisions=divisions, thickness=1e-3, material=STEEL)},
            supports=[ancf.Support(at=held, clamp=True)],
            loads=[ancf.LineLoad(at=loaded, per_length=force)],
        )
        points = np.array([(0.5, 0.0), (0.3, 0.1), (0.5, 0.3)])
        if held == "edge:x1":
            points[:, 0] = 0.5 - points[:, 0]
        if held == "edge:y0":
            points = points[:, ::-1]
        positions: FloatArray = ancf.solve_static(model, tolerance=1e-10).positions("plate", points)[-1]
        return positions

    expected = end("edge:x0", "edge:x1", (0.0, 3.0, -20.0), (0.5, 0.3))
    assert np.abs(expected[:, 2]).max() > 0.02
    up = end("edge:x0", "edge:x1", (0.0, 3.0, 20.0), (0.5, 0.3))
    np.testing.assert_allclose(up * (1, 1, -1), expected, rtol=0, atol=1e-9)
    right = end("edge:x1", "edge:x0", (0.0, 3.0, -20.0), (0.5, 0.3))
    np.testing.assert_allclose(right * (-1, 1, 1) + (0.5, 0, 0), expected, rtol=0, atol=1e-9)
    turned = end("edge:y0", "edge:y1", (3.0, 0.0, -20.0), (0.3, 0.5))
    np.testing.assert_allclose(turned[:, [1, 0, 2]], expected, rtol=0, atol=1e-9)


def test_mirror_images_of_motion() -> None:
    """Up instead of down, and x for y, which leaves the pendulum as it is."""
    down, up = (
        ancf.simulate(pendulum((3, 3), g), until=0.2, step=2e-3, every=0.05, tolerance=1e-11) for g in (-9.81, 9.81)
    )
    points = [(0.3, 0.1), (0.1, 0.3), (0.2, 0.2)]
    r = down.positions("plate", points)
    np.testing.assert_allclose(up.positions("plate", points) * (1, 1, -1), r, rtol=0, atol=1e-9)
    np.testing.assert_allclose(r[:, [1, 0, 2]][..., [1, 0, 2]], r, rtol=0, atol=1e-9)
