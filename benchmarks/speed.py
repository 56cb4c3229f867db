"""Print the table of speeds: elements and the pendulum, compiled and in NumPy, measured in the same run.

Run it from any folder with ``python benchmarks/speed.py [--quick]``. What is timed, and what biases it, is in
``benchmarks/README.md``.
"""

# ruff: noqa: E402  One thread, if not said otherwise; what is imported below reads that as it loads.
from __future__ import annotations

import os

for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Literal

import numpy as np
from numpy.typing import NDArray

import ancf
from ancf import reference

Membrane = Literal["projected", "full", "lobatto"]
MEMBRANES: tuple[Membrane, ...] = ("projected", "full", "lobatto")
SIZE, THICKNESS, E, NU, DENSITY, UNTIL, STEP = 0.3, 0.01, 1e5, 0.3, 7810.0, 0.3, 1e-3


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    repeats: int
    mesh: int  # elements along each side for the compiled elements
    numpy_mesh: int  # the same for NumPy
    numpy_steps: int  # of the pendulum


FULL = Effort(repeats=7, mesh=64, numpy_mesh=16, numpy_steps=20)
QUICK = Effort(repeats=1, mesh=8, numpy_mesh=2, numpy_steps=1)


def pendulum(n: int, membrane: Membrane) -> ancf.Model:
    """Make the rubber pendulum of Dufva and Shabana (2005)."""
    material = ancf.Material(E=E, nu=NU, density=DENSITY)
    plate = ancf.Rectangle(
        size=(SIZE, SIZE), divisions=(n, n), thickness=THICKNESS, material=material, membrane=membrane
    )
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
    )


def numpy_pendulum(n: int, membrane: Membrane) -> reference.Model:
    """Make the same in NumPy."""
    mesh = reference.RectangleMesh((SIZE, SIZE), (n, n))
    model = reference.Model(mesh, thickness=THICKNESS, E=E, nu=NU, density=DENSITY, membrane=membrane)
    model.fix("corner:x0y0", ["r"])
    model.add_gravity((0.0, 0.0, -9.81))
    return model


def element(n: int, membrane: Membrane) -> tuple[float, float]:
    """Return the seconds per element for force, and for force and tangent."""
    model = pendulum(n, membrane)
    core = model.assemble("constant")
    q = disturbed(core.reference())
    core.internal_force(q)  # Makes the tables.
    force = seconds(lambda: core.internal_force(q))
    # A force and a tangent for each factorisation, and a force for each of two outputs, at the start and at the end.
    result = ancf.simulate(model, until=STEP, step=STEP, alpha=0.0, outputs=[STEP], threads=1, reuse=False)
    both = (result.seconds["assembly"] - 2 * force) / result.counts["factorizations"]
    return force / n**2, both / n**2


def numpy_element(n: int, membrane: Membrane) -> tuple[float, float]:
    """Return the same of NumPy, whose tangent shares nothing with its force."""
    model = numpy_pendulum(n, membrane)
    q = disturbed(model.reference)
    force, tangent = seconds(lambda: model.internal_force(q)), seconds(lambda: model.tangent(q))
    return force / n**2, (force + tangent) / n**2


def disturbed(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move all coordinates a little."""
    return q + 1e-3 * np.random.default_rng(0).normal(size=q.shape)


def motion(threads: int) -> float:
    """Time the whole 8 x 8 pendulum."""
    model = pendulum(8, "full")
    return seconds(lambda: ancf.simulate(model, until=UNTIL, step=STEP, outputs=[UNTIL], threads=threads))


def numpy_motion(steps: int) -> float:
    """Return the seconds of the same in NumPy, from its first steps."""
    model, method = numpy_pendulum(8, "full"), reference.GeneralizedAlpha.hht(-0.05)
    return seconds(lambda: reference.simulate(model, steps * STEP, STEP, method)) / steps * (UNTIL / STEP)


def seconds(work: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Time elements and the pendulum, compiled and in NumPy.")
    parser.add_argument("--quick", action="store_true", help="see that it runs: small meshes, no repeats")
    effort = QUICK if parser.parse_args().quick else FULL

    rows: list[tuple[str, str, float, float]] = []
    for membrane in MEMBRANES:
        # In turn, so that what else the machine does falls on both.
        pairs = [
            (element(effort.mesh, membrane), numpy_element(effort.numpy_mesh, membrane)) for _ in range(effort.repeats)
        ]
        compiled, plain = (np.median([pair[side] for pair in pairs], axis=0) * 1e6 for side in (0, 1))
        rows.append((f"force, `{membrane}`", "us per element, 1 thread", compiled[0], plain[0]))
        rows.append((f"force and tangent, `{membrane}`", "us per element, 1 thread", compiled[1], plain[1]))
    cores = os.cpu_count() or 1
    plain_motion = numpy_motion(effort.numpy_steps)
    for threads, label in ((1, "1 thread"), (cores, f"{cores} threads")):
        compiled_motion = median(motion(threads) for _ in range(effort.repeats))
        rows.append((f"8 x 8 pendulum, {round(UNTIL / STEP)} steps", f"s, {label}", compiled_motion, plain_motion))

    print(f"{cores} cores.\n")
    print("| what | unit | compiled | NumPy | ratio |")
    print("|---|---|---|---|---|")
    for what, unit, fast, slow in rows:
        print(f"| {what} | {unit} | {fast:.3g} | {slow:.3g} | {slow / fast:.0f} |")


if __name__ == "__main__":
    main()
