"""What supports exert: closed forms, balances of momentum, and the NumPy path."""

from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

import ancf
from ancf import reference
from ancf.loads import Load
from ancf.output import summarize
from ancf.reference.dynamics import Equations
from ancf.report import describe
from ancf.run import Method

FloatArray = NDArray[np.float64]
Element = Literal["thin36", "thin48", "full48a", "full48b"]

ELEMENTS: list[Element] = ["thin36", "thin48", "full48a", "full48b"]
STEEL = ancf.Material(E=2.1e11, nu=0.3, density=7800.0)
RUBBER = ancf.Material(E=1e6, nu=0.3, density=1000.0)
G = (0.0, 0.0, -9.81)
LENGTH, WIDTH, THICKNESS = 1.0, 0.1, 0.01


def strip(material: ancf.Material = STEEL, **settings: Any) -> ancf.Rectangle:
    given: dict[str, Any] = {"size": (LENGTH, WIDTH), "divisions": (6, 1), "thickness": THICKNESS}
    return ancf.Rectangle(material=material, **given | settings)


def model(body: ancf.Rectangle, *items: ancf.Support | Load) -> ancf.Model:
    supports = [item for item in items if isinstance(item, ancf.Support)]
    loads = [item for item in items if not isinstance(item, ancf.Support)]
    return ancf.Model(bodies={"strip": body}, supports=supports, loads=loads)


def total(result: ancf.Result) -> FloatArray:
    """The forces of all supports together, (states, 3)."""
    return np.asarray(sum(reaction.force for reaction in result.reactions))


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_cantilever_holds_the_force_at_its_end(element: Element) -> None:
    """Reference: equilibrium of the deflected strip, force F and moment (r_tip - r_root) x F."""
    F = np.array([3.0, -5.0, -40.0])
    end = ancf.LineLoad(at="edge:x1", per_length=tuple(F / WIDTH))
    held = model(strip(element=element), ancf.Support(at="edge:x0", clamp=True), end)
    result = ancf.solve_static(held, load_factors=(0.5, 1.0))
    (reaction,) = result.reactions
    tip = result.positions("strip", [(LENGTH, WIDTH / 2)])[:, 0]
    assert reaction.support is held.supports[0]
    np.testing.assert_allclose(reaction.point, np.tile([0.0, WIDTH / 2, 0.0], (3, 1)), atol=1e-15)
    for t, force, moment, place in zip(reaction.t, reaction.force, reaction.moment, tip, strict=True):
        np.testing.assert_allclose(force, -t * F, rtol=0, atol=1e-6)
        # The end load acts along the whole edge; its resultant passes its middle but for what the edge bends.
        np.testing.assert_allclose(moment, -np.cross(place - [0, WIDTH / 2, 0], t * F), rtol=0, atol=1e-4)
    np.testing.assert_allclose(reaction.moment[-1][1], F[2] * LENGTH, rtol=2e-3)


def test_corners_that_hold_a_plate_carry_its_weight_and_share_it_alike() -> None:
    plate = ancf.Rectangle(size=(0.4, 0.3), divisions=(4, 4), thickness=THICKNESS, material=STEEL)
    corners = ["corner:x0y0", "corner:x1y0", "corner:x1y1", "corner:x0y1"]
    supports = [ancf.Support(at=corners[0], fix=["r"]), *(ancf.Support(at=c, fix=["r.z"]) for c in corners[1:])]
    held = model(plate, *supports, ancf.Support(at="corner:x1y0", fix=["r.y"]), ancf.Gravity(acceleration=G))
    result = ancf.solve_static(held)
    quarter = 0.4 * 0.3 * THICKNESS * STEEL.density * 9.81 / 4
    for reaction in result.reactions[:4]:
        np.testing.assert_allclose(reaction.force[-1], [0, 0, quarter], rtol=1e-7, atol=1e-6 * quarter)
        np.testing.assert_allclose(reaction.moment[-1], 0, atol=1e-12)


def test_a_plane_of_symmetry_gives_what_the_missing_half_gives() -> None:
    """Reference: Euler and Bernoulli, a strip clamped at both ends: w L^2 / 12 there, w L^2 / 24 in the middle."""
    weight = 0.1 * STEEL.density * LENGTH * WIDTH * THICKNESS
    half = model(
        strip(size=(LENGTH / 2, WIDTH), material=ancf.Material(E=2.1e11, nu=0.0, density=7800.0)),
        ancf.Support(at="edge:x0", clamp=True),
        ancf.Support(at="edge:x1", symmetry="x"),
        ancf.Gravity(acceleration=(0.0, 0.0, -0.1)),
    )
    end, middle = ancf.solve_static(half, tolerance=1e-11).reactions
    np.testing.assert_allclose([end.force[-1, 2], middle.force[-1, 2]], [weight / 2, 0], atol=1e-6 * weight)
    # The ends do not come closer, so that the deflected strip is stretched.
    np.testing.assert_allclose(end.force[-1, 0], -middle.force[-1, 0], rtol=1e-3)
    np.testing.assert_allclose(end.moment[-1][1], -weight * LENGTH / 12, rtol=1e-3)
    np.testing.assert_allclose(middle.moment[-1][1], -weight * LENGTH / 24, rtol=1e-3)


