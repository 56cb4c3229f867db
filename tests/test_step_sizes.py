"""A path ends in the same state, past the same first snap, in steps that the solver chooses and in fifty."""

from typing import Any

import numpy as np
import pytest

import ancf

CLAMPED = [{"at": "edge:y0", "clamp": True}]
ROOF = [{"at": f"edge:{side}", "fix": ["r"]} for side in ("x0", "x1")]
CAP = [{"at": f"edge:{side}", "clamp": True} for side in ("x0", "x1", "y0", "y1")]


def cylinder(angle: float, length: float, **rest: Any) -> dict[str, Any]:
    """A panel with its axis along z, its middle on the y axis."""
    ends = [np.pi / 2 - angle / 2, np.pi / 2 + angle / 2]
    return {"shape": "cylinder", "radius": 1.0, "angle": ends, "length": [0.0, length]} | rest


def sphere(width: float, height: float, **rest: Any) -> dict[str, Any]:
    """A part on both sides of the equator."""
    ends = [-height / 2, height / 2]
    return {"shape": "sphere", "radius": 1.0, "longitude": [0.0, width], "latitude": ends} | rest


def force(at: str | list[float], *components: float) -> dict[str, Any]:
    return {"kind": "force", "at": at, "force": list(components)}


# Body, supports, load and whether there are snaps. How many are told is a matter of the steps: some come in pairs.
CASES: dict[str, tuple[dict[str, Any], list[dict[str, Any]], dict[str, Any], bool]] = {
    "annulus": (
        {"shape": "annulus", "radii": [0.5, 1.0], "angle": 3.0, "divisions": [4, 8], "thickness": 0.0036},
        CLAMPED,
        force("corner:x1y1", -0.27, 0.81, -0.56),
        False,
    ),
    "sphere pulled at a corner": (
        sphere(1.0, 1.0, divisions=[4, 4], thickness=0.0036, element="thin48"),
        CLAMPED,
        force("corner:x0y1", 4.8, -0.51, -2.2),
        True,
    ),
    "cap under pressure": (
        sphere(0.338, 0.338, divisions=[4, 4], thickness=0.00122),
        CAP,
        {"kind": "pressure", "pressure": -16.8},
        True,
    ),
    "roof": (
        cylinder(0.85, 1.2, divisions=[6, 6], thickness=0.00236),
        ROOF,
        force([np.pi / 2, 0.6], 0.0, -7.2, 0.0),
        True,
    ),
    "thick roof": (
        cylinder(1.16, 1.64, divisions=[4, 4], thickness=0.0165),
        ROOF,
        force([np.pi / 2, 0.82], 0.0, -1733.0, 0.0),
        True,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_steps_of_any_size_end_in_the_same_state(name: str) -> None:
    body, supports, load, snaps = CASES[name]
    coarse, fine = (
        ancf.Scene.of(
            {
                "material": {"skin": {"E": 1e7, "nu": 0.3}},
                "body": {"shell": body | {"material": "skin"}},
                "support": supports,
                "load": [load],
                "run": {"kind": "static", "load_factors": [step / count for step in range(1, count + 1)]},
            }
        ).solve()
        for count in (1, 50)
    )
    assert coarse.reached == fine.reached == 1.0
    assert (len(coarse.jumps) > 0) == (len(fine.jumps) > 0) == snaps
    assert coarse.counts["steps"] < 15
    np.testing.assert_allclose(coarse.jumps[:1], fine.jumps[:1], rtol=0.02)
    size = np.abs(fine.q[-1]).max()
    np.testing.assert_allclose(coarse.q[-1], fine.q[-1], atol=1e-7 * size)
