"""Print how time and memory of statics grow with the number of coordinates, flat and curved, and the fitted exponents.

Run it from any folder with ``python benchmarks/growth.py [--quick] [--rows 5 16 52]``. What is timed, and what biases
it, is in ``benchmarks/README.md``.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import ancf

FloatArray = NDArray[np.float64]

# Rows of elements over the width, four times as many over the length: 1e3 to 1e6 coordinates.
ROWS = (5, 16, 52, 166)
QUICK = (2, 4)
LENGTH, WIDTH, THICKNESS, FORCE = 0.5, 0.15, 0.001, 30.0
STEEL = ancf.Material(E=2.07e11, nu=0.3, density=7810.0)


def flat(rows: int) -> ancf.Rectangle:
    """Make the cantilever of Dufva and Shabana (2005): all elements are congruent."""
    return ancf.Rectangle(size=(LENGTH, WIDTH), divisions=(4 * rows, rows), thickness=THICKNESS, material=STEEL)


def twisted(rows: int) -> ancf.Surface:
    """Make the same with a twist and a bulge: no two elements are congruent."""

    def position(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        return x, y, 0.3 * x * y + 0.05 * np.sin(3.0 * x + 2.0 * y)

    return ancf.Surface(
        domain=((0.0, LENGTH), (0.0, WIDTH)),
        position=position,
        divisions=(4 * rows, rows),
        thickness=THICKNESS,
        material=STEEL,
    )


BODIES: dict[str, Callable[[int], ancf.Rectangle | ancf.Surface]] = {"flat": flat, "curved": twisted}


def measure(body: str, rows: int) -> dict[str, float]:
    """Solve in this process."""
    start = time.perf_counter()
    model = ancf.Model(
        bodies={"plate": BODIES[body](rows)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -FORCE / WIDTH))],
    )
    result = ancf.solve_static(model)
    total = time.perf_counter() - start
    counts, took = result.counts, result.seconds
    return {
        "coordinates": counts["dofs"],
        "steps": counts["steps"],
        "iterations": counts["iterations"],
        "setup": took["setup"],
        "assembly": took["assembly"] / counts["factorizations"],
        "factorisation": took["factorization"] / counts["factorizations"],
        "solve": took["solve"] / counts["factorizations"],
        "total": total,
        "memory": peak(),
        "z": float(result.positions("plate", [[LENGTH, WIDTH]])[-1, 0, 2]),
    }


def peak() -> float:
    """Return the most memory that this process has held, MB."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return float(status.split("VmHWM:")[1].split()[0]) / 1024


def run(body: str, rows: int) -> dict[str, float]:
    """Solve in a process of its own."""
    command = [sys.executable, __file__, "--one", body, str(rows)]
    process = subprocess.run(command, capture_output=True, text=True, check=False)
    if process.returncode:
        raise SystemExit(f"{body}, {rows} rows: {process.stderr[-2000:]}")
    found: dict[str, float] = json.loads(process.stdout)
    return found


def exponent(runs: list[dict[str, float]], what: str) -> float:
    """Return p of the power law n^p through the larger half of the runs."""
    late = runs[len(runs) // 2 - 1 :]
    n, y = (np.log([run[key] for run in late]) for key in ("coordinates", what))
    return float(np.polyfit(n, y, 1)[0])


def table(body: str, rows: tuple[int, ...]) -> None:
    """Print what all sizes take."""
    print(f"\n### {body.capitalize()}\n")
    print(
        "| coordinates | load steps | iterations | setup, s | assembly, ms | factorisation, ms | solve, ms | all, s "
        "| memory, MB | deflection, m |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    runs = []
    for number in rows:
        found = run(body, number)
        runs.append(found)
        each = [f"{1e3 * found[key]:.3g}" for key in ("assembly", "factorisation", "solve")]
        print(
            f"| {found['coordinates']:.0f} | {found['steps']:.0f} | {found['iterations']:.0f} | {found['setup']:.3g} | "
            f"{' | '.join(each)} | {found['total']:.3g} | {found['memory']:.0f} | {found['z']:.5f} |",
            flush=True,
        )
    if len(runs) == 1:
        return
    parts = ("assembly", "factorisation", "solve", "memory")
    fits = ", ".join(f"{part} {exponent(runs, part):.2f}" for part in parts)
    print(f"\nExponents of the growth, over the larger sizes: {fits}.")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Time statics of a cantilever of many sizes.")
    parser.add_argument("--quick", action="store_true", help="see that it runs: small meshes")
    parser.add_argument("--rows", type=int, nargs="+", help="rows of elements over the width")
    parser.add_argument("--bodies", nargs="+", choices=list(BODIES), default=list(BODIES))
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one[0], int(arguments.one[1]))))
        return
    print(f"{os.cpu_count()} cores.")
    for body in arguments.bodies:
        table(body, tuple(arguments.rows or (QUICK if arguments.quick else ROWS)))


if __name__ == "__main__":
    main()
