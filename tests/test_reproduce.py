"""The study of Dufva and Shabana (2005): its tables hold ours beside the paper's."""

import csv
from pathlib import Path

import pytest

from ancf.cli import main
from ancf.reproduce.dufva_shabana.paper import pendulum
from ancf.reproduce.dufva_shabana.velocities import integrate
from ancf.scene import Scene
from ancf.sweep import Variant

NAME = "dufva-shabana-2005"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the quick report."""
    made = tmp_path_factory.mktemp("report")
    assert main(["reproduce", NAME, "-o", str(made), "--quick", "--quiet"]) == 0
    return made


def table(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / f"{NAME}-{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_cantilever_is_known(folder: Path) -> None:
    """The check values of the independent prototype; one and two elements of Model I as in `ancf.reference`."""
    rows = table(folder, "fig3")
    thin = [float(row["Model I, thin36"]) for row in rows]
    solid = [float(row["Model II, full48a"]) for row in rows]
    assert thin == pytest.approx([-0.183114, -0.261603, -0.2817], abs=5e-5)
    assert solid == pytest.approx([-0.01043, -0.02766, -0.07223], abs=1e-5)


def test_positions_are_known(folder: Path) -> None:
    """The 2 x 2 pendulum as in `ancf.reference`."""
    rows = {(row["elements"], row["model"]): row for row in table(folder, "positions")}
    row = rows["2 x 2", "Model I, thin36"]
    assert float(row["A: x = y"]) == pytest.approx(0.2263, abs=2e-4)
    assert float(row["A: z"]) == pytest.approx(-0.4416, abs=2e-4)


def test_only_the_explicit_steps_of_the_solid_grow(folder: Path) -> None:
    """Vibrations through the thickness have frequencies as 1 / thickness: 20 times here."""
    rows = table(folder, "steps")
    thin, solid = ([int(row[f"rk, {name}"]) for row in rows] for name in ("Model I", "Model II"))
    assert thin[-1] / thin[0] == pytest.approx(1, abs=0.2)
    assert solid[-1] / solid[0] == pytest.approx(20, rel=0.2)


def test_control_of_velocities_costs_only_the_solid_more(folder: Path) -> None:
    """At the default tolerance of ode23tb the steps of Model II grow, but far from as 1 / thickness."""
    rows = table(folder, "velocities")
    thin, solid = ([int(row[f"{name}: steps"]) for row in rows] for name in ("Model I", "Model II"))
    assert thin[-1] / thin[0] == pytest.approx(1, abs=0.2)
    assert 1.3 < solid[-1] / solid[0] < 5


def test_the_experiment_moves_the_plate_as_known() -> None:
    """The 2 x 2 pendulum as in `ancf.reference`."""
    variant = Variant.of(pendulum(), divisions=[2, 2])
    found = integrate(Scene.of(variant.scene).model.assemble("constant"), 0.3, 1e-5)
    corner = found.q.reshape(9, 3, 3)[-1, 0]
    assert corner == pytest.approx([0.22634, 0.22634, -0.44155], abs=2e-5)


def test_the_figures_of_the_paper_stand_beside(folder: Path) -> None:
    report = (folder / f"{NAME}.md").read_text(encoding="utf-8")
    assert "| 7 s | 42 s | 6 |" in report
    assert "| 8 s | 1130 s | 141.3 |" in report
    pictures = sorted(path.stem.removeprefix(f"{NAME}-") for path in folder.glob("*.png"))
    assert pictures == ["fig3", "fig4-5", "fig6", "steps", "times"]
    page = (folder / f"{NAME}.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 5
