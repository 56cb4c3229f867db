"""Print the tables of docs/motion.md: orders, agreement, error control, conservation, reuse.

Run it from any folder with ``python benchmarks/motion.py``; give names of tables to print only these. All of them take
some ten minutes; ``--quick`` takes small meshes and short motions, to see that the script runs.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import get_args

import numpy as np
from numpy.typing import NDArray

import ancf
from ancf.run import Method

SIDE = 0.3
FALL = 0.3
METHODS = tuple(method for method in get_args(Method) if method != "rigid")
EXPLICIT = ("verlet", "rk")
ORDERS = dict.fromkeys(METHODS, 2) | {"esdirk": 4, "rk": 5}
YOUNG = {"rubber": 1e5, "steel": 2e11}


def plate(divisions: int, thickness: float, young: float, **material: float) -> ancf.Rectangle:
    """Return a square plate of the density of steel, with full integration."""
    return ancf.Rectangle(
        size=(SIDE, SIDE),
        divisions=(divisions, divisions),
        thickness=thickness,
        material=ancf.Material(E=young, nu=0.3, density=7810.0, **material),
        membrane="full",
    )


def pendulum(divisions: int, thickness: float = 0.01, young: float = 1e5, **material: float) -> ancf.Model:
    """Return the pendulum of Dufva and Shabana (2005): pinned at a corner, it falls from rest."""
    return ancf.Model(
        bodies={"plate": plate(divisions, thickness, young, **material)},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
        probes=[ancf.Probe(name="A", at=(SIDE, SIDE))],
    )


def positions(result: ancf.Result) -> NDArray[np.float64]:
    """Return the positions of all nodes in the last state, m."""
    end: NDArray[np.float64] = result.q[-1].reshape(-1, 3, 3)[:, 0]
    return end


def distance(result: ancf.Result, reference: ancf.Result) -> float:
    """Return the largest difference of two last states in position, m."""
    return float(np.abs(positions(result) - positions(reference)).max())


def table(head: str, rows: Iterable[Iterable[str]]) -> None:
    """Print a table as its rows become known."""
    columns = head.split(" | ")
    print("| " + head + " |", "|" + "---|" * len(columns), sep="\n")
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)
    print()


def orders(quick: bool) -> None:
    """Print observed orders at three steps that are halved, beside the declared ones."""
    clamped = ancf.Model(
        bodies={"plate": plate(1, 0.1, 1e5)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -0.1))],
    )
    speed = np.zeros(36)
    struck = [i for i in range(2, 36, 3) if i % 18 >= 9]
    speed[struck] = 1e-2 * np.sin(struck)
    cases: list[tuple[str, ancf.Model, float, dict[str, float], NDArray[np.float64] | None]] = [
        ("clamped plate, small vibration", clamped, 0.5, {"esdirk": 0.01, "rk": 0.005, "": 0.0025}, speed),
        ("rubber pendulum, 2 x 2", pendulum(2), FALL, {"esdirk": 4e-3, "rk": 2e-3, "": 1e-3}, None),
    ]

    def rows() -> Iterable[Iterable[str]]:
        for name, model, until, coarsest, velocity in cases[quick:]:

            def run(
                method: Method,
                step: float,
                model: ancf.Model = model,
                until: float = until,
                velocity: NDArray[np.float64] | None = velocity,
            ) -> ancf.Result:
                return ancf.simulate(
                    model,
                    until=until,
                    step=step,
                    method=method,
                    velocity=velocity,
                    outputs=[until],
                    tolerance=1e-13,
                )

            # As accurate as rounding allows, by a method that shares nothing with the implicit ones.
            reference = run("rk", until / 4000)
            for method in METHODS:
                step = coarsest.get(method, coarsest[""])
                errors = [distance(run(method, step / 2**k), reference) for k in range(4)]
                observed = [f"{np.log2(a / b):.2f}" for a, b in pairwise(errors)]
                yield (
                    name,
                    f"`{method}`",
                    str(ORDERS[method]),
                    ", ".join(observed),
                    f"{step / 8:.1e}",
                    f"{errors[3]:.1e}",
                )

    table("problem | method | declared | observed, steps halved | finest step, s | its error, m", rows())


def agreement(quick: bool) -> None:
    """Print the tip of the rubber pendulum at 0.3 s by methods that share little, each at two steps."""
    divisions = 2 if quick else 8
    model = pendulum(divisions)
    steps = {"esdirk": 2.5e-4, "verlet": 6.25e-5, "rk": 1e-4}

    def run(method: Method, step: float) -> NDArray[np.float64]:
        result = ancf.simulate(model, until=FALL, step=step, method=method, outputs=[FALL], tolerance=1e-11)
        end: NDArray[np.float64] = result.probes["A"].value[-1]
        return end

    exact = run("rk", 5e-5)

    def rows() -> Iterable[Iterable[str]]:
        for method in METHODS:
            step = steps.get(method, 1.25e-4)
            coarse, tip = run(method, 2 * step), run(method, step)
            x, _, z = tip
            change, apart = np.abs(tip - coarse).max(), np.abs(tip - exact).max()
            yield f"`{method}`", f"{step:.2e}", f"{x:.7f}", f"{z:.7f}", f"{change:.1e}", f"{apart:.1e}"

    print(f"{divisions} x {divisions} elements, `full`.\n")
    table("method | step, s | x = y, m | z, m | change from twice the step, m | from `rk` at 5e-5 s, m", rows())


def tolerances(quick: bool) -> None:
    """Print errors of runs with error control, relative to rtol, beside a converged run."""

    def rows() -> Iterable[Iterable[str]]:
        for divisions in (1, 2) if quick else (1, 2, 4, 8):
            for stuff, young in YOUNG.items():
                for thickness in (0.01, 0.0005) if quick else (0.01, 0.002, 0.0005):
                    model = pendulum(divisions, thickness, young)

                    def run(method: Method, rtol: float, model: ancf.Model = model) -> ancf.Result:
                        return ancf.simulate(model, until=FALL, rtol=rtol, method=method, outputs=[FALL])

                    reference = run("esdirk", 1e-6)
                    for rtol in (1e-3, 1e-4):
                        cells = []
                        for method in METHODS:
                            if method not in EXPLICIT:
                                result = run(method, rtol)
                                error = distance(result, reference) / (SIDE * 2**0.5) / rtol
                                cells.append(f"{error:.2f} ({result.counts['steps']})")
                        yield f"{divisions} x {divisions}", stuff, f"{thickness:g}", f"{rtol:.0e}", *cells

    names = " | ".join(f"`{method}`" for method in METHODS if method not in EXPLICIT)
    table(f"elements | material | thickness, m | rtol | {names}", rows())


def sweep(quick: bool) -> None:
    """Print the largest errors of many tolerances, relative to rtol: those between the ones of the last table."""
    rtols = np.geomspace(1e-2, 1e-5, 5 if quick else 20)

    def rows() -> Iterable[Iterable[str]]:
        for stuff, young in YOUNG.items():
            for thickness in (0.01,) if quick else (0.01, 0.002, 0.0005):
                models = [pendulum(divisions, thickness, young) for divisions in ((1,) if quick else (1, 2))]
                references = [ancf.simulate(m, until=FALL, rtol=3e-7, method="esdirk", outputs=[FALL]) for m in models]
                cells = []
                for method in METHODS:
                    if method in EXPLICIT:
                        continue
                    errors: list[float] = []
                    steps = 0
                    for model, reference in zip(models, references, strict=True):
                        for rtol in rtols:
                            result = ancf.simulate(model, until=FALL, rtol=float(rtol), method=method, outputs=[FALL])
                            errors.append(distance(result, reference) / (SIDE * 2**0.5) / rtol)
                            steps += result.counts["steps"]
                    cells.append(f"{max(errors):.2f} ({steps})")
                yield stuff, f"{thickness:g}", *cells

    names = " | ".join(f"`{method}`" for method in METHODS if method not in EXPLICIT)
    table(f"material | thickness, m | {names}", rows())


def flight(model: ancf.Model) -> NDArray[np.float64]:
    """Return velocities of a free plate that turns and bends strongly."""
    velocity = np.zeros((model.nodal_coordinates().size // 9, 3, 3))
    for node, (position, _, _) in zip(velocity, model.nodal_coordinates().reshape(-1, 3, 3), strict=True):
        (x, y), bend = position[:2] - SIDE / 2, 120.0
        node[0] = 1 - 5 * y, 5 * x, 3 * x + bend * (x * x - y * y + x * y)
        node[1] = 0, 5, 3 + bend * (2 * x + y)
        node[2] = -5, 0, bend * (x - 2 * y)
    return velocity.ravel()


def conservation(quick: bool) -> None:
    """Print what a free flight keeps, at steps at which the trapezoidal rule fails."""
    warnings.simplefilter("ignore", ancf.EnergyWarning)
    model = ancf.Model(bodies={"plate": plate(2, 0.01, 1e7)})
    step, steps = 1.5e-3, 2000 if quick else 100_000

    def rows() -> Iterable[Iterable[str]]:
        for method in ("energy_momentum", "newmark", "hht"):
            result = ancf.simulate(
                model,
                until=step * steps,
                step=step,
                method=method,
                every=step * steps / 200,
                velocity=flight(model),
                tolerance=1e-12,
                throw=False,
            )
            energy = result.energy.kinetic + result.energy.membrane + result.energy.bending
            strained = ((result.energy.membrane + result.energy.bending) / energy).max()
            drifts = [np.abs(energy / energy[0] - 1).max()]
            for momentum in (result.momentum, result.angular_momentum):
                drifts.append(np.linalg.norm(momentum - momentum[0], axis=1).max() / np.linalg.norm(momentum[0]))
            steps_made = result.counts["steps"]
            iterations = result.counts["iterations"] / steps_made
            yield (
                f"`{method}`",
                str(steps_made) + ("" if result.status == "ok" else ", failed"),
                *(f"{drift:.1e}" for drift in drifts),
                f"{strained:.0%}",
                f"{iterations:.1f}",
            )

    table("method | steps | energy | momentum | angular momentum | most strain energy | iterations a step", rows())


def reuse(quick: bool) -> None:
    """Print whether keeping factorisations pays, in processor time of one thread."""

    def rows() -> Iterable[Iterable[str]]:
        for divisions in (2,) if quick else (4, 16, 32):
            for stuff, thickness, young in (("rubber", 0.01, 1e5), ("steel", 0.0005, 2e11)):
                for method in ("hht", "tr_bdf2", "esdirk"):
                    model = pendulum(divisions, thickness, young)
                    times, counts = {}, {}
                    for kept in (False, True):
                        times[kept] = np.inf
                        # Small runs are over before the clock has ticked often.
                        for _ in range(1 + 32 // divisions):
                            start = time.process_time()
                            result = ancf.simulate(
                                model,
                                until=0.1 * FALL,
                                rtol=1e-4,
                                method=method,
                                reuse=kept,
                                outputs=[0.1 * FALL],
                                threads=1,
                            )
                            times[kept] = min(times[kept], time.process_time() - start)
                        counts[kept] = result.counts
                    numbers = [f"{c['iterations']}, {c['factorizations']}" for c in counts.values()]
                    mesh = f"{divisions} x {divisions}"
                    yield mesh, stuff, f"`{method}`", *numbers, f"{times[True] / times[False]:.2f}"

    head = "elements | material | method | iterations, factorisations | the same with `reuse` | time with over without"
    table(head, rows())


TABLES: dict[str, Callable[[bool], None]] = {
    call.__name__: call for call in (orders, agreement, tolerances, sweep, conservation, reuse)
}


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", choices=[*TABLES, []], help="all if left out")
    parser.add_argument("--quick", action="store_true", help="small meshes and short motions")
    options = parser.parse_args()
    for name in options.tables or TABLES:
        print(f"<!-- {name} -->")
        TABLES[name](options.quick)
        print(f"<!-- /{name} -->\n")


if __name__ == "__main__":
    main()
