"""The README does what it says: its commands, its Python, its table of results, the numbers it was printed with."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from ancf.cli import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_command_runs_from_another_folder(tmp_path: Path) -> None:
    command = re.search(r"\.venv/bin/ancf (run \S+) -o \S+ --plot", README)
    assert command is not None
    scene = ROOT / command[1].removeprefix("run ")
    done = subprocess.run(
        [sys.executable, "-m", "ancf", "run", str(scene), "-o", "out/pendulum", "--plot"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    written = {path.name for path in (tmp_path / "out" / "pendulum").iterdir()}
    assert written == {"plate.png", "summary.json", "result.npz"}


def test_the_python_runs(tmp_path: Path) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "cantilever.png").stat().st_size > 10_000


def test_the_scene_in_the_documentation_runs(tmp_path: Path) -> None:
    (scene,) = re.findall(
        r"```toml\n(.*?)```", (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8"), flags=re.DOTALL
    )
    path = tmp_path / "scene.toml"
    path.write_text(scene.replace("until = 0.3", "until = 0.01"), encoding="utf-8")
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "--quiet"]) == 0


def test_the_cantilever_of_newcomers_bends_as_the_page_says(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "coming-from.md").read_text(encoding="utf-8")
    theirs, ours = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert "import exudyn" in theirs
    done = subprocess.run([sys.executable, "-c", ours], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (deflection,) = re.findall(r"Both bend by ([0-9.]+) m", page)
    assert float(done.stdout.strip("[] \n").split()[2]) == pytest.approx(-float(deflection), abs=1e-5)


def test_every_link_leads_somewhere() -> None:
    for path in [*ROOT.glob("*.md"), *ROOT.glob("benchmarks/*.md"), *ROOT.glob("docs/**/*.md")]:
        for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8")):
            if not target.startswith("http"):
                assert (path.parent / target).exists(), f"{path}: {target}"


def test_the_table_is_what_its_command_prints() -> None:
    match = re.search(r"<!-- results -->\n(.*?)<!-- /results -->", README, flags=re.DOTALL)
    assert match is not None
    done = subprocess.run(
        [sys.executable, str(ROOT / "benchmarks" / "results.py")], capture_output=True, text=True, check=True
    )
    for line in done.stdout.strip().splitlines():
        assert line in match[1]


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda path: path.name)
def test_examples_run(example: Path, tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, str(example)], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.toml")), ids=lambda path: path.name)
def test_example_scenes_run(example: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ancf", "run", str(example), "-o", str(tmp_path), "--quiet"], check=False
    )
    assert done.returncode == 0
