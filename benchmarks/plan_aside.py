"""Scenes of the second round that was put aside: first planned with rules that did not know them."""

from __future__ import annotations

from collections.abc import Iterator

from plan_scenes import HINGE, PAPER, RUBBER, STEEL, WALL, WEIGHT, Case, line, plate, scene

import ancf
from ancf.plan.ladder import Stepping

FOOT = ancf.Support(at="edge:y0", clamp=True)
SIMPLE = [ancf.Support(at=f"edge:{edge}", fix=["r"]) for edge in ("x0", "x1", "y0", "y1")]
_X, _Y = (1, 2, 3, 4, 6, 8, 12), (1, 2, 4, 8)


def aside_statics() -> Iterator[Case]:
    """Yield its statics."""
    run = ancf.Static(load_factors=[0.5, 1.0])
    duct = ancf.Cylinder(
        radius=0.1, angle=(0.0, 1.6), length=(0.0, 0.12), divisions=(4, 4), thickness=1e-2, material=RUBBER
    )
    press = [ancf.Pressure(pressure=-400.0)]
    yield Case(scene("duct pressed", duct, [WALL, FOOT], press, (0.5, 0.07), run, "moment"), ((40, 28), (64, 44)))
    bridge = plate((0.5, 0.2), 5e-5, STEEL)
    banks = [HINGE, ancf.Support(at="edge:x1", fix=["r"])]
    yield Case(
        scene("bridge of foil", bridge, banks, [WEIGHT], (0.2, 0.05), run, "membrane_force"), ((56, 24), (96, 36))
    )
    card = plate((0.21, 0.15), 3e-4, PAPER)
    yield Case(
        scene("card on a frame", card, SIMPLE, [ancf.Pressure(pressure=40.0)], (0.06, 0.04), run, "von_mises_top"),
        ((64, 48), (80, 64)),
    )
    sector = ancf.Annulus(radii=(0.05, 0.2), angle=1.2, divisions=(4, 4), thickness=2e-3, material=RUBBER)
    lift = ancf.Force(at="corner:x1y1", force=(0.0, 0.0, 0.004))
    yield Case(scene("sector lifted", sector, [FOOT], [lift], (0.12, 0.8), run, "displacement"), ((24, 20), (48, 40)))
    patch = ancf.Sphere(
        radius=0.6, longitude=(0.0, 0.7), latitude=(0.2, 0.8), divisions=(4, 4), thickness=8e-3, material=STEEL
    )
    hang = [line("x1", 0.0, 4e3, 2e4)]
    yield Case(scene("patch pulled", patch, [WALL], hang, (0.35, 0.8), run, "displacement"), ((96, 24), (128, 32)))


def aside_motions() -> Iterator[Case]:
    """Yield its motions."""
    tile = ancf.Cylinder(
        radius=0.3, angle=(0.0, 2.0), length=(0.0, 0.3), divisions=(4, 4), thickness=3e-3, material=STEEL
    )
    knock = ancf.LineLoad(at="edge:x0", per_length=(0.0, 0.0, 500.0), history=[(0.0, 0.0), (2e-3, 1.0), (4e-3, 0.0)])
    yield Case(
        scene("tile knocked", tile, [], [knock], (2.0, 0.3), ancf.Dynamic(until=0.03, step=2e-4), "displacement"),
        ((12, 6), (16, 8)),
        _X,
        (1, 2, 4),
        Stepping("esdirk", step=0.03 / 240),
    )
    strap = plate((0.25, 0.05), 4e-3, RUBBER)
    whirl = ancf.Rotation(axis=(0.0, 0.0, 1.0), angle=[(0.0, 0.0), (0.1, 0.5), (0.25, 2.0)])
    hub = ancf.Support(at="edge:x0", clamp=True, rotation=whirl)
    yield Case(
        scene("strap whirled", strap, [hub], [WEIGHT], (0.06, 0.02), ancf.Dynamic(until=0.25, step=1e-3), "curvature"),
        ((48, 8), (72, 10)),
        _X,
        _Y,
        Stepping("esdirk", step=0.25 / 250),
    )
    reed = plate((0.2, 0.03), 1e-3, STEEL)
    shake = ancf.Support(
        at="edge:x0", clamp=True, shake=ancf.supports.Shake(amplitude=(0.0, 0.0, 2e-3), frequency=12.0)
    )
    yield Case(
        scene("reed shaken", reed, [shake], [], (0.2, 0.015), ancf.Dynamic(until=0.15, step=5e-4), "displacement"),
        ((20, 4), (32, 6)),
        _X,
        _Y,
        Stepping("esdirk", step=0.15 / 1200),
    )
    puff = plate((0.3, 0.2), 2e-4, PAPER)
    pins = [ancf.Support(at=f"corner:{corner}", fix=["r"]) for corner in ("x0y0", "x0y1")]
    gust = ancf.Pressure(pressure=3.0, history=[(0.0, 0.0), (0.02, 1.0), (0.05, 0.0)])
    yield Case(
        scene(
            "page puffed", puff, pins, [gust, WEIGHT], (0.3, 0.2), ancf.Dynamic(until=0.05, step=5e-4), "displacement"
        ),
        ((12, 8), (16, 12)),
        _X,
        _Y,
        Stepping("verlet", rtol=1e-4),
    )
    stub = plate((0.2, 0.15), 0.02, STEEL)
    hit = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, 1e5), history=[(0.0, 0.0), (5e-4, 1.0), (1e-3, 0.0)])
    yield Case(
        scene("stub hit", stub, [WALL], [hit], (0.05, 0.1), ancf.Dynamic(until=4e-3, step=2e-5), "stress_top"),
        ((16, 12), (28, 20)),
        _X,
        _Y,
        Stepping("esdirk", step=4e-3 / 200),
    )


def aside() -> Iterator[Case]:
    """Yield the scenes of the round."""
    yield from aside_motions()
    yield from aside_statics()
