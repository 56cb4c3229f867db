"""Print how good plans are: true errors and costs of what `ancf.plan` chooses, beside a chart of the same scene.

Run it from any folder with ``python benchmarks/plan.py``; it takes about ten minutes. ``--quick`` takes two scenes.
Names of scenes as arguments take these only. Everything runs on one thread, so that costs are the processor's time and
hardly depend on what else the machine does.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product

import numpy as np

import ancf
from ancf.plan.errors import Values, distance, scales
from ancf.plan.ladder import CONTINUOUS, RIGID, THIN, Choice, Family, Rung, Stepping, apply
from ancf.plan.pilots import Pilot, Pilots
from ancf.run import Method
from ancf.solve import solve

TOLERANCES = (1e-1, 1e-2, 1e-3)
BUDGET = 15.0
"""Seconds for the chart of a scene, whose cheap meshes come first; plans have their own default."""
IMPLICIT: tuple[Method, ...] = ("hht", "generalized_alpha", "energy_momentum", "esdirk", "tr_bdf2")
CONTROLLED: tuple[Method, ...] = ("hht", "esdirk", "tr_bdf2", "verlet", "rk")
_TIMED, _REPEATS, _SHORT = 4, 12, 0.05
"""Of the cheapest runs of a chart, how many are repeated, how often, and up to which seconds."""
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


def scene(title: str, body, supports, loads, at, run) -> ancf.Scene:  # type: ignore[no-untyped-def]  # noqa: PLR0917
    """Return a scene whose probe A is the position of one point."""
    probes = [ancf.Probe(name="A", at=at)]
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
        scene("rubber blown", mat, ends, [ancf.Pressure(pressure=200.0)], (0.2, 0.15), run), ((32, 24), (48, 32))
    )
    yield Case(scene("roof bends", roof, [WALL], [line("x1", 2e3, 0, 0)], (1.0, 0.5), run), ((24, 12), (32, 16)))
    block = plate((0.3, 0.2), 0.03, STEEL)
    yield Case(scene("thick plate", block, [WALL], [line("x1", 0, 0, 2e6)], (0.3, 0.2), run), ((24, 16), (32, 24)))
    end = ancf.Support(at="edge:y0", clamp=True)
    yield Case(scene("ring lifted", ring, [end], [line("y1", 0, 0, 500.0)], (1.0, 3.0), run), ((8, 32), (12, 48)))
    foil = plate((0.5, 0.1), 5e-5, STEEL)
    moment = ancf.Moment(at="edge:x1", per_length=2e-3)
    yield Case(scene("foil rolled", foil, [WALL], [moment], (0.5, 0.05), run), ((32, 6), (48, 12)))
    yield Case(
        scene("dome pressed", dome, [end], [ancf.Pressure(pressure=-2e4)], (0.4, 0.8), run), ((24, 24), (32, 32))
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


@dataclass(frozen=True)
class Line:
    """One plan beside the truth."""

    title: str
    tol: float
    choice: str
    error: float
    promised: float
    converged: bool
    doubt: float
    seconds: float
    cheapest: float
    best: str
    plan_seconds: float

    def __str__(self) -> str:
        promised = f"{self.promised:.1e}" + ("" if self.converged else ", told to be too much")
        cells = (
            self.title,
            f"{self.tol:g}",
            self.choice,
            f"{self.error:.1e}",
            promised,
            f"{self.doubt:.0e}",
            f"{self.seconds:.2g}",
            f"{self.cheapest:.2g}: {self.best}",
            f"{self.seconds / self.cheapest:.1f}",
            f"{self.plan_seconds:.2g}",
        )
        return f"| {' | '.join(cells)} |"


def judge(name: str) -> list[Line]:
    """Plan a scene to all tolerances, and compare with references and a chart."""
    case = next(case for case in (*statics(), *motions()) if case.scene.title == name)
    pilots = Pilots(case.scene, ["A"], 1e9, 1)
    references: dict[Family, Pilot] = {}
    for family, mesh in zip((CONTINUOUS, THIN[0]), case.fine, strict=True):
        references[family] = pilots.run(Choice(Rung(family, (mesh,)), case.stepping))
        if not references[family].ok:
            print(name, family, references[family].outcome, file=sys.stderr)
            return []
    exact, other = (references[family].values for family in (CONTINUOUS, THIN[0]))
    doubt = distance(exact, other, scales(exact))
    try:
        plans = [ancf.plan(case.scene, want="A", tol=tol, threads=1) for tol in TOLERANCES]
    except ancf.InputError as mistake:
        print(name, mistake, file=sys.stderr)
        return []
    tried = chart(case, pilots, exact)
    lines = []
    for tol, plan in zip(TOLERANCES, plans, strict=True):
        # Another element than the one that is judged.
        truth = other if plan.choice.startswith("thin48") else exact
        error = distance([plan.result.probes["A"].value], truth, scales(truth))
        fits = sorted(((s, c) for s, off, c in tried if off <= tol), key=lambda fit: fit[0])
        own = again(plan.scene, plan.rows[plan.chosen].seconds)
        # Many short runs are likely to hold a lucky one: the cheapest few are timed as often as the choice.
        near = [(again(apply(case.scene, choice), seconds), str(choice)) for seconds, choice in fits[:_TIMED]]
        cheapest, best = min([*near, (own, plan.choice)])
        own_error = plan.error + plan.error_in_time
        cells = (own_error, plan.converged, doubt, own, cheapest, best, plan.seconds)
        lines.append(Line(name, tol, plan.choice, error, *cells))
    return lines


def again(scene: ancf.Scene, seconds: float) -> float:
    """Return the shortest of several times of a short run; a long one's only time."""
    for _ in range(_REPEATS if seconds < _SHORT else 0):
        start = time.process_time()
        assert not isinstance(scene.run, ancf.Modes)
        solve(scene.model, scene.run, threads=1)
        seconds = min(seconds, time.process_time() - start)
    return seconds


