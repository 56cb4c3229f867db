"""Motions: rigid ones exact, the pendulum's energy, plate frequencies."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh

from ancf.reference import (
    EnergyMomentum,
    GeneralizedAlpha,
    Method,
    Model,
    NewtonOptions,
    RectangleMesh,
    RungeKutta,
    Verlet,
    simulate,
)
from ancf.reference.elements import ElementKind
from ancf.reference.thin import MembraneRule

METHODS: list[Method] = [
    GeneralizedAlpha.hht(0.0),
    GeneralizedAlpha.hht(-0.05),
    GeneralizedAlpha.hht(-1 / 3),
    GeneralizedAlpha.generalized_alpha(0.0),
    GeneralizedAlpha.generalized_alpha(0.8),
    RungeKutta.tr_bdf2(),
    RungeKutta.esdirk(),
    RungeKutta.dormand_prince(),
    EnergyMomentum(),
    Verlet(),
]


def pendulum(n: int) -> Model:
    """Rubber, 0.3 x 0.3 x 0.01 m, hung at a corner under gravity; Dufva and Shabana (2005)."""
    mesh = RectangleMesh((0.3, 0.3), (n, n))
    model = Model(mesh, thickness=0.01, E=1e5, nu=0.3, density=7810, membrane="full")
    model.fix("corner:x0y0", ["r"])
    model.add_gravity([0, 0, -9.81])
    return model


def test_special_cases() -> None:
    """alpha = 0 is the trapezoidal rule; rho_inf = 1 is the midpoint rule."""
    assert GeneralizedAlpha.hht(0.0) == GeneralizedAlpha(0.0, 0.0, 0.25, 0.5)
    assert GeneralizedAlpha.generalized_alpha(1.0) == GeneralizedAlpha(0.5, 0.5, 0.25, 0.5)


@pytest.mark.parametrize(("method", "lumped"), [*((method, False) for method in METHODS), (Verlet(), True)])
def test_free_fall(method: Method, lumped: bool) -> None:
    """An unsupported plate falls as a rigid body from the first step on."""
    mesh = RectangleMesh((0.3, 0.3), (2, 2))
    model = Model(mesh, thickness=0.01, E=1e5, nu=0.3, density=7810)
    if lumped:
        model.lump_mass()
    model.add_gravity([0, 0, -9.81])
    motion = simulate(model, 0.05, 0.01, method)
    fall = (motion.q - model.reference).reshape(6, -1, 3, 3)
    expected = np.zeros_like(fall)
    expected[:, :, 0, 2] = -9.81 / 2 * motion.t[:, None] ** 2
    np.testing.assert_allclose(fall, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("method", "order"),
    [
        (GeneralizedAlpha.generalized_alpha(0.8), 2),
        (RungeKutta.tr_bdf2(), 2),
        (RungeKutta.esdirk(), 4),
        (RungeKutta.dormand_prince(), 5),
        (EnergyMomentum(), 2),
        (Verlet(), 2),
    ],
)
def test_orders(method: Method, order: int) -> None:
    """Halving the step divides the change of the end by 2**order."""
    model, tight = pendulum(1), NewtonOptions(tolerance=1e-13)
    ends = [simulate(model, 0.08, 8e-3 / 2**k, method, options=tight).q[-1] for k in range(3)]
    changes = [np.abs(a - b).max() for a, b in pairwise(ends)]
    assert np.log2(changes[0] / changes[1]) == pytest.approx(order, abs=0.25)


def test_energy_momentum_keeps_both() -> None:
    """A free plate that turns and bends: kinetic and strain energy, momentum and angular momentum stay to rounding."""
    model = Model(RectangleMesh((0.3, 0.3), (1, 1)), thickness=0.01, E=1e6, nu=0.3, density=7810, membrane="full")
    (x, y), bend = model.mesh.nodes.T - 0.15, 120.0
    v = np.zeros((4, 3, 3))
    v[:, 0] = np.stack([1 - 5 * y, 5 * x, bend * (x * x - y * y + x * y)], axis=1)
    v[:, 1, 1], v[:, 2, 0] = 5, -5
    v[:, 1, 2], v[:, 2, 2] = bend * (2 * x + y), bend * (x - 2 * y)
    motion = simulate(model, 0.1, 2e-3, EnergyMomentum(), velocity=v.ravel(), options=NewtonOptions(tolerance=1e-13))
    energies = motion.energies(model)
    total = energies["kinetic"] + energies["membrane"] + energies["bending"]
    assert (total - energies["kinetic"]).max() > 0.05 * total[0]
    np.testing.assert_allclose(total, total[0], rtol=1e-11)
    momenta = np.array(
        [[model.momentum(v), model.angular_momentum(q, v)] for q, v in zip(motion.q, motion.v, strict=True)]
    )
    np.testing.assert_allclose(momenta, np.broadcast_to(momenta[0], momenta.shape), rtol=0, atol=1e-11 * momenta.max())


def test_free_flight() -> None:
    """A spinning plate without supports keeps its momentum; its angular momentum to the order of the step."""
    mesh = RectangleMesh((0.3, 0.3), (2, 2))
    model = Model(mesh, thickness=0.01, E=1e7, nu=0.3, density=7810)
    r = model.reference.reshape(-1, 3, 3)
    v = np.cross([3.0, 1.0, 5.0], r)
    v[:, 0] += [1.0, 0.5, -0.2]
    errors = []
    for step in (2e-3, 1e-3):
        motion = simulate(model, 0.02, step, GeneralizedAlpha.hht(0.0), velocity=v.ravel())
        p = np.array([model.momentum(v) for v in motion.v])
        np.testing.assert_allclose(p, np.broadcast_to(p[0], p.shape), rtol=1e-10)
        L = [model.angular_momentum(motion.q[k], motion.v[k]) for k in (0, -1)]
        errors.append(np.linalg.norm(L[1] - L[0]))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.3)


def test_pendulum_energy() -> None:
    """Kinetic + strain - work stays zero to second order in the step."""
    model, errors = pendulum(2), []
    for step in (5e-3, 2.5e-3):
        energy = simulate(model, 0.1, step, GeneralizedAlpha.hht(0.0)).energies(model)
        balance = energy["kinetic"] + energy["membrane"] + energy["bending"] - energy["loads"]
        errors.append(np.abs(balance).max())
    assert errors[1] < 1e-3 * np.abs(energy["loads"]).max()
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.3)


def test_pendulum_position() -> None:
    """Corner opposite the pin after 0.3 s, within 1.2 % of a prototype's (0.22382, 0.22382, -0.44059)."""
    model = pendulum(2)
    motion = simulate(model, 0.3, 5e-3, GeneralizedAlpha.hht(0.0))
    position = model.position((0.3, 0.3), motion.q[-1])
    assert position[0] == pytest.approx(position[1], abs=1e-9)
    np.testing.assert_allclose(position, [0.22382, 0.22382, -0.44059], rtol=0.012)


