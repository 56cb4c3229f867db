"""Reference shapes: rectangle, annulus, cylinder, sphere, and any smooth map."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import ancf

FloatArray = NDArray[np.float64]

STEEL = ancf.Material(E=2.1e11, nu=0.3, density=7800.0)
COMMON: dict[str, Any] = {"divisions": (6, 4), "thickness": 0.02, "material": STEEL}
SHAPES = {
    "annulus": ancf.Annulus(radii=(0.5, 2.0), angle=2.0, **COMMON),
    "cylinder": ancf.Cylinder(radius=2.5, angle=(-1.0, 2.0), length=(-3.0, 1.0), **COMMON),
    "sphere": ancf.Sphere(radius=1.5, longitude=(-1.0, 2.0), latitude=(-1.2, 1.0), **COMMON),
}
POSITIONS = {
    "annulus": lambda x, y: (x * np.cos(y), x * np.sin(y), 0),
    "cylinder": lambda x, y: (2.5 * np.cos(x), 2.5 * np.sin(x), y),
    "sphere": lambda x, y: (1.5 * np.cos(y) * np.cos(x), 1.5 * np.cos(y) * np.sin(x), 1.5 * np.sin(y)),
}


def model(body: Any) -> ancf.Model:
    return ancf.Model(bodies={"shell": body})


@pytest.mark.parametrize("name", list(SHAPES))
def test_a_map_gives_the_same_as_the_named_shape(name: str) -> None:
    exact = model(SHAPES[name])
    mapped = ancf.Surface(domain=exact.domain("shell"), position=POSITIONS[name], **COMMON)
    np.testing.assert_allclose(model(mapped).nodal_coordinates(), exact.nodal_coordinates(), atol=1e-11)


def test_given_derivatives_are_taken() -> None:
    def derivatives(x: FloatArray, y: FloatArray) -> Any:
        return (1, 0, y / 2), (0, 1, x / 2), (0, 0, 0.5)

    domain = ((-1.0, 1.0), (0.0, 2.0))
    saddle = ancf.Surface(domain=domain, position=lambda x, y: (x, y, x * y / 2), derivatives=derivatives, **COMMON)
    q = model(saddle).nodal_coordinates().reshape(-1, 3, 3)
    x, y, z = q[:, 0].T
    np.testing.assert_array_equal(z, x * y / 2)
    np.testing.assert_array_equal(q[:, 1], np.stack([np.ones_like(x), 0 * x, y / 2], axis=1))
    np.testing.assert_array_equal(q[:, 2], np.stack([0 * x, np.ones_like(x), x / 2], axis=1))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"position": lambda x, y: (x, y)}, "position: must return three components"),
        ({"position": lambda x, y: (x, y, x[:2])}, "position: must return three components"),
        ({"position": lambda x, y: (x, x, 0)}, "neither zero nor parallel"),
        ({"position": lambda x, y: (x, y, np.nan)}, "neither zero nor parallel"),
        # A side that is a point, tangents that vanish at one: differences give them no exact zero.
        (
            {"position": lambda x, y: (x, y * (1 - x), 0)},
            "at [1, 0]: must give finite numbers, r_x and r_y neither",
        ),
        ({"position": lambda x, y: (x * x, y, 0)}, "at [0, 0]: must give finite numbers, r_x and r_y neither"),
        ({"position": lambda x, y: (x, math.cos(y), 0)}, "position: fails: .*called with arrays"),
        ({"derivatives": lambda x, y: (x, y)}, "derivatives: must return r_x, r_y and r_xy"),
        ({"derivatives": lambda x, y: ((1, 0, 0), (0, 2, 0), (0, 0, 0))}, "derivatives: r_y at .* is [0.0, 2.0, 0.0]"),
        ({"position": lambda x, y: (x + 0j, y, 0 * x)}, "position: must return three components"),
        ({"domain": ((0, 1), (1, 1))}, "domain = [[0, 1], [1, 1]]: must be two pairs of increasing numbers"),
        ({"position": 1}, "position"),
    ],
)
def test_impossible_maps_are_refused(change: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"domain": ((0, 1), (0, 1)), "position": lambda x, y: (x, y, 0), **COMMON}
    with pytest.raises(ancf.InputError, match=message.replace("[", r"\[")):
        model(ancf.Surface(**{**good, **change}))


def test_unrolled_cylinder() -> None:
    """A quarter cylinder of radius R, flattened, has the energy E h**3 A / (24 (1 - nu**2) R**2)."""
    R, h = 2.0, 0.01
    common: dict[str, Any] = {"divisions": (16, 2), "thickness": h, "material": STEEL, "curvature": "koiter"}
    curved = model(ancf.Cylinder(radius=R, angle=(0, np.pi / 2), length=(0, 1), **common))
    flat = model(
        ancf.Surface(domain=((0, np.pi / 2), (0, 1)), position=lambda x, y: (R * x, y, 0), **common)
    ).nodal_coordinates()
    membrane, bending = curved._assembled.energy(flat)
    assert bending == pytest.approx(2.1e11 * h**3 * np.pi / (24 * (1 - 0.3**2) * R**2), rel=5e-4)
    assert membrane < 1e-3 * bending


@pytest.mark.parametrize("element", ["thin36", "thin48", "full48a", "full48b"])
def test_every_element_rests_on_every_shape(element: str) -> None:
    """No energy at rest, and as many nodal coordinates as the element has vectors."""
    for body in SHAPES.values():
        shell = model(body.model_copy(update={"element": element}))
        q = shell.nodal_coordinates()
        assert len(q) == 7 * 5 * (9 if element == "thin36" else 12)
        stretched = shell._assembled.energy(1.001 * q)
        assert sum(shell._assembled.energy(q)) < 1e-20 * sum(stretched)


MAPS: dict[str, tuple[Any, Any, float]] = {
    # Domain, position, area.
    "helicoid": (
        ((0.0, 3.0), (-1.0, 1.0)),
        lambda x, y: (y * np.cos(x), y * np.sin(x), 0.3 * x),
        3 * (np.sqrt(1.09) + 0.09 * np.arcsinh(1 / 0.3)),
    ),
    "torus": (
        ((0.0, 2.0), (0.0, 1.5)),
        lambda x, y: ((3 + np.cos(y)) * np.cos(x), (3 + np.cos(y)) * np.sin(x), np.sin(y)),
        2 * (3 * 1.5 + np.sin(1.5)),
    ),
}


@pytest.mark.parametrize("element", ["thin36", "thin48"])
@pytest.mark.parametrize("name", list(MAPS))
def test_maps_have_their_mass_and_turn_without_stress(name: str, element: Any) -> None:
    domain, position, area = MAPS[name]
    errors = []
    for divisions in ((4, 4), (8, 8), (16, 16)):
        body = ancf.Surface(
            domain=domain, position=position, element=element, divisions=divisions, thickness=0.02, material=STEEL
        )
        shell = model(body)
        core = ancf.Model(bodies={"shell": body}, loads=[ancf.Gravity(acceleration=(1.0, 0.0, 0.0))]).assemble(
            "constant"
        )
        positions = core.vectors("shell")[:, 0].astype(int)
        mass = core.external_force(shell.nodal_coordinates(), 0.0)[positions].sum()
        errors.append(abs(mass / (7800 * 0.02 * area) - 1))
        rotation = np.linalg.qr([[1.0, 2.0, 0.5], [0.3, 1.0, -2.0], [-1.0, 0.7, 0.2]])[0]
        turned = (shell.nodal_coordinates().reshape(-1, 3) @ rotation).ravel()
        turned[positions] += 5
        stretched = sum(core.energy(1.001 * shell.nodal_coordinates()))
        # A reflection as well: no strain.
        assert sum(core.energy(turned)) < 1e-18 * stretched
    assert errors[2] < 1e-5
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4, abs=0.2)


def test_pressure_vessel() -> None:
    """A cylinder under internal pressure p, free to grow: the hoop force is p R, the stress p R / h."""
    R, h, p = 2.0, 0.01, 1e4
    quarter = ancf.Cylinder(
        radius=R, angle=(0, np.pi / 2), length=(0, 1), divisions=(12, 2), thickness=h, material=STEEL, element="thin48"
    )
    points = [ancf.Probe(name=name, at=(0.7, 0.4), quantity=name) for name in ("membrane_force", "stress_top")]
    vessel = ancf.Model(
        bodies={"shell": quarter},
        supports=[
            ancf.Support(at="edge:x0", symmetry="y"),
            ancf.Support(at="edge:x1", symmetry="x"),
            ancf.Support(at="edge:y0", fix=["r.z", "r_x.z"]),
        ],
        loads=[ancf.Pressure(pressure=p)],
        probes=points,
    )
    result = ancf.solve_static(vessel)
    force, stress = (result.probes[name].value[-1] for name in ("membrane_force", "stress_top"))
    np.testing.assert_allclose(force, [p * R, 0, 0], atol=5e-3 * p * R)
    np.testing.assert_allclose(stress, [p * R / h, 0, 0], atol=1e-2 * p * R / h)
