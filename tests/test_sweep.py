"""Sweeps: what is kept on disk, what a run that fails costs, where they run."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ancf
from ancf.sweep import Outcome, Variant, dask_executor, sweep, time_alone
from ancf.sweep.apart import kill_busy_workers


@pytest.fixture
def scene(scenes: Path) -> ancf.Scene:
    return ancf.load_scene(scenes / "pendulum.toml")


def endless(scene: ancf.Scene) -> Variant:
    """So small steps that it would take hours, in a part of the motion that no method fails at."""
    return Variant.of(scene, step=1e-8)


def test_an_outcome_is_what_the_scene_gives_in_this_process(scene: ancf.Scene, tmp_path: Path) -> None:
    (outcome,) = sweep([Variant.of(scene)], tmp_path / "log.jsonl", limit=60)
    assert outcome is not None
    expected = scene.solve()
    assert (outcome.status, outcome.reason) == ("ok", "")
    assert outcome.reached == expected.reached
    assert outcome.counts == expected.counts
    np.testing.assert_array_equal(outcome.probes["A"].t, expected.t)
    np.testing.assert_array_equal(outcome.probes["A"].value, expected.probes["A"].value)
    assert outcome.energy is not None
    np.testing.assert_array_equal(outcome.energy.loads, expected.energy.loads)


def test_settings_are_replaced_where_they_belong(scene: ancf.Scene) -> None:
    varied = Variant.of(scene, element="full48a", mesh=2, thickness=0.02, E=2e5, rtol=1e-3, method="tr_bdf2")
    made = ancf.Scene.of(varied.scene)
    plate = made.model.bodies["plate"]
    assert isinstance(made.run, ancf.Dynamic)
    assert (plate.element, plate.membrane, plate.divisions) == ("full48a", None, (4, 4))
    assert (plate.thickness, plate.material.E, plate.material.nu) == (0.02, 2e5, 0.3)
    assert (made.run.rtol, made.run.step, made.run.method) == (1e-3, None, "tr_bdf2")
    given = ancf.load_scene(Path(__file__).parent / "scenes" / "pendulum.toml").run
    assert isinstance(given, ancf.Dynamic)
    assert made.run.until == given.until
    assert Variant.of(scene, step=1e-3).digest != Variant.of(scene, step=2e-3).digest
    assert Variant.of(scene, step=1e-3).digest == Variant.of(scene, step=1e-3).digest


def test_a_run_that_goes_wrong_costs_only_itself(scene: ancf.Scene, tmp_path: Path) -> None:
    variants = [
        endless(scene),
        Variant.of(scene, membrane="no such"),
        Variant.of(scene, max_iterations=1, tolerance=1e-14),
        Variant.of(scene),
    ]
    outcomes = sweep(variants, tmp_path / "log.jsonl", limit=2)
    assert [outcome and outcome.status for outcome in outcomes] == ["time limit", "refused", "failed", "ok"]
    late, refused, failed, _ = (outcome.reason for outcome in outcomes if outcome)
    assert late == "stopped after 2 s"
    assert 'body.plate.membrane = "no such": allowed are projected, full, lobatto' in refused
    assert failed


def test_a_crash_costs_only_itself_and_is_tried_again(scene: ancf.Scene, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    over = threading.Event()

    def kill_when_the_other_is_done() -> None:
        while not over.wait(0.02):
            if log.exists() and b"\n" in log.read_bytes():
                kill_busy_workers()

    killer = threading.Thread(target=kill_when_the_other_is_done)
    killer.start()
    outcomes = sweep([Variant.of(scene), endless(scene)], log, limit=600)
    over.set()
    killer.join()
    assert [outcome and outcome.status for outcome in outcomes] == ["ok", "crashed"]
    assert outcomes[1] is not None
    assert "ended with status -9" in outcomes[1].reason
    (again,) = sweep([endless(scene)], log, limit=1)
    assert again is not None
    assert again.status == "time limit"


def test_what_is_in_the_log_is_not_run_again(scene: ancf.Scene, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    variants = [Variant.of(scene, step=step) for step in (5e-3, 2.5e-3)]
    first = sweep(variants, log)
    kept = log.read_bytes()
    # As a kill in the middle of a write leaves it: the second line is half there.
    half = kept[: kept.index(b"\n") + 200]
    log.write_bytes(half)
    second = sweep(variants, log)
    lines = log.read_bytes().splitlines()
    assert len(lines) == 2
    assert lines[0] == kept.splitlines()[0]
    for before, after in zip(first, second, strict=True):
        assert isinstance(before, Outcome)
        assert isinstance(after, Outcome)
        np.testing.assert_array_equal(before.probes["A"].value, after.probes["A"].value)
    sweep(variants, log)
    assert log.read_bytes().splitlines() == lines


def test_a_stopped_run_is_tried_again_only_with_more_time(scene: ancf.Scene, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    for limit, lines in ((0.2, 1), (0.1, 1), (0.4, 2)):
        sweep([endless(scene)], log, limit=limit)
        assert len(log.read_text().splitlines()) == lines


def test_another_file_is_not_a_log(scene: ancf.Scene, tmp_path: Path) -> None:
    other = tmp_path / "mine.txt"
    other.write_text("mine\n")
    with pytest.raises(ancf.InputError, match="is not the log of a sweep"):
        sweep([Variant.of(scene)], other)
    assert other.read_text() == "mine\n"


def test_no_run_begins_beyond_the_budget(scene: ancf.Scene, tmp_path: Path) -> None:
    variants = [Variant.of(scene), *(Variant.of(scene, step=1e-6, until=until) for until in np.linspace(1, 2, 12))]
    started = time.monotonic()
    outcomes = sweep(variants, tmp_path / "log.jsonl", limit=3, budget=2)
    assert time.monotonic() - started < 20
    assert outcomes[0] is not None
    assert outcomes[-1] is None


def test_timings_are_repeated(scene: ancf.Scene, tmp_path: Path) -> None:
    variants = [Variant.of(scene), Variant.of(scene, membrane="no such")]
    timing, refused = time_alone(variants, tmp_path / "log.jsonl", repeats=3)
    assert timing is not None
    assert len(timing.seconds) == 3
    assert timing.best == min(timing.seconds) <= timing.median
    assert all(processor > 0 for processor in timing.processor)
    assert refused is None
    rows = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert sorted(row["repeat"] for row in rows) == [1, 1, 2, 2, 3, 3]


PROGRAM = """
import sys
import ancf
from ancf.sweep import Variant, sweep