@pytest.mark.parametrize("membrane", ["full", "lobatto", "projected"])
def test_frequencies_of_a_free_square(membrane: MembraneRule) -> None:
    """omega a**2 sqrt(rho h / D) = 13.468; Schwab, Gerstmayr and Meijaard, DETC2007-34754."""
    h, n = 0.01, 8
    model = Model(RectangleMesh((1.0, 1.0), (n, n)), thickness=h, E=1.0, nu=0.3, density=1.0, membrane=membrane)
    out_of_plane = np.arange(2, model.coordinates, 3)
    K, M = (A[out_of_plane][:, out_of_plane].toarray() for A in (model.tangent(model.reference), model.mass))
    squares = eigh(K, M, eigvals_only=True)
    D = h**3 / (12 * (1 - 0.3**2))
    np.testing.assert_allclose(squares[:3], 0, atol=1e-10 * squares[3] + 1e-12)
    assert np.sqrt(squares[3] * h / D) == pytest.approx(13.468, rel=5e-3)


@pytest.mark.parametrize("element", ["thin36", "thin48"])
def test_the_lumped_frequency_converges_to_the_consistent_one(element: ElementKind) -> None:
    """Of a plate clamped at an edge: halved elements divide the difference by four."""
    differences = []
    for n in (4, 8, 16):
        model = Model(RectangleMesh((1.0, 1.0), (n, n)), thickness=0.01, E=1.0, nu=0.3, density=1.0, element=element)
        model.clamp("edge:x0")
        bending = model.free[model.free % 3 == 2]
        K = model.tangent(model.reference)[bending][:, bending]
        consistent = model.mass
        model.lump_mass()
        lowest, lumped = (
            np.sqrt(eigsh(K, 1, M[bending][:, bending], sigma=0, return_eigenvectors=False)[0])
            for M in (consistent, model.mass)
        )
        differences.append(abs(lumped / lowest - 1))
    for coarse, fine in pairwise(differences):
        assert coarse / fine == pytest.approx(4, rel=0.1)
