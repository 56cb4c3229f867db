"""Scenes that were made without a look at what plans do with them, in three rounds."""

from __future__ import annotations

from collections.abc import Iterator

from plan_scenes import HINGE, PAPER, PIN, RUBBER, SOFT, STEEL, WALL, WEIGHT, Case, line, plate, scene

import ancf
from ancf.plan.ladder import Stepping

FOOT = ancf.Support(at="edge:y0", clamp=True)
ALL_ROUND = [ancf.Support(at=f"edge:{edge}", clamp=True) for edge in ("x0", "x1", "y0", "y1")]
_X, _Y = (1, 2, 3, 4, 6, 8, 12), (1, 2, 4)


def first_statics() -> Iterator[Case]:
    """Yield statics of the first round."""
    run = ancf.Static(load_factors=[0.4, 1.0])
    lid = plate((0.4, 0.3), 1e-3, STEEL)
    wind = [ancf.Pressure(pressure=3e3)]
    yield Case(scene("lid blown", lid, ALL_ROUND, wind, (0.1, 0.15), run, "displacement"), ((32, 28), (80, 64)))
    leaf = ancf.Cylinder(
        radius=0.3, angle=(0.2, 1.2), length=(0.0, 0.25), divisions=(4, 4), thickness=3e-4, material=PAPER
    )
    aside = ancf.Gravity(acceleration=(0.0, -9.81, 0.0))
    yield Case(scene("leaf sags", leaf, [FOOT], [aside], (0.2, 0.25), run), ((40, 80), (64, 96)))
    vault = ancf.Cylinder(
        radius=2.54, angle=(1.47, 1.67), length=(0.0, 0.508), divisions=(4, 4), thickness=12.7e-3, material=STEEL
    )
    hinges = [HINGE, ancf.Support(at="edge:x1", fix=["r"])]
    weight = ancf.Force(at=(1.57, 0.254), force=(0.0, -6e4, 0.0))
    yield Case(
        scene("vault loaded", vault, hinges, [weight], (1.57, 0.254), run, "displacement"), ((64, 128), (80, 128))
    )
    tape = plate((0.4, 0.04), 2e-3, RUBBER)
    yield Case(
        scene("tape bends", tape, [WALL], [line("x1", 0, 0, 0.1)], (0.13, 0.02), run, "curvature"),
        ((120, 32), (180, 36)),
    )
    hook = ancf.Annulus(radii=(0.05, 0.08), angle=2.5, divisions=(2, 6), thickness=3e-3, material=STEEL)
    yield Case(
        scene("hook pulled", hook, [FOOT], [line("y1", 1e4, 0, 2e3)], (0.065, 1.1), run, "stress_top"),
        ((12, 48), (20, 80)),
        (1, 2, 4, 8),
        (1, 2, 3, 4, 6, 8, 12, 16),
    )
    foil = plate((0.5, 0.2), 5e-5, STEEL)
    yield Case(scene("foil sags", foil, [WALL], [WEIGHT], (0.5, 0.0), run, "displacement"), ((64, 12), (96, 20)))