def test_pressure_on_a_plate_held_all_around_pushes_as_on_its_opening() -> None:
    """Reference: Gauss's theorem. The integral of the normal over a surface is that over any other with its rim."""
    plate = ancf.Rectangle(size=(0.4, 0.3), divisions=(4, 3), thickness=1e-3, material=RUBBER)
    edges = [ancf.Support(at=f"edge:{edge}", clamp=True) for edge in ("x0", "x1", "y0", "y1")]
    result = ancf.solve_static(model(plate, *edges, ancf.Pressure(pressure=20.0)))
    middle = result.positions("strip", [(0.2, 0.15)])[-1, 0, 2]
    assert middle > 0.01
    np.testing.assert_allclose(total(result)[-1], [0, 0, -20.0 * 0.4 * 0.3], rtol=1e-8, atol=1e-8)


METHODS: list[tuple[Method, float]] = [
    ("hht", 2e-3),
    ("generalized_alpha", 4e-3),
    ("newmark", 2e-3),
    ("energy_momentum", 4e-3),
    ("tr_bdf2", 2e-3),
    ("esdirk", 2e-3),
    ("verlet", 2e-3),
    ("rk", 2e-3),
]


@pytest.mark.parametrize(("method", "share"), METHODS)
def test_a_pendulum_is_held_by_what_changes_its_momentum(method: Method, share: float) -> None:
    """Reference: m (a_cm - g) and the change of the angular momentum, by differences over two steps."""
    step, mass = 2e-4, RUBBER.density * LENGTH * WIDTH * THICKNESS
    plate = strip(RUBBER, divisions=(4, 1), membrane="full")
    held = model(plate, ancf.Support(at="corner:x0y0", fix=["r"]), ancf.Gravity(acceleration=G))
    result = ancf.simulate(held, until=0.1, step=step, every=step, method=method)
    (reaction,) = result.reactions
    change = (result.momentum[2:] - result.momentum[:-2]) / (2 * step)
    np.testing.assert_allclose(reaction.force[1:-1], change - mass * np.array(G), rtol=0, atol=share * mass * 9.81)
    np.testing.assert_array_equal(reaction.point, 0.0)
    np.testing.assert_allclose(reaction.moment, 0, atol=1e-15)


def test_of_a_lumped_mass_supports_carry_the_whole_weight() -> None:
    """Reference: m g of a body held at every node, and m (a_cm - g) of one that hangs at a corner, by differences."""
    step, weight = 2e-4, RUBBER.density * LENGTH * WIDTH * THICKNESS * np.array(G)
    plate, gravity = strip(RUBBER, divisions=(4, 1), membrane="full"), ancf.Gravity(acceleration=G)
    for support in (ancf.Support(at="all", clamp=True), ancf.Support(at="corner:x0y0", fix=["r"])):
        held = model(plate, support, gravity)
        result = ancf.simulate(held, until=0.05, step=step, every=step, method="verlet", lumped=True)
        change = (result.momentum[2:] - result.momentum[:-2]) / (2 * step)
        np.testing.assert_allclose(
            result.reactions[0].force[1:-1], change - weight, rtol=0, atol=2e-3 * np.abs(weight).max()
        )
        if support.clamp:
            np.testing.assert_allclose(result.reactions[0].force, np.tile(-weight, (result.states, 1)), rtol=1e-12)


def test_a_swinging_bar_pulls_at_its_hinge_as_in_the_textbooks() -> None:
    """Reference: a bar released level, at the angle u below: 5/2 m g sin u along it, 1/4 m g cos u across."""
    bar = strip(RUBBER, divisions=(2, 1), thickness=0.05)
    held = model(bar, ancf.Support(at="edge:x0", fix=["r"]), ancf.Gravity(acceleration=G))
    result = ancf.simulate(held, until=0.45, rtol=1e-6, method="rigid", outputs=[0.1, 0.2, 0.3, 0.4, 0.45])
    tip = result.positions("strip", [(LENGTH, WIDTH / 2)])[:, 0] - [0, WIDTH / 2, 0]
    along = tip / np.linalg.norm(tip, axis=1)[:, None]
    across = np.cross([0.0, 1.0, 0.0], along)
    weight = RUBBER.density * LENGTH * WIDTH * 0.05 * 9.81
    sine, cosine = -along[:, [2]], along[:, [0]]
    expected = -2.5 * weight * sine * along + 0.25 * weight * cosine * -across
    np.testing.assert_allclose(result.reactions[0].force, expected, rtol=0, atol=1e-5 * weight)


