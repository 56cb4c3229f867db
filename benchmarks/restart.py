"""Stop runs at random moments, go on from their checkpoints, and compare with a run that was not stopped.

Run it from any folder with ``python benchmarks/restart.py``; some minutes. Half of the runs are interrupted as by
Ctrl-C, half are killed without warning (POSIX); each is stopped up to three times. Every state that an interrupted run
has left, and every state at the end, is compared bit by bit; so are energies and the counts of steps, rejections,
iterations and factorisations. ``--count`` says how many runs there are, ``--seed`` which moments.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

SCENE = """
[material.rubber]
E = 1e6
nu = 0.3
density = 7810
viscosity = 1e-4

[body.plate]
shape = "rectangle"
size = [0.3, 0.3]
divisions = [4, 4]
thickness = 0.01
material = "rubber"
membrane = "full"

[[support]]
at = "corner:x0y0"
fix = ["r"]

[[load]]
kind = "gravity"
acceleration = [0, 0, -9.81]

[run]
kind = "dynamic"
until = {until}
method = "{method}"
{steps}
every = 0.01
"""
WAYS = {
    ("hht", "step = 2e-4"): 2.0,
    ("tr_bdf2", "rtol = 1e-4"): 0.6,
    ("esdirk", "rtol = 1e-5"): 1.5,
    ("energy_momentum", "step = 5e-4\nreuse = false"): 1.2,
    ("verlet", "step = 5e-5"): 1.5,
}
ARRAYS = ("t", "q", "v", "a")


def start(scene: Path, folder: Path, *arguments: str | Path) -> subprocess.Popen[bytes]:
    """Start a run of a scene."""
    command = [sys.executable, "-m", "ancf", "run", scene, "-o", folder, "--quiet", *arguments]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL)


def states(folder: Path) -> list[np.ndarray]:
    """Return what a run has left."""
    with np.load(folder / "result.npz") as file:
        return [file[name] for name in ARRAYS]


def summary(folder: Path) -> dict[str, object]:
    """Return what a run says of itself, without its times."""
    told: dict[str, object] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    del told["seconds"]
    return told


def has_all(whole: list[np.ndarray], folder: Path) -> bool:
    """Return whether an interrupted run has left the outputs of the whole run up to its end, with equal bits."""
    found = states(folder)
    outputs = whole[0] <= found[0][-1] if len(found[0]) else np.zeros(len(whole[0]), dtype=bool)
    # The last good state need not be an output.
    rows = np.isin(found[0], whole[0])
    left = bool(rows[:-1].all())
    return left and all(np.array_equal(a[outputs], b[rows]) for a, b in zip(whole, found, strict=True))


def stop_and_go_on(
    scene: Path, folder: Path, number: signal.Signals, moments: list[float], whole: list[np.ndarray]
) -> tuple[int, int, bool]:
    """Stop a run again and again, and let it end.

    Returns how often it was stopped, how often it went on from a checkpoint, and whether nothing was lost.
    """
    checkpoint, resumed, kept = folder.with_suffix(".checkpoint"), 0, True
    for stops, moment in enumerate([*moments, None]):
        arguments: list[str | Path] = ["--resume", checkpoint] if checkpoint.exists() else []
        resumed += bool(arguments)
        process = start(scene, folder, "--checkpoint", checkpoint, *arguments)
        try:
            status = process.wait(moment)
        except subprocess.TimeoutExpired:
            os.kill(process.pid, number)
            status = process.wait()
        if status == 0:
            return stops, resumed, kept
        if moment is None:
            raise RuntimeError(f"a run that was resumed failed: {scene}")
        # One that was killed, or that had not begun yet, leaves its checkpoint only.
        if status == 130 and (folder / "result.npz").exists():
            kept = kept and has_all(whole, folder)
    raise AssertionError("the last run ends or fails")


def main() -> None:
    """Print how many runs went on to the same bits."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    columns: dict[str, Counter[str]] = {name: Counter() for name in ("runs", "stops", "resumed", "same")}
    whole: dict[str, tuple[list[np.ndarray], float]] = {}
    with tempfile.TemporaryDirectory() as temporary:
        for index in range(options.count):
            (method, steps), until = list(WAYS.items())[index % len(WAYS)]
            scene = Path(temporary) / f"{method}.toml"
            if method not in whole:
                scene.write_text(SCENE.format(method=method, steps=steps, until=until), encoding="utf-8")
                begun = time.monotonic()
                if start(scene, scene.with_suffix("")).wait() != 0:
                    raise RuntimeError(f"{method} failed")
                whole[method] = states(scene.with_suffix("")), time.monotonic() - begun
            number = (signal.SIGINT, signal.SIGKILL)[index // len(WAYS) % 2]
            expected, seconds = whole[method]
            moments = [chance.uniform(0.0, seconds) for _ in range(chance.randint(1, 3))]
            folder = Path(temporary) / f"run-{index}"
            stops, resumed, kept = stop_and_go_on(scene, folder, number, moments, expected)
            equal = all(np.array_equal(a, b) for a, b in zip(expected, states(folder), strict=True))
            equal = equal and summary(folder) == summary(scene.with_suffix(""))
            found = {"runs": 1, "stops": stops, "resumed": resumed, "same": int(kept and equal)}
            for name, column in columns.items():
                column[f"| `{method}` | {number.name} |"] += found[name]
    print("| method | signal | runs | stops | went on from a checkpoint | same bits, nothing lost |")
    print("|---|---|---|---|---|---|")
    for row in sorted(columns["runs"]):
        print(row, " | ".join(str(column[row]) for column in columns.values()), "|")
    same, stopped = columns["same"].total(), columns["stops"].total()
    print(f"\n{same} of {options.count} runs, {stopped} stops.")
    sys.exit(same != options.count)


if __name__ == "__main__":
    main()
