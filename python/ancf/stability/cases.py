"""The cases of the suite: thin, stiff, soft, fast, folded, snapping, spinning, falling."""

from __future__ import annotations

from typing import Any

import numpy as np

from ancf.bodies import Cylinder, Rectangle
from ancf.loads import Force, Gravity, LineLoad
from ancf.materials import Material
from ancf.model import Model
from ancf.probes import Probe
from ancf.run import Dynamic, Static
from ancf.scene import Scene
from ancf.stability.expect import (
    Case,
    agree,
    balanced,
    closer,
    ends,
    fails_or_gains,
    fewer_iterations,
    near,
    never_wrong,
    well,
)
from ancf.supports import Rotation, Support
from ancf.sweep import Variant

_G = 9.81
_QUARTER = np.pi / 2


def _pendulum(n: int, *supports: Support, **settings: Any) -> Variant:
    """Make the rubber plate of Dufva and Shabana (2005), for 0.3 s, its opposite corner as probe."""
    material = Material(E=1e5, nu=0.3, density=7810.0)
    plate = Rectangle(size=(0.3, 0.3), divisions=(n, n), thickness=0.01, material=material, membrane="full")
    model = Model(
        bodies={"plate": plate},
        supports=supports,
        loads=[Gravity(acceleration=(0.0, 0.0, -_G))],
        probes=[Probe(name="A", at=(0.3, 0.3))],
    )
    outputs = [0.03 * (k + 1) for k in range(10)]
    scene = Scene("", model, Dynamic(until=0.3, step=1e-3, outputs=outputs))
    return Variant.of(scene, **settings)


_SECONDS = [0.1 * (k + 1) for k in range(40)]
_PIN = Support(at="corner:x0y0", fix=["r"])


