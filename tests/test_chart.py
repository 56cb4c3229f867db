"""Charts: errors, the front, winners, what is lost, and the files."""

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import ancf
from ancf.chart import Rival, default_axes, measure, read_axes, write_chart
from ancf.chart.axes import grid, with_few_outputs
from ancf.chart.labels import Label
from ancf.chart.points import Point, front, winners
from ancf.cli import main
from ancf.pages import Block, Fold, Heading, Points, Script, Table, Text
from ancf.pages.markdown import to_markdown
from ancf.pages.page import to_html
from ancf.records import Record
from ancf.sweep import Timing

AXES = ["element=thin36,full48a", "membrane=full", "mesh=0.5,1", "method=hht,verlet", "rtol=0.01,0.00001"]


def solve(scene: ancf.Scene) -> ancf.Result:
    result = scene.solve()
    return result


def point(seconds: float, error: float) -> Point:
    label = Label("thin36 full", "1 x 1", "hht", "rtol 0.1")
    return Point(label, {}, False, Timing((seconds,), (seconds,)), {"elements": 1}, error, error, 0.0)


def test_the_front_is_what_nothing_beats() -> None:
    points = [point(1, 0.3), point(2, 0.4), point(3, 0.1), point(4, 0.1), point(5, 0.01)]
    assert [(p.timing.best, p.error) for p in front(points)] == [(1, 0.3), (3, 0.1), (5, 0.01)]


def test_winners_say_what_is_not_known() -> None:
    points = [point(1, 0.3), point(3, 0.08), point(5, 0.009)]
    ten, one, tenth = winners(points, trust=0.002)
    assert ten.point is points[1]
    assert ten.remark == ""
    assert one.point is points[2]
    assert one.remark == "the reference is not known well enough to be sure"
    assert tenth.point is None
    assert "the best comes to 0.9 %" in tenth.remark
    assert "known to 3 % only" in winners(points, trust=0.03)[1].remark


def test_combinations_without_a_meaning_are_left_out(scenes: Path) -> None:
    scene = ancf.load_scene(scenes / "pendulum.toml")
    labels = {Label.of(variant.scene).element for variant in grid(scene, default_axes(scene))}
    assert labels == {"thin36 projected", "thin36 full", "thin36 lobatto", "thin48 projected", "thin48 full", "full48a"}


