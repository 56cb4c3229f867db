"""Print how good plans are: true errors and costs of what `ancf.plan` chooses, beside a chart of the same scene.

Run it from any folder with ``OPENBLAS_NUM_THREADS=1 python benchmarks/plan.py``; it takes about half an hour, and some
minutes when references and charts, which do not depend on plans, are kept from before. ``--quick`` takes two scenes.
Names of scenes as arguments take these only. Everything runs on one thread, so that costs are the processor's time and
hardly depend on what else the machine does; the variable keeps NumPy from starting others, whose waiting would count.
"""

from __future__ import annotations

import argparse
import hashlib
import inspect
import pickle
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
from plan_aside import aside
from plan_fresh import fresh
from plan_scenes import Case, developed, made_later
from plan_unseen import first_round, kept, last_round

import ancf
from ancf import _core
from ancf.plan.cost import cache_folder
from ancf.plan.errors import Values, distance, scales
from ancf.plan.ladder import CONTINUOUS, RIGID, THIN, Choice, Family, Rung, Stepping, apply
from ancf.plan.pilots import Pilots
from ancf.run import Method
from ancf.solve import solve

TOLERANCES = (1e-1, 1e-2, 1e-3)
BUDGET = 15.0
"""Seconds for the chart of a scene, whose cheap meshes come first; plans have their own default."""
IMPLICIT: tuple[Method, ...] = ("hht", "generalized_alpha", "energy_momentum", "esdirk", "tr_bdf2")
CONTROLLED: tuple[Method, ...] = ("hht", "esdirk", "tr_bdf2", "verlet", "rk")
_TIMED, _REPEATS, _SHORT = 4, 12, 0.05
"""Of the cheapest runs of a chart, how many are repeated, how often, and up to which seconds."""
CLEAR = 1.0 / 3.0
"""Part of the tolerance up to which references may be apart, so that they tell what is good enough."""


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
    sound: float
    plan_seconds: float
    reference_seconds: float
    both_seconds: float

    @property
    def ratio(self) -> float:
        """Cost relative to the cheapest that is good enough."""
        return self.seconds / self.cheapest

    @property
    def sound_ratio(self) -> float:
        """The same without those that are good enough by accident."""
        return self.seconds / self.sound

    @property
    def clear(self) -> bool:
        """Whether the references are near enough to tell what is good enough."""
        return self.doubt <= CLEAR * self.tol

    def __str__(self) -> str:
        doubtful = "told to be too much" if self.promised > self.tol else "told to be unknown"
        promised = f"{self.promised:.1e}" + ("" if self.converged else f", {doubtful}")
        cells = (
            self.title,
            f"{self.tol:g}",
            self.choice,
            f"{self.error:.1e}",
            promised,
            f"{self.doubt:.0e}",
            f"{self.seconds:.2g}",
            f"{self.cheapest:.2g}: {self.best}",
            f"{self.ratio:.1f}{'' if self.clear else ', not clear'}",
            f"{self.sound_ratio:.1f}",
            f"{self.plan_seconds:.2g}",
            f"{self.reference_seconds:.2g}",
        )
        return f"| {' | '.join(cells)} |"


@dataclass(frozen=True)
class Truth:
    """What is known of a scene without a plan: two references and a chart.

    Parameters
    ----------
    references : dict of Family to (list of ndarray, float)
        Wanted quantities and seconds of the two fine meshes; empty if one did not reach its end.
    tried : list of (float, float, Choice)
        Seconds, error and settings of the chart.
    """

    references: dict[Family, tuple[Values, float]]
    tried: list[tuple[float, float, Choice]]


def truth_of(case: Case) -> Truth:
    """Return what is known of a case; what was found with the same code before is kept in the folder of caches."""
    code = [inspect.getsource(made) for made in (chart, in_time)]
    found_by = repr((case, code, TOLERANCES, BUDGET, IMPLICIT, CONTROLLED)).encode() + Path(_core.__file__).read_bytes()
    key = hashlib.sha256(found_by).hexdigest()[:16]
    file = cache_folder() / "benchmark" / f"{case.scene.title.replace(' ', '-')}-{key}.pickle"
    if file.exists():
        with file.open("rb") as stream:
            return Truth(*pickle.load(stream))
    pilots = Pilots(case.scene, ["A"], 1e9, 1)
    references: dict[Family, tuple[Values, float]] = {}
    for family, mesh in zip((CONTINUOUS, THIN[0]), case.fine, strict=True):
        pilot = pilots.run(Choice(Rung(family, (mesh,)), case.stepping))
        if not pilot.ok:
            print(case.scene.title, family, pilot.outcome, file=sys.stderr)
            return Truth({}, [])
        references[family] = pilot.values, pilot.seconds
    truth = Truth(references, chart(case, pilots, references[CONTINUOUS][0]))
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("wb") as stream:
        pickle.dump((truth.references, truth.tried), stream)
    return truth


