"""Maps of where methods fail, and the suite."""

import csv
from pathlib import Path

import numpy as np
import pytest

import ancf
from ancf.cli import main
from ancf.records import Energy
from ancf.stability import run_suite
from ancf.stability.cells import classify, energy_gain
from ancf.stability.expect import Case, agree, balanced, closer, ends, fails_or_gains, fewer_iterations, near, well
from ancf.sweep import Outcome, Variant, sweep


def energy(surplus: list[float]) -> Energy:
    """Energies of a body that falls, 2 J in the end, and what comes from nowhere."""
    fallen = np.linspace(0, 2, len(surplus))
    zero = np.zeros(len(surplus))
    return Energy(zero, fallen + np.array(surplus), zero, zero, fallen, zero)


def test_energy_from_nowhere() -> None:
    assert energy_gain(energy([0, 0, 0])) == 0
    assert energy_gain(energy([0, 1, 2])) == pytest.approx(2 / 4)
    assert energy_gain(energy([0, -0.5, -1])) == pytest.approx(-0.5)
    assert energy_gain(energy([0, 1, np.nan])) == np.inf


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a map of the small pendulum."""
    made = tmp_path_factory.mktemp("map")
    scene = Path(__file__).parent / "scenes" / "pendulum.toml"
    arguments = ["stability", str(scene), "-o", str(made), "--against", "E=1e5,1e9", "--steps", "0.005", "0.0001"]
    assert main([*arguments, "--methods", "verlet", "newmark", "tr_bdf2", "--limit", "30", "--quiet"]) == 0
    return made


def test_the_map_tells_what_is_known(folder: Path) -> None:
    """2 / omega_max: stiffer by 1e4 in E means shorter by 100; explicit steps above it are refused, below it hold."""
    with (folder / "stability.csv").open(encoding="utf-8", newline="") as file:
        found = {(row["method"], float(row["E"]), float(row["step"])): row for row in csv.DictReader(file)}
    assert len(found) == 3 * 2 * 2
    soft, hard = (float(found["verlet", E, 0.005]["explicit_limit"]) for E in (1e5, 1e9))
    assert soft / hard == pytest.approx(100, rel=0.01)
    for (method, E, step), row in found.items():
        if method == "verlet":
            limit = soft if E == 1e5 else hard
            assert row["kind"] == ("accurate" if step < limit else "refused")
    for step in (0.005, 0.0001):
        assert found["tr_bdf2", 1e5, step]["kind"] == "accurate"


def test_the_files_of_a_map(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    assert names == {"runs.jsonl", *(f"stability.{kind}" for kind in ("png", "svg", "csv", "md", "html"))}
    assert "data:image/png;base64," in (folder / "stability.html").read_text(encoding="utf-8")


def test_kinds(scenes: Path, tmp_path: Path) -> None:
    scene = ancf.load_scene(scenes / "pendulum.toml")
    exact, coarse, forced = (
        Variant.of(scene, outputs=[0.025, 0.05], **settings)
        for settings in (
            {"method": "esdirk", "rtol": 1e-5},
            {"method": "hht", "step": 0.025, "E": 1e8, "alpha": -1 / 3},
            {"method": "verlet", "step": 0.0025, "E": 1e8, "force": True},
        )
    )
    small, large, exploded = sweep([exact, coarse, forced], tmp_path / "log.jsonl")
    assert small is not None
    assert large is not None
    assert exploded is not None
    assert classify("esdirk", 0, 0, small, small).kind == "accurate"
    assert classify("hht", 0, 0, large, small).kind in ("wrong", "accurate", "newton")
    assert classify("verlet", 0, 0, exploded, small).kind == "blow-up"
    assert classify("hht", 0, 0, small, None).kind == "unknown"


def test_statics_have_no_map(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stability", str(scenes / "cantilever.toml"), "-o", str(tmp_path / "deep" / "map")]) == 2
    assert 'run.kind = "static": must be dynamic' in capsys.readouterr().err
    assert not (tmp_path / "deep").exists()
    assert main(["stability", "-o", str(tmp_path)]) == 2
    assert "either a scene or --suite" in capsys.readouterr().err


@pytest.mark.parametrize("ignored", [("--against", "thickness"), ("--limit", "1"), ("--methods", "hht")])
def test_the_suite_has_no_axes(ignored: tuple[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stability", "--suite", *ignored, "-o", str(tmp_path)]) == 2
    assert f"{ignored[0].removeprefix('--')}: is for the map of a scene" in capsys.readouterr().err


def test_the_quick_suite(tmp_path: Path) -> None:
    verdicts = run_suite(tmp_path / "log.jsonl", quick=True)
    assert [verdict.case.name for verdict in verdicts if verdict.problems] == []
    assert len(verdicts) >= 6


def test_expectations_see_what_is_wrong(scenes: Path, tmp_path: Path) -> None:
    scene = ancf.load_scene(scenes / "pendulum.toml")
    good, other, bad = Variant.of(scene), Variant.of(scene, E=1e3), Variant.of(scene, membrane="no such")
    outcomes = sweep([good, other, bad], tmp_path / "log.jsonl")
    found: dict[str, Outcome] = {
        name: outcome for name, outcome in zip(("good", "other", "bad"), outcomes, strict=True) if outcome is not None
    }
    assert well("good")(found) == ""
    assert "bad" in well()(found)
    assert balanced("good", within=0.1)(found) == ""
    assert "energy gain" in balanced("good", within=-1.0)(found)
    assert ends("refused", "bad", reason="membrane")(found) == ""
    assert ends("refused", "good")(found)
    assert "differs" in agree("good", "other", within=1e-12)(found)
    assert "differs" in agree("good", "bad", within=1e-3)(found)
    assert "instead of" in near("good", (0, 0, 0), 1e-3)(found)
    assert "does well" in fails_or_gains("good", more_than=0.05)(found)
    assert fails_or_gains("bad", more_than=0.05)(found) == ""
    assert fewer_iterations("good", "bad")(found)
    assert closer("other", "good", to="good")(found) == ""
    assert closer("good", "other", to="good")(found)
    case = Case("", {"good": good}, [], quick=True)
    assert case.tell(found["bad"]).startswith("refused")
