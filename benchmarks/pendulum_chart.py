"""Chart what accuracy costs in the pendulum, with Exudyn's thin plate beside our elements.

Run it from any folder with ``python benchmarks/pendulum_chart.py -o DIR``; it takes some minutes. It is
``ancf chart examples/pendulum.toml -o DIR`` and then Exudyn's runs of `peers.py`, all on this machine, each alone on
one thread, timed as often in random order. What biases it is written in the report.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import defaultdict
from itertools import product
from pathlib import Path

import numpy as np
from peers import EXUDYN, UNTIL, Program, python_with_exudyn

import ancf
from ancf.chart import Label, Rival, default_axes, measure, write_chart
from ancf.chart.report import describe
from ancf.records import Record
from ancf.sweep import Timing

SCENE = Path(__file__).parent.parent / "examples" / "pendulum.toml"
MESHES = (2, 4, 8)
STEPS = (4e-3, 2e-3, 1e-3, 5e-4)
RULES = {False: "Exudyn thin plate", True: "Exudyn thin plate, reduced"}
REMARKS = (
    f"Exudyn is {EXUDYN.partition('==')[2]}, `ObjectANCFThinPlate`, its fast build, with its default and its reduced "
    "rule of integration, generalised-alpha with fixed steps and a spectral radius of 0.9, modified Newton; it ran "
    "after our runs, as often, in random order.",
    "Times include the making of the system on both sides. What favours ours: "
    "Exudyn keeps the pin as a constraint, which makes its matrices unsymmetric, and of its methods and settings only "
    "these were tried; the reference is made of our elements.",
)


def rivals(repeats: int) -> list[Rival]:
    """Run Exudyn's pendulum with all rules, meshes and steps."""
    theirs = Program("exudyn", python_with_exudyn())
    runs = list(product(RULES, MESHES, STEPS))
    found = defaultdict(list)
    for _ in range(repeats):
        for reduced, n, step in random.sample(runs, len(runs)):
            print(".", end="", file=sys.stderr, flush=True)
            found[reduced, n, step].append(theirs("pendulum", n, {"step": step, "modified": True, "reduced": reduced}))
    print(file=sys.stderr)
    return [
        Rival(
            label=Label(RULES[reduced], f"{n} x {n}", "generalised alpha", f"step {step:g} s"),
            elements=n * n,
            timing=Timing(tuple(run["wall"] for run in done), tuple(run["seconds"] for run in done)),
            probes={name: record(rows) for name, rows in done[0]["probes"].items()},
        )
        for (reduced, n, step), done in sorted(found.items())
    ]


def record(rows: list[list[float]]) -> Record:
    """Make a record of rows of time and position."""
    table = np.array(rows)
    return Record(table[:, 0], table[:, 1:])


def main() -> None:
    """Measure and write the chart."""
    parser = argparse.ArgumentParser(description="Chart the pendulum with Exudyn's thin plate beside our elements.")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for the chart")
    parser.add_argument("--budget", type=float, default=240.0, metavar="SECONDS", help="for our runs (default: 240)")
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="how often each run is timed (default: 3)")
    options = parser.parse_args()
    scene = ancf.load_scene(SCENE)
    assert isinstance(scene.run, ancf.Dynamic)
    assert scene.run.until == UNTIL
    options.output.mkdir(parents=True, exist_ok=True)
    log = options.output / "runs.jsonl"
    chart = measure(
        scene, default_axes(scene), log, budget=options.budget, repeats=options.repeats, progress=sys.stderr.isatty()
    )
    chart = chart.beside(rivals(options.repeats), *REMARKS)
    print(write_chart(options.output, chart)[-1])
    print(describe(chart))


if __name__ == "__main__":
    main()