def first_motions() -> Iterator[Case]:
    """Yield motions of the first round."""
    deck = plate((0.3, 0.08), 2e-3, STEEL)
    banks = [WALL, ancf.Support(at="edge:x1", clamp=True)]
    blow = ancf.Pressure(pressure=2e3, history=[(0.0, 0.0), (3e-3, 1.0), (5e-3, 0.0)])
    yield Case(
        scene("deck struck", deck, banks, [blow], (0.15, 0.04), ancf.Dynamic(until=8e-3, step=1e-4), "displacement"),
        ((16, 4), (40, 8)),
        _X,
        _Y,
        Stepping("verlet", rtol=1e-4),
    )
    sheet = plate((0.2, 0.15), 2e-4, PAPER)
    yield Case(
        scene("sheet dangles", sheet, [PIN], [WEIGHT], (0.2, 0.15), ancf.Dynamic(until=0.12, step=1e-3)),
        ((16, 12), (24, 18)),
        _X,
        (1, 2, 4, 8),
        Stepping("esdirk", step=0.12 / 240),
    )
    mat = plate((0.3, 0.2), 8e-3, RUBBER)
    pulse = [(0.0, 1.0), (0.03, 1.0), (0.04, 0.0)]
    spin = [
        ancf.LineLoad(at="edge:x1", per_length=(0.0, 12.0, 4.0), history=pulse),
        ancf.LineLoad(at="edge:x0", per_length=(0.0, -12.0, 4.0), history=pulse),
    ]
    yield Case(
        scene("mat spun", mat, [], spin, (0.3, 0.0), ancf.Dynamic(until=0.12, step=1e-3), "displacement"),
        ((36, 28), (52, 40)),
        _X,
        (1, 2, 4, 8),
        Stepping("verlet", rtol=1e-4),
    )
    vane = plate((0.3, 0.04), 1.5e-3, STEEL)
    turn = ancf.Rotation(axis=(0.0, 0.0, 1.0), angle=[(0.0, 0.0), (0.1, 0.6), (0.2, 2.4)])
    hub = ancf.Support(at="edge:x0", clamp=True, rotation=turn)
    yield Case(
        scene("vane spun up", vane, [hub], [WEIGHT], (0.3, 0.04), ancf.Dynamic(until=0.2, step=1e-3)),
        ((12, 2), (16, 3)),
        _X,
        _Y,
        Stepping("esdirk", step=0.2 / 200),
    )
    fin = plate((0.3, 0.05), 6e-3, RUBBER)
    slowly = ancf.Gravity(acceleration=(0.0, 0.0, -9.81), history=[(0.0, 0.0), (0.06, 1.0)])
    yield Case(
        scene("fin drops", fin, [WALL], [slowly], (0.1125, 0.025), ancf.Dynamic(until=0.2, step=1e-3), "curvature"),
        ((28, 4), (60, 8)),
        _X,
        _Y,
        Stepping("verlet", rtol=1e-4),
    )


def kept_statics() -> Iterator[Case]:
    """Yield statics of the round that was kept."""
    run = ancf.Static(load_factors=[0.25, 0.6, 1.0])
    cap = ancf.Sphere(
        radius=0.4, longitude=(0.0, 0.9), latitude=(0.5, 1.1), divisions=(4, 4), thickness=6e-3, material=RUBBER
    )
    held = ancf.Support(at="edge:y0", fix=["r"])
    yield Case(scene("cap hinged", cap, [held, HINGE], [WEIGHT], (0.9, 1.1), run, "displacement"), ((32, 32), (48, 48)))
    shelf = plate((0.6, 0.25), 0.01, STEEL)
    post = ancf.Force(at=(0.6, 0.25), force=(0.0, 0.0, -900.0))
    sides = [WALL, FOOT]
    yield Case(scene("shelf loaded", shelf, sides, [post], (0.45, 0.2), run, "displacement"), ((24, 16), (40, 24)))
    ribbon = plate((0.3, 0.02), 1e-4, PAPER)
    curl = ancf.Moment(at="edge:x1", per_length=2e-3)
    yield Case(scene("ribbon curled", ribbon, [WALL], [curl], (0.3, 0.0), run), ((32, 4), (48, 6)))
    slab = plate((0.2, 0.2), 0.02, RUBBER)
    yield Case(
        scene("slab bends", slab, [WALL], [line("x1", 0, 0, 20.0)], (0.07, 0.06), run, "moment"), ((32, 32), (48, 48))
    )


def kept_motions() -> Iterator[Case]:
    """Yield motions of the round that was kept."""
    gong = ancf.Annulus(radii=(0.1, 0.25), angle=2.0, divisions=(4, 4), thickness=1e-3, material=STEEL)
    hit = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, 40.0), history=[(0.0, 1.0), (4e-3, 0.0)])
    yield Case(
        scene("gong hit", gong, [WALL], [hit], (0.25, 1.0), ancf.Dynamic(until=0.012, step=1e-4), "displacement"),
        ((8, 16), (12, 28)),
        (1, 2, 4, 8),
        (1, 2, 3, 4, 6, 8, 12),
        Stepping("verlet", rtol=1e-4),
    )
    flap = plate((0.25, 0.2), 5e-3, SOFT)
    yield Case(
        scene("flap falls", flap, [WALL], [WEIGHT], (0.25, 0.1), ancf.Dynamic(until=0.1, step=1e-3), "velocity"),
        ((32, 24), (64, 48)),
        _X,
        _Y,
        Stepping("verlet", rtol=1e-4),
    )
    gutter = ancf.Cylinder(
        radius=0.1, angle=(0.0, 2.5), length=(0.0, 0.15), divisions=(4, 4), thickness=4e-3, material=RUBBER
    )
    yield Case(
        scene("gutter dropped", gutter, [HINGE], [WEIGHT], (2.5, 0.15), ancf.Dynamic(until=0.1, step=1e-3)),
        ((24, 12), (40, 20)),
        _X,
        (1, 2, 4, 8),
        Stepping("verlet", rtol=1e-4),
    )
    board = plate((0.5, 0.3), 3e-3, STEEL)
    toss = [line("y0", 0.0, 10.0, 60.0), ancf.Force(at="corner:x1y1", force=(0.0, 0.0, 15.0))]
    yield Case(
        scene("board tossed", board, [], toss, (0.5, 0.0), ancf.Dynamic(until=0.1, step=1e-3), "displacement"),
        ((6, 4), (8, 6)),
        (1, 2, 4),
        (1, 2, 4),
        Stepping("esdirk", step=0.1 / 400),
    )