def test_axes_are_read(scenes: Path) -> None:
    scene = ancf.load_scene(scenes / "pendulum.toml")
    axes = read_axes(["mesh", "method=hht,rk", "step=1e-3,2e-3"], scene)
    assert axes == {"mesh": default_axes(scene)["mesh"], "method": ["hht", "rk"], "step": [1e-3, 2e-3]}
    with pytest.raises(ancf.InputError, match="give it values, as step=1,2"):
        read_axes(["step"], scene)
    with pytest.raises(ancf.InputError, match="commas between them"):
        read_axes(["step=1,,2"], scene)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a chart of the small pendulum."""
    made = tmp_path_factory.mktemp("chart")
    scene = Path(__file__).parent / "scenes" / "pendulum.toml"
    arguments = ["chart", str(scene), "-o", str(made), "--axes", *AXES, "--budget", "120", "--repeats", "2", "--quiet"]
    assert main(arguments) == 0
    return made


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "chart.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_run_is_in_the_table(folder: Path) -> None:
    found = rows(folder)
    # 2 elements, 2 meshes, 2 methods, 2 tolerances, a tight run for each element and mesh, the scene itself.
    assert len(found) == 2 * 2 * 2 * 2 + 2 * 2 + 1
    assert {row["status"] for row in found} == {"ok"}
    assert {row["repeats"] for row in found} == {"2"}
    for row in found:
        assert float(row["seconds"]) <= float(row["median_seconds"])
        assert int(row["forces"]) >= int(row["steps"])


def test_errors_are_told_apart(folder: Path) -> None:
    """The parts of an error bound the whole, and the error in time falls with the tolerance."""
    found = rows(folder)
    for row in found:
        error, space, time = (float(row[key]) for key in ("error", "error_space", "error_time"))
        assert abs(space - time) <= error * (1 + 1e-12)
        assert error <= (space + time) * (1 + 1e-12)
    runs = {(row["element"], row["mesh"], row["method"], row["accuracy"]): float(row["error_time"]) for row in found}
    assert runs["thin36 full", "2 x 2", "hht", "rtol 1e-05"] < runs["thin36 full", "2 x 2", "hht", "rtol 0.01"]


def test_a_claimed_error_holds_against_a_finer_run(folder: Path, scenes: Path) -> None:
    """The reference is 4 x 4; 8 x 8 by another integrator moves the errors by no more than twice its trust."""
    scene = with_few_outputs(ancf.load_scene(scenes / "pendulum.toml"))
    document = scene.document()
    document["body"]["plate"] |= {"divisions": [8, 8], "element": "thin48", "membrane": "full"}
    document["run"] = {
        "kind": "dynamic",
        "until": 0.05,
        "method": "rk",
        "rtol": 1e-6,
        "outputs": document["run"]["outputs"],
    }
    fine, coarse = (solve(made).probes["A"].value for made in (ancf.Scene.of(document), scene))
    size = np.linalg.norm(fine - fine[0], axis=1).max()
    error = np.linalg.norm(coarse - fine, axis=1).max() / size
    own = next(float(row["error"]) for row in rows(folder) if row["accuracy"] == "step 0.005 s")
    trust = json.loads(page_data(folder))["trust"]
    assert abs(own - error) <= 2 * trust
    assert trust < 0.05


def page_data(folder: Path) -> str:
    page = (folder / "chart.html").read_text(encoding="utf-8")
    match = re.search(r"const DATA = (.*);\n", page)
    assert match is not None
    return match[1]


def test_the_page_needs_nothing_else(folder: Path) -> None:
    page = (folder / "chart.html").read_text(encoding="utf-8")
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert "http://" not in page.replace("http://www.w3.org/2000/svg", "")
    assert "https://" not in page
    data = json.loads(page_data(folder))
    assert len(data["points"]) == len(rows(folder))
    excerpt = next(p["toml"] for p in data["points"] if p["method"] == "verlet" and p["mesh"] == "2 x 2")
    assert 'method = "verlet"' in excerpt
    assert "divisions = [2, 2]" in excerpt


def test_the_pictures_are_drawn(folder: Path) -> None:
    with Image.open(folder / "chart.png") as picture:
        colours = np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)
        assert picture.width > 1500
        assert len(colours) > 200
    assert (folder / "chart.svg").read_text(encoding="utf-8").startswith("<?xml")
    report = (folder / "chart.md").read_text(encoding="utf-8")
    assert "# Small pendulum: what accuracy costs" in report
    assert "| 10 % |" in report


def test_a_statics_scene_and_runs_that_are_refused(scenes: Path, tmp_path: Path) -> None:
    scene = ancf.load_scene(scenes / "cantilever.toml")
    axes: dict[str, Any] = {"element": ["thin36", "no such"], "membrane": ["projected"], "mesh": [0.5, 1.0, 2.0]}
    chart = measure(scene, axes, tmp_path / "log.jsonl", budget=60, repeats=1)
    assert [lost.status for lost in chart.lost] == ["refused"] * 3
    errors = {p.label.mesh: p.error for p in chart.points}
    document = scene.document()
    fine, coarse = (
        solve(ancf.Scene.of({**document, "body": {"plate": document["body"]["plate"] | {"divisions": divisions}}}))
        for divisions in ([16, 4], [1, 1])
    )
    exact, value = (result.probes["tip"].value for result in (fine, coarse))
    size = np.linalg.norm(exact, axis=1).max()
    assert errors["1 x 1"] == pytest.approx(np.linalg.norm(value - exact, axis=1).max() / size, abs=0.01)
    assert errors["1 x 1"] > errors["2 x 1"] > errors["4 x 2"]
    assert all(p.time == 0 and p.space == p.error for p in chart.points)
    paths = write_chart(tmp_path, chart)
    assert all(path.stat().st_size > 500 for path in paths)
    assert "allowed are thin36" in (tmp_path / "chart.md").read_text(encoding="utf-8")


def test_another_program_stands_beside(scenes: Path, tmp_path: Path) -> None:
    """A run that is a tenth of the motion off the reference, at no time at all."""
    scene = ancf.load_scene(scenes / "cantilever.toml")
    axes: dict[str, Any] = {"element": ["thin36"], "mesh": [0.5, 1.0]}
    chart = measure(scene, axes, tmp_path / "log.jsonl", budget=60, repeats=1)
    exact = chart.reference.probes["tip"]
    off = Record(exact.t, exact.value + np.array([0.0, 0.1 * chart.reference.scale["tip"], 0.0]))
    label = Label("Other", "9 x 9", "its method", "step 1 s")
    beside = chart.beside([Rival(label, 81, Timing((1e-9,), (1e-9,)), {"tip": off})], "It is made up.")
    assert beside.points[:-1] == chart.points
    assert beside.points[-1].error == pytest.approx(0.1)
    assert front(beside.points)[0].label == label
    write_chart(tmp_path, beside)
    last = rows(tmp_path)[len(chart.points)]
    assert (last["element"], last["error_space"], last["dofs"]) == ("Other", "", "")
    assert "It is made up." in (tmp_path / "chart.md").read_text(encoding="utf-8")
    assert json.loads(page_data(tmp_path))["points"][-1]["toml"] is None


def test_a_claimed_error_holds_against_a_closed_form(tmp_path: Path) -> None:
    """A strip bent to half a circle by a moment: its end moves by (-L, 0, 2 L / pi)."""
    L, h, E = 10.0, 0.01, 1.2e6
    strip = ancf.Rectangle(size=(L, 1.0), divisions=(8, 1), thickness=h, material=ancf.Material(E=E, nu=0.0))
    model = ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Moment(at="edge:x1", per_length=np.pi / L * E * h**3 / 12)],
        probes=[ancf.Probe(name="end", at=(L, 0.5), quantity="displacement")],
    )
    scene = ancf.Scene("Strip", model, ancf.Static())
    axes: dict[str, Any] = {"element": ["thin36"], "mesh": [0.5, 1.0]}
    chart = measure(scene, axes, tmp_path / "log.jsonl", budget=60, repeats=1)
    exact = np.array([-L, 0.0, 2 * L / np.pi])
    assert chart.reference.trust < 0.02
    for found in chart.points:
        value = solve(ancf.Scene.of(dict(found.scene))).probes["end"].value[-1]
        error = np.linalg.norm(value - exact) / np.linalg.norm(exact)
        assert abs(found.error - error) <= chart.reference.trust


def test_what_there_is_no_time_for_is_listed(scenes: Path, tmp_path: Path) -> None:
    scene = ancf.load_scene(scenes / "cantilever.toml")
    axes: dict[str, Any] = {"mesh": [0.5, 1.0], "tolerance": [1e-8 / (k + 1) for k in range(40)]}
    log = tmp_path / "log.jsonl"
    chart = measure(scene, {"mesh": [0.5, 1.0]}, log, budget=60, repeats=1)
    assert not chart.lost
    again = measure(scene, axes, log, budget=1e-3, repeats=1)
    assert {lost.status for lost in again.lost} == {"omitted"}
    assert len(again.points) >= len(chart.points)


def test_scenes_without_a_measure(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (scenes / "cantilever.toml").read_text(encoding="utf-8")
    for old, new, told in (
        (text[text.index("[[probe]]") : text.index("[run]")], "", "a chart shows the errors of probes"),
        ("load_factors = [0.5, 1.0]", 'path = "arc"', "at equal load factors"),
    ):
        path = tmp_path / "scene.toml"
        path.write_text(text.replace(old, new), encoding="utf-8")
        assert main(["chart", str(path), "-o", str(tmp_path / "out")]) == 2
        assert told in capsys.readouterr().err


def test_reports_in_both_forms(tmp_path: Path) -> None:
    blocks: list[Block] = [
        Heading("A < B", 1),
        Text("the key `step`"),
        Points(["one", "two"]),
        Table(["a", "b"], [["1", "x | y"]]),
        Fold("more", [Text("inside")]),
        Script("<b>raw</b>"),
    ]
    text = to_markdown(blocks)
    assert "# A < B\n\nthe key `step`\n\n* one\n* two\n\n| a | b |\n| --- | --- |\n| 1 | x \\| y |" in text
    assert "raw" not in text
    page = to_html("T", blocks, tmp_path)
    assert "<h1>A &lt; B</h1>" in page
    assert "<code>step</code>" in page
    assert '<td class="number">1</td><td>x | y</td>' in page
    assert "<summary>more</summary><p>inside</p>" in page
    assert "<b>raw</b>" in page