def _cantilever(**settings: Any) -> Variant:
    """Make the steel plate of Dufva and Shabana (2005) under 30 N, in one load step."""
    steel = Material(E=2.07e11, nu=0.3, density=7810.0)
    model = Model(
        bodies={"plate": Rectangle(size=(0.5, 0.15), divisions=(4, 1), thickness=1e-3, material=steel)},
        supports=[Support(at="edge:x0", clamp=True)],
        loads=[LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
        probes=[Probe(name="corner", at=(0.5, 0.15), quantity="displacement")],
    )
    return Variant.of(Scene("", model, Static()), **settings)


def _roof(**settings: Any) -> Variant:
    """Make a quarter of the hinged roof of Sze, Liu and Lo (2004), thickness 12.7: it snaps through (mm, N)."""
    shell = Cylinder(
        radius=2540.0,
        angle=(_QUARTER - 0.1, _QUARTER),
        length=(0.0, 254.0),
        divisions=(4, 4),
        thickness=12.7,
        material=Material(E=3102.75, nu=0.3),
    )
    model = Model(
        bodies={"roof": shell},
        supports=[
            Support(at="edge:x0", fix=["r", "r_y"]),
            Support(at="edge:x1", symmetry="x"),
            Support(at="edge:y0", symmetry="z"),
        ],
        loads=[Force(at="corner:x1y0", force=(0.0, -750.0, 0.0))],
        probes=[Probe(name="middle", at=(_QUARTER, 0.0), quantity="displacement")],
    )
    return Variant.of(Scene("", model, Static()), **settings)


def _turned(turns: float, steps: int, **settings: Any) -> Variant:
    """Make a steel strip whose clamp turns in its plane, many times within a few steps."""
    steel = Material(E=2.07e11, nu=0.3, density=7810.0)
    angle = 2 * np.pi * turns
    model = Model(
        bodies={"strip": Rectangle(size=(0.2, 0.05), divisions=(4, 1), thickness=2e-3, material=steel)},
        supports=[
            Support(
                at="edge:x0",
                clamp=True,
                rotation=Rotation(axis=(0, 0, 1), angle=[(0.0, 0.0), (0.5, angle / 2), (1.0, angle)]),
            )
        ],
        probes=[Probe(name="end", at=(0.2, 0.025))],
    )
    return Variant.of(
        Scene("", model, Dynamic(until=1.0, step=1.0 / steps, outputs=[0.1 * (k + 1) for k in range(10)])), **settings
    )


def cases() -> list[Case]:
    """Return all cases."""
    thin = {f"h = {h:g}": _pendulum(4, _PIN, thickness=h) for h in (1e-2, 1e-3, 1e-4, 3e-6)}
    stiff = {f"E = {E:g}": _pendulum(4, _PIN, E=E, method="tr_bdf2", rtol=1e-3) for E in (1e3, 1e5, 1e7, 1e9, 2e11)}
    steps = {
        "verlet, stable": _pendulum(2, _PIN, method="verlet", step=1e-3),
        "verlet, above the limit": _pendulum(2, _PIN, method="verlet", step=2e-2),
        "hht, 0.3 s / 100": _pendulum(2, _PIN, step=3e-3),
        "small steps": _pendulum(2, _PIN, method="esdirk", rtol=1e-6),
    }
    ladder = {f"rtol = {r:g}": _pendulum(2, _PIN, method="esdirk", rtol=r) for r in (1e-1, 1e-2, 1e-3, 1e-4)}
    exact = {"rk, rtol = 1e-8": _pendulum(2, _PIN, method="rk", rtol=1e-8)}
    sheet = {
        f"{method}": _pendulum(8, _PIN, E=1e9, thickness=1e-4, membrane="full", method=method, rtol=1e-3)
        for method in ("tr_bdf2", "hht", "energy_momentum")
    }
    corner = {
        "full, hht": _pendulum(16, _PIN, step=2e-3),
        "full, energy_momentum": _pendulum(16, _PIN, step=2e-3, method="energy_momentum"),
        "lobatto, tr_bdf2": _pendulum(16, _PIN, membrane="lobatto", method="tr_bdf2", rtol=1e-3),
    }
    stiffest = {
        method: _pendulum(2, _PIN, E=1e9, step=5e-3, method=method, until=4.0, outputs=_SECONDS)
        for method in ("hht", "energy_momentum")
    }
    trapezoidal = {
        method: _pendulum(2, _PIN, E=1e6, step=5e-3, method=method, until=4.0, outputs=_SECONDS)
        for method in ("newmark", "hht")
    }
    plain, mip = _cantilever(newton="plain"), _cantilever()
    spin = {
        "hht, 400 steps": _turned(2.0, 400),
        "energy_momentum, 400 steps": _turned(2.0, 400, method="energy_momentum"),
        "tr_bdf2, rtol = 1e-3": _turned(2.0, 400, method="tr_bdf2", rtol=1e-3),
        "hht, 20 steps": _turned(2.0, 20),
    }
    falling = {
        method: _pendulum(2, method=method, step=3e-2) for method in ("hht", "tr_bdf2", "esdirk", "energy_momentum")
    }
    hinge = Variant({**mip.scene, "support": [{"body": "plate", "at": "edge:x0", "fix": ["r"]}]}, {})
    return [
        Case("thickness down to 1e-5 of the side", thin, [well(), balanced(within=0.01)], quick=False),
        Case("Young's modulus from 1e3 to 2e11 Pa", stiff, [well(), balanced(within=0.01)], quick=False),
        Case(
            "steps from the explicit limit to a hundredth of the motion",
            steps,
            [
                well("verlet, stable", "hht, 0.3 s / 100", "small steps"),
                ends("failed", "verlet, above the limit", reason="above the limit"),
                agree("small steps", "verlet, stable", "hht, 0.3 s / 100", within=0.05),
            ],
            quick=True,
        ),
        Case("a near-inextensible sheet", sheet, [well(), balanced(within=0.02)], quick=False),
        Case("collapse near a pinned corner, 16 x 16", corner, [well(), balanced(within=0.02)], quick=False),
        Case(
            "stiff rubber at large steps: energy and momentum are kept, HHT damps",
            stiffest,
            [well(), balanced("hht", within=0.05), balanced("energy_momentum", within=1e-6)],
            quick=False,
        ),
        Case(
            "the trapezoidal rule grows where HHT damps",
            trapezoidal,
            [well("hht"), balanced("hht", within=0.01), fails_or_gains("newmark", more_than=0.05)],
            quick=False,
        ),
        Case(
            "snap-through: jumped over by load, followed by arc length",
            {"load": _roof(), "arc": _roof(path="arc", load_factors=[0.1, 1.0])},
            [well(), agree("load", "arc", within=1e-3)],
            quick=True,
        ),
        Case(
            "plain against MIP Newton, one load step",
            {"mip": mip, "plain": plain},
            [well(), agree("mip", "plain", within=1e-6), fewer_iterations("mip", "plain")],
            quick=True,
        ),
        Case(
            "huge rotation per step: two turns in 400 and in 20 steps",
            spin,
            [
                well("hht, 400 steps", "energy_momentum, 400 steps", "tr_bdf2, rtol = 1e-3"),
                agree("hht, 400 steps", "energy_momentum, 400 steps", "tr_bdf2, rtol = 1e-3", within=0.05),
                never_wrong("hht, 20 steps", like="hht, 400 steps", within=0.1),
            ],
            quick=False,
        ),
        Case(
            "no supports in statics", {"hinge": hinge}, [ends("refused", "hinge", reason="can still move")], quick=True
        ),
        Case(
            "no supports in motion: free fall",
            falling,
            [well(), *(near(name, (0.3, 0.3, -_G * 0.3**2 / 2), 1e-6) for name in falling)],
            quick=True,
        ),
        Case(
            "tolerance ladder",
            ladder | exact,
            [well(), closer(*ladder, to="rk, rtol = 1e-8")],
            quick=True,
        ),
    ]
