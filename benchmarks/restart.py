"""Stop runs at random moments, go on from their checkpoints, and compare with a run that was not stopped.

Run it from any folder with ``python benchmarks/restart.py``. Half of the runs are interrupted as by Ctrl-C, half are
killed without warning (POSIX); each is stopped up to three times. ``--count`` says how many there are, ``--seed`` which
moments.
"""

from __future__ import annotations

import argparse
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
    ("tr_bdf2", "rtol = 1e-4"): 2.0,
    ("esdirk", "rtol = 1e-5"): 2.0,
    ("energy_momentum", "step = 5e-4\nreuse = false"): 2.0,
    ("verlet", "step = 5e-5"): 2.0,
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


def stop_and_go_on(scene: Path, folder: Path, number: signal.Signals, moments: list[float]) -> tuple[int, bool]:
    """Stop a run again and again; return how often it was, and whether what an interruption left was all it had."""
    checkpoint, stops, kept = folder.with_suffix(".checkpoint"), 0, True
    for moment in moments:
        arguments: list[str | Path] = ["--resume", checkpoint] if checkpoint.exists() else []
        process = start(scene, folder, "--checkpoint", checkpoint, *arguments)
        time.sleep(moment)
        if process.poll() is not None:
            return stops, kept
        os.kill(process.pid, number)
        status = process.wait()
        if status == 0:
            return stops, kept
        stops += 1
        if number == signal.SIGINT and status == 130 and checkpoint.exists():
            # Accepted outputs come without a gap, whether they were computed before or after the last stop.
            t = states(folder)[0]
            outputs = t[:-1] if len(t) > 1 else t
            kept = kept and bool(np.allclose(outputs, 0.01 * np.arange(len(outputs)), atol=1e-12))
    arguments = ["--resume", checkpoint] if checkpoint.exists() else []
    if start(scene, folder, "--checkpoint", checkpoint, *arguments).wait() != 0:
        raise RuntimeError(f"a run that was resumed failed; seed and files: {folder}")
    return stops, kept


def main() -> None:
    """Print how many runs went on to the same bits."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    same: Counter[str] = Counter()
    runs: Counter[str] = Counter()
    stops: Counter[str] = Counter()
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
            stopped, kept = stop_and_go_on(scene, folder, number, moments)
            equal = all(np.array_equal(a, b) for a, b in zip(expected, states(folder), strict=True))
            name = f"| `{method}` | {number.name} |"
            runs[name] += 1
            stops[name] += stopped
            same[name] += kept and equal
    print("| method | signal | runs | stops | same bits, nothing lost |\n|---|---|---|---|---|")
    for name, count in sorted(runs.items()):
        print(name, count, "|", stops[name], "|", same[name], "|")
    print(f"\n{sum(same.values())} of {options.count} runs, {sum(stops.values())} stops.")
    sys.exit(sum(same.values()) != options.count)


if __name__ == "__main__":
    main()