def test_a_body_that_is_carried_takes_the_force_of_its_inertia_and_damping() -> None:
    """Reference: m (a + c v) of a body that every node carries along."""
    damped = RUBBER.model_copy(update={"mass_damping": 3.0})
    shake = ancf.Shake(amplitude=(0.01, 0.0, 0.02), frequency=4.0)
    result = ancf.simulate(model(strip(damped), ancf.Support(at="all", clamp=True, shake=shake)), until=0.5, step=1e-3)
    mass, omega = RUBBER.density * LENGTH * WIDTH * THICKNESS, 8 * np.pi
    wave = -(omega**2) * np.sin(omega * result.t) + 3.0 * omega * np.cos(omega * result.t)
    expected = mass * np.outer(wave, [0.01, 0.0, 0.02])
    np.testing.assert_allclose(result.reactions[0].force, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(result.reactions[0].point[:, 0], LENGTH / 2 + 0.01 * np.sin(omega * result.t))


@pytest.mark.parametrize("method", ["hht", "generalized_alpha", "energy_momentum", "tr_bdf2"])
def test_momentum_is_balanced_to_second_order_whenever_accelerations_are_known(method: Method) -> None:
    """Of a shaken plate that weighs something: halved steps divide what dP/dt - m g lacks of the reaction by four."""
    weight = 1000.0 * LENGTH * WIDTH * THICKNESS * np.array(G)
    clamp = ancf.Support(at="edge:x0", clamp=True, shake=ancf.Shake(amplitude=(0.0, 0.0, 0.02), frequency=4.0))
    body = strip(ancf.Material(E=1e7, nu=0.3, density=1000.0), divisions=(4, 1))
    shaken, errors = model(body, clamp, ancf.Gravity(acceleration=G)), []
    for step in (8e-4, 4e-4):
        result = ancf.simulate(shaken, until=0.096, step=step, every=step, method=method, tolerance=1e-11)
        change = (result.momentum[2:] - result.momentum[:-2]) / (2 * step)
        missing = (result.reactions[0].force[1:-1] + weight - change)[result.t[1:-1] > 0.03]
        errors.append(np.abs(missing).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)


def test_a_damped_strip_on_a_shaken_clamp_keeps_the_balance_of_momentum() -> None:
    """Reference: dP/dt + c P = R, and dL/dt + c L = M about the origin, by differences, after the jerk of the start."""
    damped = RUBBER.model_copy(update={"mass_damping": 3.0, "viscosity": 1e-3})
    clamp = ancf.Support(at="edge:x0", clamp=True, shake=ancf.Shake(amplitude=(0.0, 0.0, 0.02), frequency=4.0))
    step = 2.5e-4
    result = ancf.simulate(model(strip(damped), clamp), until=0.1, step=step, every=step, method="esdirk")
    (reaction,) = result.reactions
    moment = reaction.moment + np.cross(reaction.point, reaction.force)
    for given, momentum in ((reaction.force, result.momentum), (moment, result.angular_momentum)):
        expected = (momentum[2:] - momentum[:-2]) / (2 * step) + 3.0 * momentum[1:-1]
        np.testing.assert_allclose(given[2:-1], expected[1:], rtol=0, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("damping", [{"mass_damping": 30.0}, {"viscosity": 1e-3}])
def test_damping_acts_on_what_a_support_moves_from_the_start(damping: dict[str, float]) -> None:
    """Reference: dP/dt + c P = R at t = 0, where the support moves and the body does not, by one difference."""
    clamp = ancf.Support(at="edge:x0", clamp=True, shake=ancf.Shake(amplitude=(0.0, 0.01, 0.0), frequency=5.0))
    step = 1e-7
    held = model(strip(RUBBER.model_copy(update=damping)), clamp)
    result = ancf.simulate(held, until=step, step=step, every=step, method="esdirk")
    (reaction,) = result.reactions
    expected = np.diff(result.momentum, axis=0) / step + damping.get("mass_damping", 0.0) * result.momentum[:1]
    np.testing.assert_allclose(reaction.force[:1], expected, rtol=0, atol=1e-3 * np.abs(expected).max())


def test_what_two_supports_hold_belongs_to_the_first() -> None:
    load = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -100.0))
    edge, corner = ancf.Support(at="edge:x0", clamp=True), ancf.Support(at="corner:x0y0", fix=["r"])
    alone = ancf.solve_static(model(strip(), edge, load)).reactions[0]
    first, second = ancf.solve_static(model(strip(), edge, corner, load)).reactions
    np.testing.assert_array_equal(first.force, alone.force)
    np.testing.assert_array_equal(second.force, 0.0)
    both = ancf.solve_static(model(strip(), corner, edge, load))
    assert both.reactions[0].force[-1, 2] != 0
    np.testing.assert_allclose(total(both), alone.force, rtol=1e-9, atol=1e-9)


