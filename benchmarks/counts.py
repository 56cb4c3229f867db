"""Print what some runs take: steps, rejections by cause, iterations, factorisations.

Run it from any folder with ``python benchmarks/counts.py``; some seconds. A test compares what it prints with
`benchmarks/counts.md`, so that no change makes solvers less efficient unnoticed; after one that means to, print the
table there again.
"""

from __future__ import annotations

from collections.abc import Callable

import ancf
from ancf.run import Method

COUNTS = ("steps", "inaccurate", "unsolved", "iterations", "factorizations")


def pendulum(thickness: float, young: float) -> ancf.Model:
    """Return the pendulum of Dufva and Shabana (2005), 4 x 4 elements."""
    material = ancf.Material(E=young, nu=0.3, density=7810.0)
    plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(4, 4), thickness=thickness, material=material, membrane="full")
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
    )


def cantilever() -> ancf.Model:
    """Return the steel cantilever of formulation and tests, 4 x 1 elements, loaded on its end."""
    steel = ancf.Material(E=2.07e11, nu=0.3)
    return ancf.Model(
        bodies={"plate": ancf.Rectangle(size=(0.5, 0.15), divisions=(4, 1), thickness=1e-3, material=steel)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
    )


def runs() -> dict[str, Callable[[], ancf.Result]]:
    """Return the runs by name."""

    def motion(model: ancf.Model, method: Method, rtol: float) -> Callable[[], ancf.Result]:
        return lambda: ancf.simulate(model, until=0.3, rtol=rtol, method=method, outputs=[0.3])

    rubber, steel = pendulum(0.01, 1e5), pendulum(5e-4, 2e11)
    return {
        "rubber pendulum, hht, step 1e-3": lambda: ancf.simulate(rubber, until=0.3, step=1e-3),
        "the same without reuse": lambda: ancf.simulate(rubber, until=0.3, step=1e-3, reuse=False),
        "rubber pendulum, hht, rtol 1e-4": motion(rubber, "hht", 1e-4),
        "rubber pendulum, esdirk, rtol 1e-4": motion(rubber, "esdirk", 1e-4),
        "rubber pendulum, rk, rtol 1e-4": motion(rubber, "rk", 1e-4),
        "steel pendulum, hht, rtol 1e-3": motion(steel, "hht", 1e-3),
        "steel pendulum, tr_bdf2, rtol 1e-3": motion(steel, "tr_bdf2", 1e-3),
        "steel pendulum, esdirk, rtol 1e-3": motion(steel, "esdirk", 1e-3),
        "steel pendulum, energy_momentum, rtol 1e-3": motion(steel, "energy_momentum", 1e-3),
        "steel cantilever, mip": lambda: ancf.solve_static(cantilever(), newton="mip"),
        "steel cantilever, plain": lambda: ancf.solve_static(cantilever(), newton="plain"),
    }


def main() -> None:
    """Print the table."""
    print("| run |", " | ".join(COUNTS), "|")
    print("|" + "---|" * (1 + len(COUNTS)))
    for name, run in runs().items():
        counts = run().counts
        print(f"| {name} |", " | ".join(str(counts[count]) for count in COUNTS), "|", flush=True)


if __name__ == "__main__":
    main()
