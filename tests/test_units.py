"""Units do not count: powers of two scale numbers without rounding, so results differ by that of a few sums at most.

This holds for every element and every shape, whatever the units of its natural coordinates: on a cylinder x is an angle
and y a length, so that entries of one matrix differ by powers of the radius.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

import ancf
from ancf.bodies import NODAL_VECTORS, Plate
from ancf.run import Method

Units: TypeAlias = tuple[float, float, float]

SI = (1.0, 1.0, 1.0)
# What a metre, a kilogram and a second are: a shell of 10 um, and of 30 km.
UNITS = [(2.0**-15, 2.0**-40, 2.0**-7), (2.0**16, 2.0**30, 2.0**5)]


def plate(units: Units, shape: str, element: str, membrane: str | None) -> Plate:
    metre, kilogram, second = units
    stress = kilogram / metre / second**2
    common: dict[str, Any] = {
        "divisions": (3, 2),
        "thickness": 0.002 * metre,
        "material": ancf.Material(E=1e7 * stress, nu=0.3, density=1000.0 * kilogram / metre**3),
        "element": element,
        "membrane": membrane,
    }
    match shape:
        case "rectangle":
            return ancf.Rectangle(size=(0.3 * metre, 0.1 * metre), **common)
        case "annulus":
            return ancf.Annulus(radii=(0.1 * metre, 0.3 * metre), angle=1.5, **common)
        case "cylinder":
            return ancf.Cylinder(radius=0.3 * metre, angle=(-0.5, 0.5), length=(0.0, 0.2 * metre), **common)
        case _:
            return ancf.Sphere(radius=0.3 * metre, longitude=(-0.5, 0.5), latitude=(0.0, 0.6), **common)


def model(units: Units, shape: str, element: str, membrane: str | None) -> ancf.Model:
    metre, _, second = units
    return ancf.Model(
        bodies={"plate": plate(units, shape, element, membrane)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Gravity(acceleration=(0.0, metre / second**2, -3.0 * metre / second**2))],
    )


def displacements(result: ancf.Result, units: Units, element: str) -> NDArray[np.float64]:
    """Displacements of the nodes at the end, in metres."""
    moved = result.q[-1] - result.model.nodal_coordinates()
    positions: NDArray[np.float64] = moved.reshape(-1, len(NODAL_VECTORS[element]), 3)[:, 0] / units[0]
    return positions


def assert_same(found: ancf.Result, expected: ancf.Result, units: Units, element: str, rounding: float = 1e-11) -> None:
    moved = displacements(expected, SI, element)
    largest = np.abs(moved).max()
    assert largest > 1e-4
    np.testing.assert_allclose(displacements(found, units, element), moved, rtol=0, atol=rounding * largest)


ELEMENTS = [
    ("thin36", "projected"),
    ("thin36", "full"),
    ("thin36", "lobatto"),
    ("thin48", "projected"),
    ("thin48", "full"),
    ("full48a", None),
    ("full48b", None),
]
SHAPES = ["rectangle", "annulus", "cylinder", "sphere"]


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("element", "membrane"), ELEMENTS)
def test_equilibria_are_the_same(units: Units, shape: str, element: str, membrane: str | None) -> None:
    expected, found = (ancf.solve_static(model(u, shape, element, membrane)) for u in (SI, units))
    assert_same(found, expected, units, element)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("shape", SHAPES)
def test_frequencies_are_the_same(units: Units, shape: str) -> None:
    expected, found = (ancf.modes(model(u, shape, "thin36", "projected"), count=4).frequency for u in (SI, units))
    # The start of the search is random in the units of the coordinates.
    np.testing.assert_allclose(found * units[2], expected, rtol=1e-11)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize(("method", "step"), [("hht", 1e-3), ("esdirk", 2e-3), ("verlet", 2e-5)])
def test_motions_are_the_same(units: Units, method: Method, step: float) -> None:
    expected, found = (
        ancf.simulate(model(u, "cylinder", "thin36", "projected"), until=0.02 * u[2], step=step * u[2], method=method)
        for u in (SI, units)
    )
    assert_same(found, expected, units, "thin36")


@pytest.mark.parametrize(("element", "membrane"), ELEMENTS)
@pytest.mark.parametrize("factor", [2.0**13, 2.0**-13])
def test_parameters_of_a_surface_are_the_same(factor: float, element: str, membrane: str | None) -> None:
    """A shape does not depend on the units of one of its natural coordinates: a ring, its radius scaled in the map."""

    def ring(factor: float) -> ancf.Model:
        body = ancf.Surface(
            domain=((0.5 * factor, factor), (0.0, 3.0)),
            position=lambda x, y: (x / factor * np.cos(y), x / factor * np.sin(y), 0 * x),
            divisions=(2, 6),
            thickness=0.004,
            material=ancf.Material(E=2e11, nu=0.3),
            element=element,  # type: ignore[arg-type]
            membrane=membrane,  # type: ignore[arg-type]
        )
        support = ancf.Support(at="edge:y0", clamp=True)
        return ancf.Model(
            bodies={"ring": body},
            supports=[support],
            loads=[ancf.LineLoad(at="edge:y1", per_length=(0.0, 0.0, 200.0))],
        )

    expected, found = (ancf.solve_static(ring(f)) for f in (1.0, factor))
    # Tangents of a map come from differences, with errors of rounding.
    assert_same(found, expected, SI, element, 1e-6)


@pytest.mark.parametrize("millimetre", [False, True])
def test_a_published_plate_in_millimetres(millimetre: bool) -> None:
    """Sze, Liu and Lo (2004), 3.3: the slit annular plate, lifted by 13.9 and 17.5 m, in m and N, or mm and N."""
    unit = 1000.0 if millimetre else 1.0
    model = ancf.Model(
        bodies={
            "plate": ancf.Annulus(
                radii=(6 * unit, 10 * unit),
                angle=2 * np.pi,
                divisions=(6, 30),
                thickness=0.03 * unit,
                material=ancf.Material(E=21e6 / unit**2, nu=0.0),
            )
        },
        supports=[ancf.Support(at="edge:y0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:y1", per_length=(0.0, 0.0, 0.8 / unit))],
    )
    ends = [(6 * unit, 2 * np.pi), (10 * unit, 2 * np.pi)]
    lifted = ancf.solve_static(model).positions("plate", ends)[-1, :, 2]
    np.testing.assert_allclose(lifted / unit, [13.891, 17.528], rtol=5e-3)