def chart(case: Case, pilots: Pilots, exact: Values) -> list[tuple[float, float, Choice]]:
    """Run many settings: seconds, error and words of each; those dearer than what is as good are given up."""
    tried: list[tuple[float, float, Choice]] = []
    scale = scales(exact)
    start = time.process_time()

    def run(choice: Choice) -> None:
        limit = min((seconds for seconds, error, _ in tried if error <= TOLERANCES[-1]), default=10.0)
        if time.process_time() - start < BUDGET:
            pilot = pilots.run(choice, limit + 0.02)
            if pilot.ok:
                tried.append((pilot.seconds, distance(pilot.values, exact, scale), choice))

    steppings: list[Stepping | None] = [None]
    if case.stepping is not None:
        run(Choice(Rung(RIGID, ((1, 1),)), Stepping("rigid", rtol=1e-4)))
        steppings = [*in_time(case, pilots)]
    for nx, ny in sorted(product(case.x, case.y), key=lambda mesh: mesh[0] * mesh[1]):
        for family, stepping in product((*THIN, CONTINUOUS), steppings):
            run(Choice(Rung(family, ((nx, ny),)), stepping))
    return tried


def in_time(case: Case, pilots: Pilots) -> list[Stepping]:
    """Return for each tolerance the two cheapest steppings on one mesh."""
    run = case.scene.run
    assert isinstance(run, ancf.Dynamic)
    assert case.stepping is not None
    rung = Rung(THIN[1], ((2, 2),))
    reference = pilots.run(Choice(rung, case.stepping))
    if not reference.ok:
        return [case.stepping]
    scale = scales(reference.values)
    steppings = [Stepping(m, step=run.until / (16 * 3**k)) for m, k in product(IMPLICIT, range(5))]
    steppings += [Stepping(m, rtol=10.0**-k) for m, k in product(CONTROLLED, (1, 2, 3, 4))]
    done = [pilots.run(Choice(rung, stepping), reference.seconds) for stepping in steppings]
    chosen: list[Stepping] = []
    for tol in TOLERANCES:
        good = [p for p in done if p.ok and distance(p.values, reference.values, scale) <= tol / 2]
        for pilot in sorted(good, key=lambda pilot: pilot.seconds)[:2]:
            stepping = pilot.choice.stepping
            if stepping is not None and stepping not in chosen:
                chosen.append(stepping)
    return chosen


def main() -> None:
    """Print the table and what follows from it."""
    parser = argparse.ArgumentParser(description="How good plans are.")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    names = [case.scene.title for case in (*motions(), *statics())]
    if options.quick:
        names = ["thick plate", "steel hinged"]
    names = options.scenes or names
    print("| scene | tolerance | chosen | true error | promised | reference to | s | cheapest s | ratio | plan s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    lines: list[Line] = []
    with ProcessPoolExecutor(2) as pool:
        for found in pool.map(judge, names):
            lines += found
            print(*found, sep="\n", flush=True)
    below = [line.error <= line.tol for line in lines]
    told = [line.error <= line.tol for line in lines if line.converged]
    ratios = [line.seconds / line.cheapest for line in lines]
    print(
        f"\nBelow the tolerance: {sum(below)} of {len(below)}; where the plan promises it {sum(told)} of {len(told)}."
    )
    print(f"Largest true error relative to the tolerance: {max(line.error / line.tol for line in lines):.2g}.")
    print(
        f"Cost relative to the cheapest good enough: median {np.median(ratios):.2g}, largest {max(ratios):.2g}, "
        f"at most 2 in {sum(ratio <= 2 for ratio in ratios)} of {len(ratios)}."
    )


if __name__ == "__main__":
    main()
