"""Scenes of the third round that was put aside: first planned when nothing was left to change."""

from __future__ import annotations

from collections.abc import Iterator

from plan_scenes import HINGE, PAPER, RUBBER, STEEL, WALL, WEIGHT, Case, line, plate, scene

import ancf
from ancf.plan.ladder import Stepping

WOOD = ancf.Material(E=1e10, nu=0.3, density=600.0)
_X, _Y = (1, 2, 3, 4, 6, 8, 12), (1, 2, 4, 8)


def fresh_statics() -> Iterator[Case]:
    """Yield its statics."""
    run = ancf.Static(load_factors=[0.5, 1.0])
    hoop = ancf.Cylinder(
        radius=0.05, angle=(0.0, 3.0), length=(0.0, 0.02), divisions=(8, 2), thickness=5e-4, material=STEEL
    )
    pinch = [line("x1", 0.0, -60.0, 0.0)]
    yield Case(scene("hoop bent", hoop, [WALL], pinch, (2.0, 0.01), run, "displacement"), ((32, 4), (64, 8)))
    collar = ancf.Annulus(radii=(0.1, 0.3), angle=2.5, divisions=(4, 8), thickness=3e-3, material=RUBBER)
    hem = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -0.3))
    yield Case(scene("collar hangs", collar, [WALL], [hem], (0.25, 1.0), run, "displacement"), ((16, 24), (32, 48)))
    table = plate((0.5, 0.3), 3e-3, STEEL)
    legs = [ancf.Support(at=f"corner:{corner}", fix=["r"]) for corner in ("x0y0", "x1y0", "x0y1", "x1y1")]
    snow = [ancf.Pressure(pressure=-3e3)]
    yield Case(scene("table loaded", table, legs, snow, (0.2, 0.1), run, "displacement"), ((96, 64), (160, 128)))
    rod = plate((0.3, 0.03), 3e-4, STEEL)
    pair = [
        ancf.Force(at=f"corner:x1{side}", force=(0.0, 0.0, sign * 0.6)) for side, sign in (("y0", -1.0), ("y1", 1.0))
    ]
    yield Case(scene("ruler twisted", rod, [WALL], pair, (0.2, 0.03), run, "displacement"), ((32, 8), (64, 12)))
    trough = ancf.Cylinder(
        radius=0.1, angle=(3.3, 6.1), length=(0.0, 0.4), divisions=(8, 8), thickness=3e-4, material=PAPER
    )
    held = [ancf.Support(at=f"edge:{side}", fix=["r"]) for side in ("y0", "y1")]
    yield Case(
        scene(
            "trough filled",
            trough,
            held,
            [ancf.Gravity(acceleration=(0.0, -9.81, 0.0))],
            (4.0, 0.15),
            run,
            "displacement",
        ),
        ((128, 96), (192, 128)),
    )
    hatch = plate((0.4, 0.4), 8e-3, WOOD)
    yield Case(
        scene(
            "hatch pressed",
            hatch,
            [HINGE, ancf.Support(at="edge:y0", clamp=True)],
            [ancf.Pressure(pressure=2e3)],
            (0.25, 0.25),
            run,
            "moment",
        ),
        ((32, 32), (64, 64)),
    )


def fresh_motions() -> Iterator[Case]:
    """Yield its motions."""
    lath = plate((0.5, 0.05), 2e-3, WOOD)
    flip = ancf.LineLoad(at="edge:x0", per_length=(0.0, 0.0, 200.0), history=[(0.0, 0.0), (4e-3, 1.0), (8e-3, 0.0)])
    yield Case(
        scene("lath flipped", lath, [], [flip], (0.3, 0.05), ancf.Dynamic(until=0.06, step=5e-4), "displacement"),
        ((12, 2), (16, 4)),
        _X,
        (1, 2, 4),
        Stepping("esdirk", step=0.06 / 300),
    )
    drum = plate((0.2, 0.2), 1e-4, STEEL)
    rim = [ancf.Support(at=f"edge:{edge}", fix=["r"]) for edge in ("x0", "x1", "y0", "y1")]
    pat = ancf.Pressure(pressure=200.0, history=[(0.0, 0.0), (1e-3, 1.0), (3e-3, 0.0)])
    yield Case(
        scene("drum patted", drum, rim, [pat], (0.08, 0.1), ancf.Dynamic(until=6e-3, step=5e-5), "displacement"),
        ((16, 16), (24, 24)),
        _X,
        _X,
        Stepping("esdirk", step=6e-3 / 300),
    )
    shelf = ancf.Cylinder(
        radius=0.2, angle=(0.0, 1.0), length=(0.0, 0.15), divisions=(4, 4), thickness=6e-3, material=RUBBER
    )
    yield Case(
        scene("visor falls", shelf, [WALL], [WEIGHT], (1.0, 0.15), ancf.Dynamic(until=0.25, step=2e-3), "displacement"),
        ((8, 6), (12, 8)),
        _X,
        _Y,
        Stepping("esdirk", step=0.25 / 300),
    )
    vane = ancf.Annulus(radii=(0.05, 0.2), angle=0.8, divisions=(4, 4), thickness=1e-3, material=STEEL)
    spin = ancf.Rotation(axis=(0.0, 0.0, 1.0), angle=[(0.0, 0.0), (0.05, 0.1), (0.2, 1.0)])
    hub = ancf.Support(at="edge:x0", clamp=True, rotation=spin)
    yield Case(
        scene("vane turned", vane, [hub], [WEIGHT], (0.2, 0.4), ancf.Dynamic(until=0.1, step=5e-4), "displacement"),
        ((8, 8), (12, 12)),
        _X,
        _Y,
        Stepping("esdirk", step=0.1 / 400),
    )
    tag = plate((0.12, 0.04), 3e-4, PAPER)
    curl = ancf.Moment(at="edge:x1", per_length=0.01, history=[(0.0, 0.0), (0.01, 1.0), (0.03, 0.0)])
    yield Case(
        scene("tag curled", tag, [WALL], [curl], (0.12, 0.02), ancf.Dynamic(until=0.05, step=5e-4), "displacement"),
        ((12, 3), (16, 4)),
        _X,
        (1, 2, 4),
        Stepping("esdirk", step=0.05 / 400),
    )


def fresh() -> Iterator[Case]:
    """Yield the scenes of the round."""
    yield from fresh_motions()
    yield from fresh_statics()