def last_statics() -> Iterator[Case]:
    """Yield statics made after the way up and down had been written anew."""
    run = ancf.Static(load_factors=[0.5, 1.0])
    blade = plate((0.8, 0.3), 4e-3, STEEL)
    bend = [ancf.Moment(at="edge:x1", per_length=150.0), WEIGHT]
    yield Case(scene("plank bent", blade, [WALL], bend, (0.25, 0.1), run, "stress_top"), ((24, 12), (40, 20)))
    shell = ancf.Cylinder(
        radius=0.08, angle=(0.0, 3.1), length=(0.0, 0.2), divisions=(4, 4), thickness=3e-3, material=RUBBER
    )
    blow = [ancf.Pressure(pressure=150.0)]
    yield Case(scene("sleeve blown", shell, [FOOT], blow, (1.0, 0.15), run, "displacement"), ((32, 20), (56, 32)))
    zone = ancf.Sphere(
        radius=0.3, longitude=(0.0, 2.0), latitude=(-0.3, 0.4), divisions=(4, 4), thickness=2e-3, material=STEEL
    )
    pull = [line("y1", 0.0, 0.0, 4e3)]
    yield Case(scene("zone pulled", zone, [FOOT], pull, (1.2, 0.4), run), ((40, 48), (64, 64)))


def last_motions() -> Iterator[Case]:
    """Yield motions made after the way up and down had been written anew."""
    tongue = plate((0.25, 0.1), 1e-3, STEEL)
    tap = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, 30.0), history=[(0.0, 0.0), (4e-3, 1.0), (8e-3, 0.0)])
    yield Case(
        scene("tongue tapped", tongue, [WALL], [tap], (0.25, 0.05), ancf.Dynamic(until=0.03, step=2e-4), "velocity"),
        ((20, 6), (32, 8)),
        _X,
        _Y,
        Stepping("esdirk", step=0.03 / 300),
    )
    disc = ancf.Annulus(radii=(0.08, 0.2), angle=2.5, divisions=(4, 4), thickness=4e-3, material=RUBBER)
    fling = ancf.LineLoad(at="edge:x1", per_length=(0.0, 3.0, 5.0), history=[(0.0, 1.0), (0.02, 1.0), (0.03, 0.0)])
    yield Case(
        scene("disc flung", disc, [], [fling, WEIGHT], (0.2, 2.5), ancf.Dynamic(until=0.08, step=5e-4), "displacement"),
        ((10, 20), (16, 36)),
        (1, 2, 4, 8),
        (1, 2, 3, 4, 6, 8, 12),
        Stepping("verlet", rtol=1e-4),
    )
    awning = ancf.Cylinder(
        radius=0.25, angle=(0.3, 1.4), length=(0.0, 0.2), divisions=(4, 4), thickness=4e-4, material=PAPER
    )
    yield Case(
        scene("awning drops", awning, [HINGE], [WEIGHT], (1.4, 0.2), ancf.Dynamic(until=0.08, step=5e-4)),
        ((16, 10), (28, 16)),
        _X,
        (1, 2, 4, 8),
        Stepping("esdirk", step=0.08 / 320),
    )


def last_round() -> Iterator[Case]:
    """Yield the scenes of the last round: planned once, nothing was changed for them."""
    yield from last_motions()
    yield from last_statics()


def first_round() -> Iterator[Case]:
    """Yield the scenes of the first round: what they showed was mended."""
    yield from first_motions()
    yield from first_statics()


def kept() -> Iterator[Case]:
    """Yield the scenes that were planned for the first time when all rules were fixed."""
    yield from kept_motions()
    yield from kept_statics()