scene = ancf.load_scene(sys.argv[1])
quick = [Variant.of(scene, until=until, outputs=None) for until in (0.01, 0.02, 0.03)]
slow = [Variant.of(scene, step=step) for step in (1e-8, 2e-8)]
sweep([*quick, *slow], sys.argv[2], limit=600)
"""


def processes_below(pid: int) -> list[int]:
    """Return the children of a process."""
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False)
    return [int(child) for child in found.stdout.split()]


@pytest.mark.skipif(sys.platform != "linux", reason="ps and signals as on Linux")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_sweep_that_is_stopped_leaves_no_process_and_goes_on(
    scenes: Path, tmp_path: Path, number: signal.Signals
) -> None:
    log = tmp_path / "log.jsonl"
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(scenes / "pendulum.toml"), str(log)], stderr=subprocess.PIPE, text=True
    ) as program:
        lines = 0
        while lines < 3 and program.poll() is None:
            time.sleep(0.05)
            lines = log.read_text().count("\n") if log.exists() else 0
        children = processes_below(program.pid)
        started = time.monotonic()
        program.send_signal(number)
        _, told = program.communicate(timeout=30)
    assert children
    assert ("KeyboardInterrupt" in told) == (number == signal.SIGINT)
    assert time.monotonic() - started < 10
    for _ in range(100):
        if not any(Path(f"/proc/{child}").exists() for child in children):
            break
        time.sleep(0.05)
    assert not any(Path(f"/proc/{child}").exists() for child in children)
    before = log.read_text()
    assert before.count("\n") == 3
    scene = ancf.load_scene(scenes / "pendulum.toml")
    sweep([Variant.of(scene, until=until, outputs=None) for until in (0.01, 0.02, 0.03)], log)
    assert log.read_text() == before


@pytest.mark.filterwarnings("default")
def test_a_dask_cluster_of_which_a_worker_is_killed(scene: ancf.Scene, tmp_path: Path) -> None:
    distributed: Any = pytest.importorskip("distributed")
    log = tmp_path / "log.jsonl"
    variants = [Variant.of(scene, step=1e-4 + index * 1e-6) for index in range(10)]
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=100
    ) as cluster:

        def kill_one_half_way() -> None:
            while not log.exists() or log.read_text().count("\n") < 5:
                time.sleep(0.01)
            os.kill(cluster.workers[0].process.process.pid, signal.SIGKILL)

        killer = threading.Thread(target=kill_one_half_way)
        killer.start()
        with dask_executor(cluster.scheduler_address) as executor:
            outcomes = sweep(variants, log, limit=60, executor=executor)
        killer.join()
    assert [outcome and outcome.status for outcome in outcomes] == ["ok"] * 10
    assert sorted(json.loads(line)["digest"] for line in log.read_text().splitlines()) == sorted(
        variant.digest for variant in variants
    )


def test_no_cluster_at_that_address() -> None:
    pytest.importorskip("distributed")
    with pytest.raises(ancf.InputError, match="dask"), dask_executor("nonsense://nowhere"):
        pass
