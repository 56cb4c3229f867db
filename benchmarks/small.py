"""Print the time of one step of small models, and of a whole ``ancf run``.

Run it from any folder with ``python benchmarks/small.py [--quick]``; it takes half a minute. The scene is the rubber
pendulum of Dufva and Shabana (2005). A step is what a run of many steps takes longer than a run of one, over the
number of steps; runs take turns, and the fastest counts.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import ancf

SCENE = Path(__file__).resolve().parent.parent / "examples" / "cantilever.toml"
SIZE, THICKNESS, E, NU, DENSITY, UNTIL = 0.3, 0.01, 1e5, 0.3, 7810.0, 0.1
Method = Literal["hht", "verlet", "rk"]
# Method, step and how many evaluations of the forces it makes a step, where that is what counts.
METHODS: tuple[tuple[Method, float, int, str], ...] = (
    ("hht", 1e-3, 1, "step"),
    ("verlet", 2e-5, 1, "step"),
    ("rk", 5e-5, 6, "force evaluation"),
)


def pendulum(n: int) -> ancf.Model:
    """Make the pendulum of n x n elements."""
    material = ancf.Material(E=E, nu=NU, density=DENSITY)
    plate = ancf.Rectangle(size=(SIZE, SIZE), divisions=(n, n), thickness=THICKNESS, material=material, membrane="full")
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
    )


def seconds(work: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def run(n: int, method: Method, step: float, until: float, threads: int | None) -> float:
    """Time a run of the pendulum."""
    model = pendulum(n)
    return seconds(
        lambda: ancf.simulate(model, until=until, step=step, method=method, outputs=[until], threads=threads)
    )


def process(*arguments: str) -> float:
    """Time a process of Python."""
    return seconds(lambda: subprocess.run([sys.executable, *arguments], check=True, capture_output=True))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Time steps of small models and a whole run.")
    parser.add_argument("--quick", action="store_true", help="see that it runs: no repeats")
    repeats = 1 if parser.parse_args().quick else 7

    print("| pendulum | method | per | us, 1 thread | us, all threads |")
    print("|---|---|---|---|---|")
    for n in (1, 2, 4, 8):
        for method, step, evaluations, unit in METHODS:
            cells = []
            for threads in (1, None):
                pairs = [[run(n, method, step, until, threads) for until in (UNTIL, step)] for _ in range(repeats)]
                many, one = (min(pair[i] for pair in pairs) for i in (0, 1))
                cells.append((many - one) / (round(UNTIL / step) - 1) / evaluations * 1e6)
            print(f"| {n} x {n} | `{method}` | {unit} | {cells[0]:.1f} | {cells[1]:.1f} |")

    with tempfile.TemporaryDirectory() as folder:
        output = str(Path(folder) / "out")
        commands = {
            "Python without a program": ("-c", "pass"),
            "`import numpy, pydantic`": ("-c", "import numpy, pydantic"),
            "`import ancf`": ("-c", "import ancf"),
            f"`ancf run {SCENE.name}`": ("-m", "ancf", "run", str(SCENE), "-o", output, "--quiet"),
        }
        print("\n| process | ms |")
        print("|---|---|")
        times = [[process(*command) for command in commands.values()] for _ in range(repeats)]
        for i, what in enumerate(commands):
            print(f"| {what} | {min(row[i] for row in times) * 1e3:.0f} |")


if __name__ == "__main__":
    main()
