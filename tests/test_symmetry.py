"""Planes of symmetry: a part of a body moves as the whole does."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import ancf
from ancf.bodies import NODAL_VECTORS
from ancf.supports import Axis

MATERIAL = ancf.Material(E=2e5, nu=0.3, density=1000.0)
QUARTER = np.pi / 2


def plate(part: int, element: Any) -> ancf.Rectangle:
    sizes: dict[int, Any] = {1: ((0.4, 0.3), (4, 4)), 2: ((0.2, 0.3), (2, 4)), 4: ((0.2, 0.15), (2, 2))}
    size, divisions = sizes[part]
    return ancf.Rectangle(size=size, divisions=divisions, thickness=0.01, material=MATERIAL, element=element)


def shell(part: int, element: Any) -> ancf.Cylinder:
    sizes: dict[int, Any] = {
        1: ((0.5, np.pi - 0.5), (0.0, 0.6), (4, 4)),
        2: ((0.5, QUARTER), (0.0, 0.6), (2, 4)),
        4: ((0.5, QUARTER), (0.0, 0.3), (2, 2)),
    }
    angle, length, divisions = sizes[part]
    return ancf.Cylinder(
        radius=0.5, angle=angle, length=length, divisions=divisions, thickness=0.01, material=MATERIAL, element=element
    )


def run(body: Any, supports: Sequence[ancf.Support], point: tuple[float, float]) -> ancf.Result:
    model = ancf.Model(
        bodies={"body": body},
        supports=supports,
        loads=[ancf.Pressure(pressure=100.0)],
        probes=[ancf.Probe(name=name, at=point, quantity=name) for name in ("displacement", "moment")],
    )
    return ancf.solve_static(model, tolerance=1e-11)


@pytest.mark.parametrize("element", NODAL_VECTORS)
@pytest.mark.parametrize(("make", "planes"), [(plate, ("x", "y")), (shell, ("x", "z"))])
def test_a_part_is_the_whole(make: Any, planes: tuple[Axis, Axis], element: str) -> None:
    """Held at all edges, bent strongly and unevenly: the mirrors are the middles of both natural coordinates."""
    low = [ancf.Support(at=f"edge:{side}0", fix=["r"]) for side in "xy"]
    high = [ancf.Support(at=f"edge:{side}1", fix=["r"]) for side in "xy"]
    first, second = (ancf.Support(at=f"edge:{side}1", symmetry=axis) for side, axis in zip("xy", planes, strict=True))
    whole, half, quarter = make(1, element), make(2, element), make(4, element)
    (x, _), (y, _) = ancf.Model(bodies={"body": whole}).domain("body")
    (_, middle), (_, across) = ancf.Model(bodies={"body": quarter}).domain("body")
    point = (x + 0.8 * (middle - x), y + 0.7 * (across - y))
    expected = run(whole, [*low, *high], point)
    assert np.abs(expected.probes["displacement"].value[-1]).max() > 0.01
    for body, supports in ((half, [*low, high[1], first]), (quarter, [*low, first, second])):
        found = run(body, supports, point)
        for name, record in found.probes.items():
            size = np.abs(expected.probes[name].value).max()
            np.testing.assert_allclose(record.value[-1], expected.probes[name].value[-1], rtol=0, atol=1e-9 * size)


@pytest.mark.parametrize(
    ("support", "message"),
    [
        ({"at": "corner:x0y0", "symmetry": "x"}, "at = .*: with symmetry allowed are edge:x0"),
        ({"at": "edge:x0", "symmetry": "x", "fix": ["r"]}, "fix: give either"),
        ({"at": "edge:x0", "symmetry": "x", "shake": {"amplitude": (1, 0, 0), "frequency": 1.0}}, "cannot be moved"),
    ],
)
def test_what_symmetry_goes_with(support: dict[str, Any], message: str) -> None:
    with pytest.raises(ancf.InputError, match=message):
        ancf.Support(**support)


@pytest.mark.parametrize(
    ("flat", "at", "axis", "message"),
    [
        (False, "edge:x0", "x", "the body must cross the plane normal to x squarely, its r_x does not"),
        (False, "edge:y1", "y", "the edge must lie in a plane normal to y; allowed is z"),
        (False, "edge:x1", "z", "the edge must lie in a plane normal to z"),
        (True, "edge:x1", "y", "the edge must lie in a plane normal to y; allowed is x"),
        (True, "edge:x1", "z", "the body must cross the plane normal to z squarely, its r_x does not; allowed is x"),
    ],
)
def test_an_edge_outside_of_the_plane_is_refused(flat: bool, at: str, axis: Axis, message: str) -> None:
    body = plate(4, "thin48") if flat else shell(4, "thin48")
    slanted = ancf.Surface(
        domain=((0, 1), (0, 1)),
        position=lambda x, y: (x, y, 0.1 * (1 - x)),
        divisions=(1, 1),
        thickness=0.01,
        material=MATERIAL,
    )
    with pytest.raises(ancf.InputError, match=rf'supports.0.symmetry = "{axis}": {message}'):
        ancf.Model(bodies={"body": body}, supports=[ancf.Support(at=at, symmetry=axis)])
    with pytest.raises(ancf.InputError, match="x squarely, its r_x does not; here no axis is allowed"):
        ancf.Model(bodies={"body": slanted}, supports=[ancf.Support(at="edge:x1", symmetry="x")])