def test_reactions_do_not_depend_on_the_number_of_threads() -> None:
    held = model(
        strip(RUBBER, divisions=(24, 6)), ancf.Support(at="edge:x0", fix=["r", "r_x"]), ancf.Gravity(acceleration=G)
    )
    runs = [ancf.simulate(held, until=0.02, step=2e-3, threads=threads) for threads in (1, 2, 3)]
    for other in runs[1:]:
        np.testing.assert_array_equal(other.reactions[0].force, runs[0].reactions[0].force)
        np.testing.assert_array_equal(other.reactions[0].moment, runs[0].reactions[0].moment)


def test_between_steps_reactions_are_interpolated() -> None:
    held = model(strip(), ancf.Support(at="edge:x0", clamp=True), ancf.Gravity(acceleration=G))
    result = ancf.simulate(held, until=4e-3, step=1e-3, outputs=[1e-3, 1.25e-3, 1.5e-3, 2e-3])
    before, first, second, after = result.reactions[0].force[1:]
    np.testing.assert_allclose(first, before + (after - before) / 4, rtol=1e-12)
    np.testing.assert_allclose(second, (before + after) / 2, rtol=1e-12)


def test_of_a_rigid_body_with_two_supports_only_their_sum_is_determined() -> None:
    corners = [ancf.Support(at=corner, fix=["r"]) for corner in ("corner:x0y0", "corner:x0y1")]
    result = ancf.simulate(model(strip(), *corners, ancf.Gravity(acceleration=G)), until=0.1, rtol=1e-6, method="rigid")
    assert np.isnan([reaction.force for reaction in result.reactions]).all()
    assert summarize("", result)["reactions"][1]["force"][0] == [None] * 3


def test_the_summary_and_the_table_tell_the_reactions() -> None:
    held = model(strip(), ancf.Support(at="edge:x0", clamp=True), ancf.Gravity(acceleration=G))
    result = ancf.solve_static(held)
    (told,) = summarize("", result)["reactions"]
    assert (told["body"], told["at"], told["t"]) == ("strip", "edge:x0", [0.0, 1.0])
    for name in ("point", "force", "moment"):
        assert told[name] == getattr(result.reactions[0], name).tolist()
    assert f"{result.reactions[0].moment[-1, 1]:.6g} " in describe("", result).split('edge:x0" moment')[1]


@pytest.mark.parametrize("element", ELEMENTS)
def test_reactions_of_the_numpy_path_agree(element: Element) -> None:
    supports = [
        ancf.Support(at="edge:x0", fix=["r", "r_x.z"]),
        ancf.Support(at="edge:y1", fix=["r.z"]),
        ancf.Support(at=(0.3, 0.0), fix=["r_y"]),
    ]
    plain = reference.Model(
        reference.RectangleMesh((LENGTH, WIDTH), (3, 2)),
        thickness=THICKNESS,
        E=RUBBER.E,
        nu=RUBBER.nu,
        density=RUBBER.density,
        element=element,
    )
    for support in supports:
        plain.fix(support.at, support.fix)
    plain.add_gravity(G)
    body = strip(RUBBER, divisions=(3, 2), element=element)
    result = ancf.simulate(model(body, *supports, ancf.Gravity(acceleration=G)), until=0.04, step=4e-3)
    equations = Equations(plain, reference.NewtonOptions())
    for state, t in enumerate(result.t):
        at = equations.at(t, result.q[state], result.v[state])
        for reaction, expected in zip(result.reactions, plain.reactions(at.q, t, at.a), strict=True):
            np.testing.assert_allclose(reaction.point[state], expected.point, atol=1e-15)
            np.testing.assert_allclose(reaction.force[state], expected.force, rtol=0, atol=1e-9)
            np.testing.assert_allclose(reaction.moment[state], expected.moment, rtol=0, atol=1e-9)
