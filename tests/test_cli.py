"""The command line: files, exit status, interruption."""

import dataclasses
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import ancf
from ancf.cli import main
from ancf.output import summarize
from ancf.scene import Scene

Edit = Callable[..., Path]


def summary(folder: Path) -> dict[str, Any]:
    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is not JSON")

    text = (folder / "summary.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text, parse_constant=refuse)
    return found


def test_run_writes_summary_and_states(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "some" / "folder"
    assert main(["run", str(scenes / "pendulum.toml"), "-o", str(folder), "--threads", "1"]) == 0
    told = capsys.readouterr()
    assert "Small pendulum: ok, t = 0.05 s" in told.out
    assert told.err == ""  # no bar unless it is a terminal
    found = summary(folder)
    assert list(found) == [
        "title", "status", "reached", "reason", "advice", "warnings", "counts", "seconds", "probes", "energy",
        "reactions",
    ]  # fmt: skip
    assert found["warnings"] == []
    assert (found["title"], found["status"], found["reason"]) == ("Small pendulum", "ok", "")
    assert found["reached"] == pytest.approx(0.05)
    assert found["counts"]["elements"] == 4
    assert found["counts"]["dofs"] == 78
    assert set(found["counts"]) == {
        "elements",
        "dofs",
        "steps",
        "rejected",
        "inaccurate",
        "unsolved",
        "singular",
        "not_finite",
        "iterations",
        "forces",
        "factorizations",
    }
    assert set(found["seconds"]) == {"total", "setup", "assembly", "factorization", "solve"}
    assert found["probes"]["A"]["t"] == pytest.approx([0.0, 0.025, 0.05])
    assert found["probes"]["A"]["value"][0] == pytest.approx([0.3, 0.3, 0.0])
    assert set(found["energy"]) == {"t", "kinetic", "membrane", "bending", "loads", "dissipated"}
    with np.load(folder / "result.npz") as states:
        assert states["q"].shape == states["v"].shape == states["a"].shape == (3, 81)
        np.testing.assert_allclose(states["t"], [0.0, 0.025, 0.05])
    assert sorted(path.name for path in folder.iterdir()) == ["result.npz", "summary.json"]


def test_the_summary_has_no_numbers_that_are_not_json(pendulum: ancf.Model) -> None:
    result = ancf.simulate(pendulum, until=0.01, step=5e-3)
    energy = dataclasses.replace(result.energy, kinetic=np.array([0.0, np.nan, np.inf]))
    found = summarize("", dataclasses.replace(result, reached=float("nan"), energy=energy))
    assert found["reached"] is None
    assert found["energy"]["kinetic"] == [0.0, None, None]


def test_pictures(scenes: Path, tmp_path: Path) -> None:
    arguments = ["run", str(scenes / "cantilever.toml"), "-o", str(tmp_path), "--plot", "--animate", "--quiet"]
    assert main(arguments) == 0
    assert summary(tmp_path)["probes"]["tip"]["t"] == [0.0, 0.5, 1.0]
    with Image.open(tmp_path / "plate.png") as picture:
        assert picture.width > 1000
        colours = np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)
        assert len(colours) > 500  # a shaded surface, not an empty frame
    with Image.open(tmp_path / "motion.gif") as film:
        assert getattr(film, "n_frames", 1) == 3
    assert {path.name for path in tmp_path.iterdir()} == {"motion.gif", "plate.png", "result.npz", "summary.json"}


def test_a_film_without_ffmpeg(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: False)
    folder = tmp_path / "out"
    assert main(["run", str(scenes / "cantilever.toml"), "-o", str(folder), "--animate", "mp4"]) == 2
    assert "needs the program ffmpeg" in capsys.readouterr().err
    assert not folder.exists()


def test_an_output_that_is_a_file(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "out"
    file.write_text("mine")
    for folder in (file, file / "below"):
        assert main(["run", str(scenes / "cantilever.toml"), "-o", str(folder)]) == 2
        assert f"{folder}: cannot be written to" in capsys.readouterr().err
    assert file.read_text() == "mine"


def test_a_failed_run_is_written(edit: Edit, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = edit("pendulum.toml", ("step = 5e-3", "step = 5e-3\nmax_iterations = 1\ntolerance = 1e-14"))
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--quiet"]) == 3
    found = summary(tmp_path / "out")
    assert found["status"] == "failed"
    assert found["reason"]
    assert found["advice"]
    assert len(found["probes"]["A"]["t"]) == len(found["energy"]["t"]) >= 1
    assert found["advice"] in capsys.readouterr().err


def test_energy_from_nowhere_is_told(edit: Edit, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A soft, thin plate that steps of 8 ms cannot follow gains most of what it fell for; with 2 ms it does not."""
    for step, warnings in (("8e-3", 1), ("2e-3", 0)):
        scene = edit(
            "pendulum.toml",
            ("E = 1e5", "E = 1e7"),
            ("divisions = [2, 2]", "divisions = [4, 4]"),
            ("thickness = 0.01", "thickness = 0.001"),
            ("until = 0.05", "until = 0.32"),
            ("step = 5e-3\noutputs = [0.025, 0.05]", f"step = {step}\nevery = 8e-3"),
        )
        assert main(["run", str(scene), "-o", str(tmp_path), "--quiet"]) == 0
        found = summary(tmp_path)
        assert len(found["warnings"]) == warnings
        energy = {name: np.array(values) for name, values in found["energy"].items()}
        balance = energy["kinetic"] + energy["membrane"] + energy["bending"] - energy["loads"]
        assert (np.max(balance) > 0.5 * np.max(energy["loads"])) == bool(warnings)
        told = [f"ancf: warning: {text}\n" for text in found["warnings"]]
        assert "".join(told) == capsys.readouterr().err
        gain = np.max(balance - np.minimum.accumulate(balance))
        assert all(f"rises by {gain:.3g} J" in text for text in found["warnings"])


def test_an_error_while_writing_leaves_the_earlier_run(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["run", str(scenes / "cantilever.toml"), "-o", str(tmp_path), "--quiet"]
    assert main(arguments) == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(file: io.BufferedWriter, **arrays: object) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("numpy.savez_compressed", full)
    assert main(arguments) == 1
    names = f"{tmp_path / 'result.npz'}, {tmp_path / 'summary.json'}"
    assert capsys.readouterr().err == f"ancf: [Errno 28] No space left on device: {names!r}\n"
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_folder_removed_meanwhile_is_made_again(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = Scene.solve

    def solve_and_remove(*arguments: Any, **options: Any) -> Any:
        result = solve(*arguments, **options)
        (tmp_path / "a" / "b").rmdir()
        (tmp_path / "a").rmdir()
        return result

    monkeypatch.setattr(Scene, "solve", solve_and_remove)
    assert main(["run", str(scenes / "cantilever.toml"), "-o", str(tmp_path / "a" / "b"), "--quiet", "--plot"]) == 0
    names = sorted(path.name for path in (tmp_path / "a" / "b").iterdir())
    assert names == ["plate.png", "result.npz", "summary.json"]


def test_letters_without_a_font_are_told_in_one_line(
    edit: Edit, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ancf.text._FAMILIES", ("none such",))
    scene = edit("cantilever.toml", ('title = "Small cantilever"', 'title = "\u6771\u4eac, \u6771"'))
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--quiet", "--plot"]) == 0
    told = "ancf: warning: no font has these letters, which are boxes in the pictures: \u6771\u4eac\n"
    assert capsys.readouterr().err == told


def test_a_hinge_alone_holds_nothing_in_statics(edit: Edit, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = edit("cantilever.toml", ("clamp = true", 'fix = ["r"]'))
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--plot", "--animate"]) == 2
    assert "can still move: rotation about y" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption_keeps_the_results(edit: Edit, tmp_path: Path, number: signal.Signals) -> None:
    scene = edit("pendulum.toml", ("until = 0.05", "until = 500"), ("outputs = [0.025, 0.05]", "every = 0.5"))
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "ancf", "run", str(scene), "-o", str(folder)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment) as run:
        while not folder.exists() and run.poll() is None:
            time.sleep(0.02)
        time.sleep(0.3)
        run.send_signal(number)
        _, told = run.communicate(timeout=30)
    assert run.returncode == 130
    assert "interrupted at t =" in told
    found = summary(folder)
    assert found["status"] == "interrupted"
    assert found["reached"] < 500
    assert (folder / "result.npz").exists()


def start(arguments: list[str]) -> "subprocess.Popen[str]":
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    command = [sys.executable, "-m", "ancf", *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)


def wait_for(path: Path, run: "subprocess.Popen[str]") -> None:
    while not path.exists() and run.poll() is None:
        time.sleep(0.02)


def test_an_interruption_twice_keeps_the_results(edit: Edit, tmp_path: Path) -> None:
    scene = edit("pendulum.toml", ("until = 0.05", "until = 500"), ("outputs = [0.025, 0.05]", "every = 0.5"))
    folder = tmp_path / "out"
    with start(["run", str(scene), "-o", str(folder)]) as run:
        wait_for(folder, run)
        time.sleep(0.5)
        for _ in range(20):
            run.send_signal(signal.SIGINT)
            time.sleep(0.01)
        _, told = run.communicate(timeout=30)
    assert run.returncode == 130
    assert "Traceback" not in told
    assert summary(folder)["status"] == "interrupted"


def test_an_interruption_while_the_film_is_made(edit: Edit, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    scene = edit("pendulum.toml", ("outputs = [0.025, 0.05]", "every = 5e-4"))
    with start(["run", str(scene), "-o", str(folder), "--animate", "--quiet"]) as run:
        wait_for(folder / "summary.json", run)
        time.sleep(1.5)
        run.send_signal(signal.SIGINT)
        _, told = run.communicate(timeout=30)
    assert run.returncode == 130
    assert told == "ancf: interrupted\n"
    assert sorted(path.name for path in folder.iterdir()) == ["result.npz", "summary.json"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_of_the_imports(number: signal.Signals) -> None:
    """Python runs this when NumPy is looked for."""
    code = f"""
import os, sys, ancf_command
class Finder:
    def find_spec(name, path=None, target=None):
        if name == "numpy":
            os.kill(os.getpid(), {int(number)})
sys.meta_path.insert(0, Finder)
sys.exit(ancf_command.main())
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    told = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=60, check=False
    )
    assert (told.returncode, told.stdout, told.stderr) == (130, "", "ancf: interrupted\n")


def test_a_killed_run_leaves_no_summary_of_an_earlier_one(edit: Edit, tmp_path: Path) -> None:
    """And the run after it has its own."""
    short, folder = str(edit("pendulum.toml")), tmp_path / "out"
    assert main(["run", short, "-o", str(folder), "--quiet"]) == 0
    before = (folder / "summary.json").read_bytes()
    long = edit("pendulum.toml", ("until = 0.05", "until = 500"), ("outputs = [0.025, 0.05]", "every = 0.5"))
    with start(["run", str(long), "-o", str(folder)]) as run:
        wait_for(folder / "earlier" / "summary.json", run)
        run.kill()
    assert sorted(path.name for path in folder.iterdir()) == ["earlier"]
    assert (folder / "earlier" / "summary.json").read_bytes() == before
    assert main(["run", str(edit("pendulum.toml")), "-o", str(folder), "--quiet"]) == 0
    assert sorted(path.name for path in folder.iterdir()) == ["result.npz", "summary.json"]


def test_info(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info"]) == 0
    lines = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert lines["ancf"] == ancf.__version__
    assert lines["numpy"] == np.__version__


@pytest.mark.parametrize("arguments", [[], ["run"], ["run", "x.toml", "-o", "out", "--threads", "0"], ["walk"]])
def test_wrong_arguments(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    assert "usage: ancf" in capsys.readouterr().err


@pytest.mark.parametrize("moment", [0.0, 0.01])
def test_a_signal_within_a_finalizer_is_not_lost(moment: float) -> None:
    """Python drops what is raised there, and in the hook that is told of it, which may take any time."""
    code = f"""
import os, signal, time, weakref
from ancf.commands import signals
signals._MOMENT = {moment}
class Thing: pass
def last(_):
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(0.01)
signals.watch_signals()
thing = Thing()
reference = weakref.ref(thing, last)
try:
    del thing
    for _ in range(300):
        time.sleep(0.1)
except KeyboardInterrupt:
    print("interrupted")
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    told = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=60, check=True
    )
    assert (told.stdout, told.stderr) == ("interrupted\n", "")