def judge(name: str) -> list[Line]:
    """Plan a scene to all tolerances, and compare with references and a chart."""
    case = next(
        case
        for case in (*developed(), *made_later(), *first_round(), *kept(), *last_round(), *aside(), *fresh())
        if case.scene.title == name
    )
    known = truth_of(case)
    if not known.references:
        return []
    (exact, first), (other, second) = (known.references[family] for family in (CONTINUOUS, THIN[0]))
    doubt = distance(exact, other, scales(exact))
    try:
        # Where references are apart they judge only what is looser.
        tolerances = [tol for tol in TOLERANCES if doubt <= tol]
        plans = [ancf.plan(case.scene, want="A", tol=tol, threads=1) for tol in tolerances]
    except ancf.InputError as mistake:
        print(name, mistake, file=sys.stderr)
        return []
    lines = []
    for tol, plan in zip(tolerances, plans, strict=True):
        # Another element than the one that is judged.
        truth = other if plan.choice.startswith("thin48") else exact
        error = distance([plan.result.probes["A"].value], truth, scales(truth))
        fits = sorted(((s, c) for s, off, c in known.tried if off <= tol), key=lambda fit: fit[0])
        own = again(plan.scene, plan.rows[plan.chosen].seconds)
        # Many short runs are likely to hold a lucky one: the cheapest few are timed as often as the choice.
        near = [(again(apply(case.scene, choice), seconds), str(choice)) for seconds, choice in fits[:_TIMED]]
        firm = [(again(apply(case.scene, c), s), str(c)) for s, c in sounds(case, fits, exact, tol, own)]
        cheapest, best = min([*near, *firm, (own, plan.choice)])
        sound, _ = min([*firm, (own, plan.choice)])
        own_error = plan.error + plan.error_in_time
        cells = (own_error, plan.converged, doubt, own, cheapest, best, sound, plan.seconds, second, first + second)
        lines.append(Line(name, tol, plan.choice, error, *cells))
    return lines


def sounds(
    case: Case, fits: list[tuple[float, Choice]], exact: Values, tol: float, limit: float
) -> list[tuple[float, Choice]]:
    """Return the cheapest few that are good enough and stay so when elements along x or y, or steps, are halved.

    Where a finer neighbour is not good enough errors have cancelled: that cannot be known without the answer.
    """
    pilots = Pilots(case.scene, ["A"], 1e9, 1)
    found: list[tuple[float, Choice]] = []
    for seconds, choice in fits:
        if seconds > limit or len(found) == _TIMED:
            break
        finer = [
            replace(choice, rung=rung) for side in ((0, 0), (0, 1)) if (rung := choice.rung.scaled(side, Fraction(2)))
        ]
        if choice.rung.family == RIGID:
            finer = []
        if choice.stepping is not None:
            finer.append(replace(choice, stepping=choice.stepping.tighter()))
        done = (pilots.run(each) for each in finer)
        if all(pilot.ok and distance(pilot.values, exact, scales(exact)) <= tol for pilot in done):
            found.append((seconds, choice))
    return found


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
    parser.add_argument("--holdout", action="store_true", help="scenes planned first when the rules were fixed")
    options = parser.parse_args()
    sets = {"developed on": developed(), "made later": made_later(), "first unseen": first_round()}
    if options.holdout:
        sets = {"kept": kept(), "of the last round": last_round(), "put aside": aside(), "put aside last": fresh()}
    named = {name: [case.scene.title for case in cases] for name, cases in sets.items()}
    columns = "scene, tolerance, chosen, true error, promised, reference to, s, cheapest s, ratio, without accidents"
    columns += ", plan s, reference s"
    print(f"| {columns.replace(', ', ' | ')} |")
    print("|---" * len(columns.split(", ")) + "|")
    wanted = options.scenes or (["thick plate", "steel hinged"] if options.quick else None)
    lines: dict[str, list[Line]] = {name: [] for name in sets}
    with ProcessPoolExecutor(2) as pool:
        for name, titles in named.items():
            for found in pool.map(judge, [title for title in titles if wanted is None or title in wanted]):
                lines[name] += found
                print(*found, sep="\n", flush=True)
    for name, found in lines.items():
        if found:
            print(f"\nScenes {name}:\n")
            conclude(found)


def conclude(lines: list[Line]) -> None:
    """Print what follows from the lines."""
    below = [line.error <= line.tol for line in lines]
    told = [line.error <= line.tol for line in lines if line.converged]
    promised = f"where the plan promises it {sum(told)} of {len(told)}"
    print(f"* Below the tolerance: {sum(below)} of {len(below)}; {promised}.")
    print(f"* Largest true error relative to the tolerance: {max(line.error / line.tol for line in lines):.2g}.")
    for what, ratios in (
        ("", [line.ratio for line in lines]),
        (", without those that are so by accident", [line.sound_ratio for line in lines]),
        (", the same where references are clear", [line.sound_ratio for line in lines if line.clear]),
    ):
        print(
            f"* Cost relative to the cheapest good enough{what}: median {np.median(ratios):.2g}, "
            f"largest {max(ratios):.2g}, at most 2 in {sum(ratio <= 2 for ratio in ratios)} of {len(ratios)}."
        )
    less = sum(line.plan_seconds < line.reference_seconds for line in lines)
    both = sum(line.plan_seconds < line.both_seconds for line in lines)
    print(
        f"* Seconds of plans: {sum(line.plan_seconds for line in lines):.0f}, less than one run of the reference in "
        f"{less} of {len(lines)}, than both in {both}; of the choices {sum(line.seconds for line in lines):.2g}, "
        f"of runs of the references {sum(line.reference_seconds for line in lines):.0f}."
    )


if __name__ == "__main__":
    main()
