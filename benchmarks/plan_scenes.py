"""The scenes of the benchmark of plans: those on which the planner was developed, and those made later."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import ancf
from ancf.plan.ladder import Stepping

STEEL = ancf.Material(E=2.07e11, nu=0.3, density=7810.0)
PAPER = ancf.Material(E=3e9, nu=0.2, density=800.0, mass_damping=2.0)
RUBBER = ancf.Material(E=1e6, nu=0.45, density=1100.0)
SOFT = ancf.Material(E=1e5, nu=0.3, density=7810.0)
WEIGHT = ancf.Gravity(acceleration=(0.0, 0.0, -9.81))
WALL = ancf.Support(at="edge:x0", clamp=True)
PIN = ancf.Support(at="corner:x0y0", fix=["r"])
HINGE = ancf.Support(at="edge:x0", fix=["r"])


@dataclass(frozen=True)
class Case:
    """A scene, the meshes of the two references, thin48 and thin36, and the meshes of the chart along x and y."""

    scene: ancf.Scene
    fine: tuple[tuple[int, int], tuple[int, int]]
    x: tuple[int, ...] = (1, 2, 3, 4, 6, 8, 12, 16)
    y: tuple[int, ...] = (1, 2, 4, 8)
    stepping: Stepping | None = None


def plate(size: tuple[float, float], thickness: float, material: ancf.Material) -> ancf.Rectangle:
    """Return a rectangle; its mesh does not matter."""
    return ancf.Rectangle(size=size, divisions=(4, 4), thickness=thickness, material=material)


def scene(  # type: ignore[no-untyped-def]  # noqa: PLR0917
    title: str, body, supports, loads, at, run, quantity="position"
) -> ancf.Scene:
    """Return a scene whose probe A is a quantity of one point."""
    probes = [ancf.Probe(name="A", at=at, quantity=quantity)]
    return ancf.Scene(title, ancf.Model(bodies={"body": body}, supports=supports, loads=loads, probes=probes), run)


def line(edge: str, x: float, y: float, z: float) -> ancf.LineLoad:
    """Return a line load on an edge."""
    return ancf.LineLoad(at=f"edge:{edge}", per_length=(x, y, z))


def statics() -> Iterator[Case]:
    """Yield the scenes of statics."""
    run = ancf.Static(load_factors=[0.5, 1.0])
    roof = ancf.Cylinder(
        radius=1.0, angle=(0.0, 1.0), length=(0.0, 0.5), divisions=(4, 4), thickness=5e-3, material=STEEL
    )
    ring = ancf.Annulus(radii=(0.6, 1.0), angle=3.0, divisions=(2, 6), thickness=4e-3, material=STEEL)
    dome = ancf.Sphere(
        radius=0.5, longitude=(0.0, 0.8), latitude=(0.1, 0.8), divisions=(4, 4), thickness=5e-3, material=STEEL
    )
    strip = plate((0.5, 0.15), 1e-3, STEEL)
    yield Case(
        scene("steel cantilever", strip, [WALL], [line("x1", 0, 0, -200.0)], (0.5, 0.15), run), ((32, 8), (48, 16))
    )
    sheet = plate((0.2, 0.05), 1e-4, PAPER)
    yield Case(scene("paper sags", sheet, [WALL], [WEIGHT], (0.2, 0.05), run), ((32, 6), (48, 12)))
    mat = plate((0.4, 0.3), 8e-3, RUBBER)
    ends = [WALL, ancf.Support(at="edge:x1", clamp=True)]
    yield Case(
        scene("rubber blown", mat, ends, [ancf.Pressure(pressure=200.0)], (0.2, 0.15), run), ((96, 48), (192, 48))
    )
    yield Case(scene("roof bends", roof, [WALL], [line("x1", 2e3, 0, 0)], (1.0, 0.5), run), ((24, 12), (32, 16)))
    block = plate((0.3, 0.2), 0.03, STEEL)
    yield Case(scene("thick plate", block, [WALL], [line("x1", 0, 0, 2e6)], (0.3, 0.2), run), ((24, 16), (32, 24)))
    end = ancf.Support(at="edge:y0", clamp=True)
    yield Case(scene("ring lifted", ring, [end], [line("y1", 0, 0, 500.0)], (1.0, 3.0), run), ((8, 32), (12, 48)))
    foil = plate((0.5, 0.1), 5e-5, STEEL)
    moment = ancf.Moment(at="edge:x1", per_length=2e-3)
    yield Case(scene("foil rolled", foil, [WALL], [moment], (0.5, 0.05), run), ((48, 24), (64, 32)))
    yield Case(
        scene("dome pressed", dome, [end], [ancf.Pressure(pressure=-2e4)], (0.4, 0.8), run), ((40, 64), (56, 80))
    )


def motions() -> Iterator[Case]:
    """Yield the scenes of motion."""
    x, y = (1, 2, 3, 4, 6, 8, 12), (1, 2, 4)
    square = plate((0.3, 0.3), 2e-3, STEEL)
    fine = Stepping("esdirk", rtol=1e-5)
    throw = [ancf.Force(at=(0.1, 0.25), force=(5.0, -3.0, 20.0))]
    run = ancf.Dynamic(until=0.3, step=1e-3)
    yield Case(
        scene("steel thrown", square, [], throw, (0.3, 0.3), run),
        ((2, 2), (2, 2)),
        (1, 2, 4),
        (1, 2, 4),
        fine,
    )
    door = plate((0.3, 0.3), 5e-3, STEEL)
    run = ancf.Dynamic(until=0.25, step=1e-3)
    yield Case(
        scene("steel hinged", door, [HINGE], [WEIGHT], (0.3, 0.3), run),
        ((2, 2), (2, 2)),
        (1, 2, 4),
        (1, 2, 4),
        fine,
    )
    block = plate((0.3, 0.3), 0.03, STEEL)
    yield Case(
        scene("thick pendulum", block, [PIN], [WEIGHT], (0.3, 0.3), run),
        ((2, 2), (2, 2)),
        (1, 2, 4),
        (1, 2, 4),
        fine,
    )
    sheet = plate((0.2, 0.1), 1e-4, PAPER)
    yield Case(
        scene("paper falls", sheet, [WALL], [WEIGHT], (0.2, 0.1), ancf.Dynamic(until=0.2, step=1e-3)),
        ((12, 3), (16, 4)),
        x,
        y,
        Stepping("esdirk", rtol=1e-5),
    )
    swing = plate((0.4, 0.1), 0.01, RUBBER)
    yield Case(
        scene("rubber swings", swing, [WALL], [WEIGHT], (0.4, 0.1), ancf.Dynamic(until=0.3, step=1e-3)),
        ((24, 4), (32, 6)),
        x,
        y,
        Stepping("esdirk", step=0.3 / 150),
    )
    shell = ancf.Cylinder(
        radius=0.2, angle=(0.0, 2.0), length=(0.0, 0.2), divisions=(4, 2), thickness=8e-3, material=RUBBER
    )
    kick = [line("x1", 0.0, 0.0, 8.0), line("x0", 4.0, 0.0, 0.0)]
    yield Case(
        scene("shell thrown", shell, [], kick, (2.0, 0.2), ancf.Dynamic(until=0.15, step=1e-3)),
        ((24, 16), (48, 24)),
        x,
        y,
        Stepping("verlet", rtol=1e-4),
    )
    flag = plate((0.3, 0.3), 0.01, SOFT)
    yield Case(
        scene("rubber pendulum", flag, [HINGE], [WEIGHT], (0.3, 0.3), ancf.Dynamic(until=0.2, step=1e-3)),
        ((24, 16), (64, 32)),
        x,
        y,
        Stepping("verlet", rtol=1e-4),
    )


def later_statics() -> Iterator[Case]:
    """Yield the scenes of statics made later."""
    run = ancf.Static(load_factors=[0.3, 1.0])
    foot = ancf.Support(at="edge:y0", clamp=True)
    disc = ancf.Annulus(radii=(0.1, 0.3), angle=1.5, divisions=(4, 4), thickness=2e-3, material=STEEL)
    point = ancf.Force(at=(0.3, 1.5), force=(0.0, 0.0, -300.0))
    yield Case(scene("disc loaded", disc, [WALL], [point], (0.3, 0.75), run), ((24, 24), (32, 32)))
    tube = ancf.Cylinder(
        radius=0.05, angle=(0.0, 3.0), length=(0.0, 0.3), divisions=(4, 4), thickness=2e-3, material=RUBBER
    )
    edge = line("y1", 0.0, -0.1, 0.0)
    yield Case(scene("rubber gutter", tube, [foot], [edge], (1.5, 0.3), run), ((32, 128), (48, 160)))
    cap = ancf.Sphere(
        radius=0.2, longitude=(0.0, 1.2), latitude=(0.2, 1.0), divisions=(4, 4), thickness=4e-4, material=PAPER
    )
    yield Case(scene("paper cap", cap, [foot], [line("y1", 0.0, 0.0, 3.0)], (0.6, 1.0), run), ((40, 112), (56, 128)))
    band = plate((1.0, 0.05), 1e-3, RUBBER)
    roll = ancf.Moment(at="edge:x1", per_length=4.5e-4)
    yield Case(scene("rubber rolled", band, [WALL], [roll], (1.0, 0.025), run), ((48, 4), (64, 8)))
    skin = plate((1.0, 1.0), 1e-4, STEEL)
    along = {"x0": "r_y", "x1": "r_y", "y0": "r_x", "y1": "r_x"}
    frame = [ancf.Support(at=f"edge:{end}", fix=["r", vector]) for end, vector in along.items()]
    yield Case(scene("steel skin", skin, frame, [ancf.Pressure(pressure=0.02)], (0.5, 0.5), run), ((20, 20), (32, 32)))
    block = plate((0.1, 0.05), 0.01, RUBBER)
    twist = ancf.Force(at=(0.1, 0.05), force=(0.0, 0.3, 0.6))
    yield Case(scene("block twisted", block, [WALL], [twist], (0.1, 0.0), run), ((32, 16), (32, 16)))


def later_motions() -> Iterator[Case]:
    """Yield the scenes of motion made later."""
    x, y = (1, 2, 3, 4, 6, 8, 12), (1, 2, 4)
    foot = ancf.Support(at="edge:y0", clamp=True)
    sheet = plate((0.2, 0.1), 5e-4, PAPER)
    pulse = [(0.0, 1.0), (0.02, 1.0), (0.03, 0.0)]
    flick = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.2, 1.0), history=pulse)
    yield Case(
        scene("paper flicked", sheet, [], [flick, WEIGHT], (0.2, 0.0), ancf.Dynamic(until=0.05, step=5e-4)),
        ((20, 10), (28, 14)),
        x,
        y,
        Stepping("esdirk", step=0.05 / 300),
    )
    blade = ancf.Annulus(radii=(0.2, 0.4), angle=1.2, divisions=(4, 4), thickness=1e-3, material=STEEL)
    yield Case(
        scene("steel blade", blade, [foot], [WEIGHT], (0.4, 1.2), ancf.Dynamic(until=0.04, step=5e-4)),
        ((6, 12), (8, 16)),
        x,
        (1, 2, 4, 8),
        Stepping("esdirk", step=0.04 / 160),
    )
    bowl = ancf.Sphere(
        radius=0.15, longitude=(0.0, 1.5), latitude=(0.0, 1.0), divisions=(4, 4), thickness=6e-3, material=RUBBER
    )
    yield Case(
        scene("rubber bowl", bowl, [WALL], [WEIGHT], (1.5, 1.0), ancf.Dynamic(until=0.12, step=1e-3)),
        ((32, 32), (36, 30)),
        x,
        (1, 2, 4, 8),
        Stepping("verlet", rtol=1e-4),
    )
    whip = plate((0.6, 0.06), 0.012, RUBBER)
    yield Case(
        scene("long swing", whip, [HINGE], [WEIGHT], (0.6, 0.03), ancf.Dynamic(until=0.6, step=2e-3)),
        ((32, 6), (40, 8)),
        x,
        y,
        Stepping("esdirk", step=0.6 / 300),
    )
    pipe = ancf.Cylinder(
        radius=0.1, angle=(0.0, 1.5), length=(0.0, 0.3), divisions=(4, 4), thickness=8e-3, material=STEEL
    )
    push = ancf.LineLoad(at="edge:y1", per_length=(1e4, 0.0, 0.0), history=[(0.0, 0.0), (3e-3, 1.0)])
    yield Case(
        scene("pipe pushed", pipe, [foot], [push], (0.75, 0.3), ancf.Dynamic(until=4e-3, step=2e-5)),
        ((24, 160), (32, 224)),
        x,
        (1, 2, 4, 8),
        Stepping("esdirk", step=4e-3 / 48),
    )
    bar = plate((0.4, 0.05), 0.04, STEEL)
    spin = ancf.Force(at=(0.0, 0.05), force=(0.0, 80.0, 5.0))
    yield Case(
        scene("steel bar spun", bar, [], [spin], (0.4, 0.0), ancf.Dynamic(until=0.1, step=5e-4)),
        ((2, 1), (2, 2)),
        (1, 2, 4),
        (1, 2),
        Stepping("esdirk", rtol=1e-5),
    )


def developed() -> Iterator[Case]:
    """Yield the scenes on which the planner was developed."""
    yield from motions()
    yield from statics()


def made_later() -> Iterator[Case]:
    """Yield the scenes that were made when the planner was ready, to see how far it carries."""
    yield from later_motions()
    yield from later_statics()
