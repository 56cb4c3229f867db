"""Static solutions: closed forms, the steel cantilever, Newton's iterations."""

import numpy as np
import pytest

from ancf.reference import Model, NewtonError, NewtonOptions, RectangleMesh, negative_eigenvalues, solve_static, thin
from ancf.reference.elements import ElementKind
from ancf.reference.thin import CurvatureKind, MembraneRule

TEN_STEPS = list(np.linspace(0.1, 1, 10))


def cantilever(
    n: int, membrane: MembraneRule = "projected", curvature: CurvatureKind = "paper", element: ElementKind = "thin36"
) -> Model:
    """Steel, 0.5 x 0.15 x 0.001 m, clamped; a dead line load of 30 N in all; Dufva and Shabana (2005)."""
    model = Model(
        RectangleMesh((0.5, 0.15), (n, 1)),
        thickness=1e-3,
        E=2.07e11,
        nu=0.3,
        density=7810,
        element=element,
        membrane=membrane,
        curvature=curvature,
    )
    model.clamp("edge:x0")
    model.add_line_load("x1", [0, 0, -30 / 0.15], "ramp")
    return model


def tip(model: Model, steps: list[float], newton: NewtonOptions | None = None) -> tuple[float, int]:
    """Last deflection of the corner, and all iterations."""
    result = solve_static(model, steps, newton)
    return float(model.position((0.5, 0.15), result.q[-1])[2]), int(result.iterations.sum())


@pytest.mark.parametrize(
    ("membrane", "curvature", "n", "deflection"),
    [
        ("full", "paper", 4, -0.2817),
        ("lobatto", "koiter", 1, -0.2949),
        ("lobatto", "koiter", 2, -0.2865),
        ("lobatto", "koiter", 4, -0.2850),
        ("projected", "paper", 1, -0.2739),
        ("projected", "paper", 2, -0.2832),
        ("projected", "paper", 4, -0.2847),
    ],
)
def test_cantilever(membrane: MembraneRule, curvature: CurvatureKind, n: int, deflection: float) -> None:
    """Figures of an independent prototype, to the digits it prints."""
    assert tip(cantilever(n, membrane, curvature), [1.0])[0] == pytest.approx(deflection, abs=5.1e-5)


@pytest.mark.parametrize(("n", "deflection"), [(1, -0.01043), (2, -0.02766), (4, -0.07223)])
def test_solid_cantilever(n: int, deflection: float) -> None:
    """`full48a`, far too stiff; figures of the prototype again."""
    assert tip(cantilever(n, element="full48a"), TEN_STEPS)[0] == pytest.approx(deflection, abs=5.1e-6)


@pytest.mark.parametrize(("n", "deflection"), [(1, -0.1833), (2, -0.2615)])
def test_locking_cantilever(n: int, deflection: float) -> None:
    """One and two elements with full quadrature: within 1.5e-3 of the prototype, whose rule may differ a little."""
    assert tip(cantilever(n, "full"), TEN_STEPS)[0] == pytest.approx(deflection, rel=1.5e-3)


def test_one_giant_step_lands_on_another_equilibrium() -> None:
    """It is stable, too: counting negative pivots does not find it out."""
    model = cantilever(1, "full")
    result = solve_static(model, [1.0])
    assert model.position((0.5, 0.0), result.q[-1])[2] == pytest.approx(-0.0186, abs=1e-4)
    assert negative_eigenvalues(model, result.q[-1], 1.0) == 0


@pytest.mark.parametrize("n", [1, 4])
def test_a_strip_in_its_plane_needs_the_squares_in_the_shear(n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Timoshenko's beam; without x^2 and y^2 in E_xy the strip is about three times too soft, with any n."""
    L, b, h, E, P = 1.0, 0.1, 0.002, 1e7, 1e-7
    beam = P * L**3 / (3 * E * h * b**3 / 12) + 1.2 * P * L / (E / 2 * h * b)

    def deflection() -> float:
        model = Model(RectangleMesh((L, b), (n, 1)), thickness=h, E=E, nu=0.0, density=1.0)
        model.fix("edge:x0", ["r", "r_y", "r_x.z"])
        model.add_line_load("x1", [0, P / b, 0])
        result = solve_static(model, [1.0])
        return float(model.position((L, b / 2), result.q[-1])[1] - b / 2)

    assert deflection() == pytest.approx(beam, rel=1e-4)
    monkeypatch.setattr(thin, "PROJECTED", (thin.degrees(1, 3), thin.degrees(3, 1), thin.degrees(1, 1)))
    assert 2.4 < deflection() / beam < 3.4


def test_newton_iterations() -> None:
    """MIP takes less than half the iterations of plain Newton, to the same solution."""
    model = cantilever(4, "projected")
    mip, plain = (tip(model, [1.0], NewtonOptions(kind, tolerance=2e-8)) for kind in ("mip", "plain"))
    assert (mip[1], plain[1]) == (8, 19)
    assert mip[0] == pytest.approx(plain[0], abs=1e-9)


def test_a_solution_is_its_own_solution() -> None:
    """A start at the solution ends, although its first energy is nothing but rounding."""
    model = cantilever(2, "projected")
    q = solve_static(model, [1.0]).q[-1]
    again = solve_static(model, [1.0], start=q)
    assert again.iterations[0] <= 2
    np.testing.assert_allclose(again.q[0], q, atol=1e-8)


def test_failure() -> None:
    with pytest.raises(NewtonError, match="3 iterations"):
        solve_static(cantilever(2, "projected"), [1.0], NewtonOptions(max_iterations=3))


@pytest.mark.parametrize("membrane", ["full", "lobatto", "projected"])
def test_linear_strip(membrane: MembraneRule) -> None:
    """Narrow strip, nu = 0, small end force: F L**3 / (3 E I)."""
    L, b, h, E, F = 1.0, 0.05, 0.01, 1e7, 1e-6
    model = Model(RectangleMesh((L, b), (8, 1)), thickness=h, E=E, nu=0.0, density=1.0, membrane=membrane)
    model.clamp("edge:x0")
    model.add_line_load("x1", [0, 0, F / b])
    q = solve_static(model, [1.0]).q[-1]
    assert model.position((L, b / 2), q)[2] == pytest.approx(F * L**3 / (3 * E * b * h**3 / 12), rel=1e-4)


def test_strip_rolled_into_a_circle() -> None:
    """An end moment 2 pi E I / L closes a strip of 16 elements to 1e-3 L; half of it lifts the end by 2 L / pi.

    Kept in a plane: out of it, Newton with the symmetric part of the load stiffness multiplies errors by up to 1.3 in
    each iteration beyond 0.87 of the circle. Thin, because stretch and thinning change the figures by (2 pi h / L)**2.
    """
    L, b, h, E = 1.0, 0.1, 1e-3, 1e7
    model = Model(RectangleMesh((L, b), (16, 1)), thickness=h, E=E, nu=0.0, density=1.0)
    model.clamp("edge:x0")
    model.fix("all", ["r.y", "r_x.y", "r_y.x", "r_y.z"])
    model.add_moment("x1", 2 * np.pi * E * h**3 / 12 / L, "ramp")
    q = solve_static(model, list(np.linspace(0.1, 1, 10))).q
    half, full = (model.position((L, b / 2), q[k]) for k in (4, 9))
    np.testing.assert_allclose(half, [0, b / 2, 2 * L / np.pi], atol=5e-4)
    np.testing.assert_allclose(full, [0, b / 2, 0], atol=5e-4)
