"""Plans: what is chosen is precise enough, against another element on a fine mesh and against closed forms."""

import io
import json
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ancf
from ancf import cli
from ancf.plan import pilots
from ancf.plan.cost import Costs, Rates
from ancf.plan.errors import Side, distance, scales
from ancf.plan.ladder import CONTINUOUS, RIGID, THIN, Choice, Rung, Stepping, coarsest
from ancf.plan.planner import LEAST, MOST, PROPORTION
from ancf.plan.rigid import as_rigid, deflection
from ancf.plan.shear import shear
from ancf.plan.symmetry import below, halved
from ancf.solve import solve

STEEL = ancf.Material(E=2.07e11, nu=0.3, density=7810.0)
RUBBER = ancf.Material(E=1e6, nu=0.3, density=1000.0)
WEIGHT = ancf.Gravity(acceleration=(0.0, 0.0, -9.81))


@pytest.fixture(autouse=True, scope="module")
def _cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def cantilever(divisions: tuple[int, int] = (3, 3), element: str = "thin36") -> ancf.Model:
    plate = ancf.Rectangle(
        size=(0.5, 0.15),
        divisions=divisions,
        thickness=1e-3,
        material=STEEL,
        element=element,  # type: ignore[arg-type]
    )
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
        probes=[ancf.Probe(name="A", at=(0.5, 0.15)), ancf.Probe(name="B", at=(0.25, 0.0), quantity="displacement")],
    )


@pytest.mark.parametrize("tol", [1e-1, 1e-2])
def test_statics_against_another_element_on_a_fine_mesh(tol: float) -> None:
    plan = ancf.plan(cantilever(), run=ancf.Static(), want="A", tol=tol)
    exact = ancf.solve_static(cantilever((24, 8), "thin48")).probes["A"].value
    found = plan.result.probes["A"].value
    assert distance([found], [exact], scales([exact])) < tol
    assert plan.converged
    # The scene written is the one that was run, to the same bits.
    again = plan.scene.solve()
    assert np.array_equal(again.probes["A"].value, found)


def test_a_free_plate_that_hardly_deforms_is_a_rigid_body() -> None:
    plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(8, 8), thickness=5e-3, material=STEEL)
    model = ancf.Model(
        bodies={"plate": plate},
        loads=[ancf.Force(at=(0.15, 0.15), force=(0.0, 0.0, 20.0)), WEIGHT],
        probes=[ancf.Probe(name="A", at=(0.3, 0.0))],
    )
    plan = ancf.plan(model, run=ancf.Dynamic(until=0.4, step=1e-3), tol=1e-2)
    run = plan.scene.run
    assert isinstance(run, ancf.Dynamic)
    assert run.method == "rigid"
    # A force through the centre: no rotation.
    acceleration = 20.0 / (7810.0 * 0.09 * 5e-3) - 9.81
    t = plan.result.t
    assert plan.result.probes["A"].value[:, 2] == pytest.approx(0.5 * acceleration * t**2, abs=1e-9)


def test_what_loads_that_change_add_up_to_is_not_rigid() -> None:
    """Paper flicked for half a period of its slowest oscillation deflects farther than twice as under a steady load."""
    paper = ancf.Material(E=3e9, nu=0.2, density=800.0)
    pulse = [(0.0, 1.0), (0.02, 1.0), (0.03, 0.0)]
    flick = ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.2, 1.0), history=pulse)

    def sheet(divisions: tuple[int, int], element: str) -> ancf.Model:
        plate = ancf.Rectangle(
            size=(0.2, 0.1),
            divisions=divisions,
            thickness=5e-4,
            material=paper,
            element=element,  # type: ignore[arg-type]
        )
        probes = [ancf.Probe(name="A", at=(0.2, 0.0))]
        return ancf.Model(bodies={"sheet": plate}, loads=[flick, WEIGHT], probes=probes)

    plan = ancf.plan(sheet((2, 2), "thin36"), run=ancf.Dynamic(until=0.05, step=5e-4), tol=1e-1, threads=1)
    times = plan.result.t[1:].tolist()
    exact = ancf.simulate(sheet((6, 3), "thin48"), until=0.05, method="esdirk", step=5e-4, outputs=times)
    values = exact.probes["A"].value
    assert distance([plan.result.probes["A"].value], [values], scales([values])) < 0.1


def test_nothing_is_promised_of_a_side_without_a_coarser_neighbour() -> None:
    """On one element along a sagging sheet `thin48` finds no stable equilibrium, on two by two all elements agree."""

    def sheet(divisions: tuple[int, int], element: str) -> ancf.Model:
        plate = ancf.Rectangle(
            size=(0.2, 0.05),
            divisions=divisions,
            thickness=1e-4,
            material=ancf.Material(E=3e9, nu=0.2, density=800.0),
            element=element,  # type: ignore[arg-type]
        )
        supports = [ancf.Support(at="edge:x0", clamp=True)]
        probes = [ancf.Probe(name="A", at=(0.2, 0.05))]
        return ancf.Model(bodies={"sheet": plate}, supports=supports, loads=[WEIGHT], probes=probes)

    run = ancf.Static(load_factors=[0.5, 1.0])
    plan = ancf.plan(sheet((2, 2), "thin36"), run=run, tol=1e-2, threads=1)
    exact = ancf.solve_static(sheet((24, 3), "thin48"), load_factors=[0.5, 1.0]).probes["A"].value
    assert distance([plan.result.probes["A"].value], [exact], scales([exact])) < 1e-2


def test_a_family_that_locks_is_left_for_another_of_its_element() -> None:
    """On coarse meshes of a thin cap the membranes that lock change least; they would need 64 x 64 elements.

    Which of the others is the cheapest, from 8 x 8 to 16 x 12, depends on the clock.
    """

    def cap(divisions: tuple[int, int], element: str) -> ancf.Model:
        body = ancf.Sphere(
            radius=0.2,
            longitude=(0.0, 1.2),
            latitude=(0.2, 1.0),
            divisions=divisions,
            thickness=4e-4,
            material=ancf.Material(E=3e9, nu=0.2, density=800.0),
            element=element,  # type: ignore[arg-type]
        )
        return ancf.Model(
            bodies={"cap": body},
            supports=[ancf.Support(at="edge:y0", clamp=True)],
            loads=[ancf.LineLoad(at="edge:y1", per_length=(0.0, 0.0, 3.0))],
            probes=[ancf.Probe(name="A", at=(0.6, 1.0))],
        )

    plan = ancf.plan(cap((2, 2), "thin36"), run=ancf.Static(), tol=1e-2, threads=1)
    exact = ancf.solve_static(cap((24, 24), "thin48")).probes["A"].value
    assert plan.converged
    assert distance([plan.result.probes["A"].value], [exact], scales([exact])) < 1e-2
    assert plan.settings.rung.family.membrane == "projected"
    assert plan.settings.rung.elements <= 16 * 16


def test_threads_are_those_that_take_the_least_predicted_time() -> None:
    elements = (1, 10_000)
    common: dict[str, Any] = {"elements": elements, "setup": (1.0, 1.0)}
    # Implicit steps gain from threads on the large mesh only, explicit ones on neither.
    rates = Rates(
        **common, iteration=(1.0, 100.0), iteration_shared=(2.0, 25.0), force=(1.0, 1.0), force_shared=(1.0, 1.0)
    )
    costs = Costs(dict.fromkeys((*THIN, CONTINUOUS), rates))
    few, many = (Rung(THIN[0], ((n, n),)) for n in (1, 100))
    assert costs.threads(Choice(few)) == 1
    assert costs.threads(Choice(many)) is None
    assert costs.threads(Choice(many, Stepping("verlet", rtol=1e-2))) == 1
    assert Costs(dict.fromkeys(THIN, rates) | {CONTINUOUS: rates}, threads=1).threads(Choice(many)) == 1
    # An iteration takes 25 s there on all threads.
    assert costs.steps(many, 2.0, explicit=False) == pytest.approx(1.0 + 2.0 * 3.0 * 25.0)


def test_a_soft_plate_is_no_rigid_body() -> None:
    plate = ancf.Rectangle(size=(0.3, 0.1), divisions=(4, 2), thickness=0.01, material=RUBBER)
    model = ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[WEIGHT],
        probes=[ancf.Probe(name="A", at=(0.3, 0.1))],
    )
    plan = ancf.plan(model, run=ancf.Dynamic(until=0.1, step=1e-3), tol=1e-1)
    fine = ancf.Rectangle(
        size=(0.3, 0.1), divisions=(8, 3), thickness=0.01, material=RUBBER, element="thin48", membrane="projected"
    )
    reference = ancf.Model(bodies={"plate": fine}, supports=model.supports, loads=[WEIGHT], probes=model.probes)
    exact = ancf.simulate(reference, until=0.1, method="esdirk", step=1e-3, outputs=plan.result.t[1:].tolist())
    values = exact.probes["A"].value
    assert distance([plan.result.probes["A"].value], [values], scales([values])) < 0.1


def test_the_deflection_of_a_rigid_cantilever_is_the_linear_one() -> None:
    """Twice that of a beam of unit width under its weight, q L^4 / 8 E I, at nu = 0."""
    material = ancf.Material(E=2e11, nu=0.0, density=7800.0)
    plate = ancf.Rectangle(size=(0.2, 0.02), divisions=(4, 1), thickness=2e-3, material=material)
    model = ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[WEIGHT],
        probes=[ancf.Probe(name="A", at=(0.2, 0.01))],
    )
    rigid = ancf.simulate(model, until=0.1, method="rigid", rtol=1e-4)
    expected = 2 * 7800.0 * 9.81 * 2e-3 * 0.2**4 / (8 * 2e11 * (2e-3) ** 3 / 12)
    assert deflection(model, rigid)[0] == pytest.approx(expected, rel=1e-3)


def blown(size: tuple[float, float], divisions: tuple[int, int], supports: list[ancf.Support]) -> ancf.Model:
    plate = ancf.Rectangle(size=size, divisions=divisions, thickness=8e-3, material=RUBBER)
    probe = ancf.Probe(name="A", at=(0.2, 0.15))
    return ancf.Model(
        bodies={"mat": plate}, supports=supports, loads=[ancf.Pressure(pressure=200.0), WEIGHT], probes=[probe]
    )


def test_a_symmetric_scene_is_halved() -> None:
    ends = [ancf.Support(at=f"edge:x{end}", clamp=True) for end in (0, 1)]
    plan = ancf.plan(blown((0.4, 0.3), (4, 4), ends), run=ancf.Static(), tol=1e-1)
    assert "symmetric across the middle of x and y" in " ".join(plan.reasons)
    body = plan.scene.model.bodies["mat"]
    assert isinstance(body, ancf.Rectangle)
    assert body.size == (0.2, 0.15)
    whole = ancf.solve_static(blown((0.4, 0.3), (12, 8), ends)).probes["A"].value
    assert distance([plan.result.probes["A"].value], [whole], scales([whole])) < 0.1


def test_what_is_not_symmetric_is_not_halved() -> None:
    model = blown((0.4, 0.3), (4, 4), [ancf.Support(at="edge:x0", clamp=True)])
    assert halved(ancf.Scene("", model, ancf.Static()))[1] == [1]
    pull = ancf.LineLoad(at="edge:x1", per_length=(0.0, 1.0, 0.0))
    pulled = ancf.Model(bodies=model.bodies, supports=model.supports, loads=[pull], probes=model.probes)
    assert halved(ancf.Scene("", pulled, ancf.Static()))[1] == []


def test_halves_of_forces_and_pairs_of_loads() -> None:
    model = blown(
        (0.4, 0.3), (4, 4), [ancf.Support(at="corner:x0y0", fix=["r"]), ancf.Support(at="corner:x1y0", fix=["r"])]
    )
    force = ancf.Force(at=(0.2, 0.1), force=(0.0, 2.0, 4.0))
    moments = [ancf.Moment(at=f"edge:x{end}", per_length=1.0) for end in (0, 1)]
    whole = ancf.Model(bodies=model.bodies, supports=model.supports, loads=[force, *moments], probes=model.probes)
    scene, mirrors = halved(ancf.Scene("", whole, ancf.Static()))
    assert mirrors == [0]
    assert [load.kind for load in scene.model.loads] == ["force", "moment"]
    half = scene.model.loads[0]
    assert isinstance(half, ancf.Force)
    assert half.force == (0.0, 1.0, 2.0)
    assert [support.at for support in scene.model.supports] == ["corner:x0y0", "edge:x1"]


def test_shear_is_told_of_thick_plates() -> None:
    """A cantilever of length L and height h deflects by F L / k G A from shear, F L^3 / 3 E I from bending."""
    plate = ancf.Rectangle(size=(0.3, 0.9), divisions=(1, 1), thickness=0.03, material=STEEL)
    stiff, area, inertia, length = 2.07e11, 0.03, 0.03**3 / 12, 0.3
    by_shear = length / (5 / 6 * stiff / 2.6 * area)
    by_bending = length**3 / (3 * stiff * inertia)
    assert shear(ancf.Model(bodies={"plate": plate}))["plate"] == pytest.approx(by_shear / by_bending)


def test_errors_of_a_geometric_sequence_are_covered() -> None:
    for rate in (1.0, 2.0, 3.0):
        errors = [2.0 ** (-rate * k) for k in range(4)]
        side = Side(errors[1] - errors[2], float(np.log2((errors[0] - errors[1]) / (errors[1] - errors[2]))))
        assert errors[2] <= side.error <= 5 * errors[2]


def test_nodes_lie_where_supports_are() -> None:
    plate = ancf.Rectangle(size=(0.3, 0.2), divisions=(3, 2), thickness=1e-3, material=STEEL)
    at = [(0.1, 0.1), (0.2, 0.0)]
    model = ancf.Model(bodies={"plate": plate}, supports=[ancf.Support(at=point, fix=["r"]) for point in at])
    assert coarsest(model) == ((3, 2),)


def test_rungs_are_named_in_words() -> None:
    assert str(Choice(Rung(THIN[0], ((4, 1),)))) == "thin36 projected 4 x 1"
    assert str(Rung(RIGID, ((1, 1), (2, 1)))) == "rigid 1 x 1 and 2 x 1"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"want": "C"}, "want"),
        ({"tol": 0.0}, "tol"),
        ({"tol": 2.0}, "tol"),
        ({"budget": -1.0}, "budget"),
        ({"run": None}, "run"),
        ({"run": ancf.Static(path="arc")}, "run.path"),
        ({"run": ancf.Modes(count=3)}, "run.kind"),
    ],
)
def test_mistakes(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ancf.InputError, match=message):
        ancf.plan(cantilever(), **({"run": ancf.Static()} | arguments))  # type: ignore[arg-type]


def test_what_does_not_change_cannot_be_wanted() -> None:
    model = cantilever()
    fixed = ancf.Probe(name="wall", at=(0.0, 0.0))
    still = ancf.Model(bodies=model.bodies, supports=model.supports, loads=model.loads, probes=[fixed])
    with pytest.raises(ancf.InputError, match="does not change"):
        ancf.plan(still, run=ancf.Static())


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(4, 4), thickness=2e-3, material=STEEL)
    model = ancf.Model(
        bodies={"plate": plate},
        loads=[ancf.Force(at=(0.1, 0.25), force=(5.0, -3.0, 20.0))],
        probes=[ancf.Probe(name="A", at=(0.3, 0.3))],
    )
    path = tmp_path / "flight.toml"
    ancf.Scene("flight", model, ancf.Dynamic(until=0.3, step=1e-3)).write(path)
    return path


def test_the_command_writes_scene_numbers_and_picture(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["plan", str(scene), "--want", "A", "--tol", "1e-2"]) == 0
    assert "six rigid motions" in capsys.readouterr().out
    folder = Path("flight-plan")
    assert {path.name for path in folder.iterdir()} == {"scene.toml", "plan.json", "plan.png"}
    written = tomllib.loads((folder / "scene.toml").read_text())
    assert written["run"]["method"] == "rigid"
    numbers = json.loads((folder / "plan.json").read_text())
    assert numbers["rows"][numbers["chosen"]]["settings"] == numbers["choice"]
    assert cli.main(["run", str(folder / "scene.toml"), "-o", "out", "--quiet"]) == 0
    assert cli.main(["run", str(scene), "--tol", "1e-2", "-o", "both", "--quiet"]) == 0
    out, both = (json.loads(Path(name, "summary.json").read_text())["probes"] for name in ("out", "both"))
    assert out == both


@pytest.mark.parametrize(
    "arguments",
    [["plan", "--want", "B"], ["plan", "--tol", "2"], ["run", "-o", "out", "--want", "A"]],
)
def test_wrong_arguments_leave_nothing(scene: Path, arguments: list[str]) -> None:
    command, *rest = arguments
    assert cli.main([command, str(scene), *rest]) == 2
    assert not Path("flight-plan").exists()
    assert not Path("out").exists()


@pytest.mark.parametrize("command", [["plan"], ["run", "--tol", "1e-2", "-o", "flight-plan"]])
def test_ctrl_c_ends_a_plan(scene: Path, monkeypatch: pytest.MonkeyPatch, command: list[str]) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(pilots, "solve", interrupt)
    assert cli.main([command[0], str(scene), *command[1:]]) == 130
    assert not Path("flight-plan").exists()


@pytest.mark.parametrize("command", [["plan"], ["run", "-o", "plate-plan"]])
def test_an_interrupted_plan_leaves_what_is_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    ancf.Scene("", cantilever(), ancf.Static()).write("plate.toml")
    runs = iter(range(20))

    def interrupt(*arguments: Any, **options: Any) -> ancf.Result:
        if next(runs) == 17:
            raise KeyboardInterrupt
        return solve(*arguments, **options)

    monkeypatch.setattr(pilots, "solve", interrupt)
    assert cli.main([command[0], "plate.toml", "--tol", "1e-3", "--threads", "1", *command[1:]]) == 130
    assert "the plan was interrupted; plate-plan has the best found" in capsys.readouterr().err
    # Nothing is run after it.
    assert next(runs) == 18
    told = json.loads(Path("plate-plan/plan.json").read_text())
    found = ancf.load_scene("plate-plan/scene.toml").solve()
    values = [found.probes[name].value for name in "AB"]
    exact = [ancf.solve_static(cantilever((24, 8), "thin48")).probes[name].value for name in "AB"]
    # An estimate of what is known so far, which no other element has confirmed yet.
    assert distance(values, exact, scales(exact)) < 3 * told["error"]


def test_a_pilot_that_slides_and_jumps_ends_when_its_time_is_up() -> None:
    """A soft vault that buckles under its weight: it would take minutes on this mesh."""
    vault = ancf.Cylinder(
        radius=0.3,
        angle=(0.0, 2.4),
        length=(0.0, 0.6),
        divisions=(4, 4),
        thickness=3e-3,
        material=ancf.Material(E=1e6, nu=0.45, density=1100.0),
    )
    ends = [ancf.Support(at=f"edge:x{end}", clamp=True) for end in (0, 1)]
    probes = [ancf.Probe(name="A", at=(1.2, 0.0))]
    model = ancf.Model(bodies={"vault": vault}, supports=ends, loads=[WEIGHT], probes=probes)
    scene = ancf.Scene("", model, ancf.Static(load_factors=[0.25, 0.5, 1.0]))
    pilot = pilots.Pilots(scene, ["A"], np.inf, 1).run(Choice(Rung(CONTINUOUS, ((32, 16),))), 0.5)
    assert pilot.outcome == "slower than others"
    # A plan, too, tells what it knows when its time is up.
    plan = ancf.plan(model, run=ancf.Static(load_factors=[0.25, 0.5, 1.0]), tol=1e-3, budget=0.5, threads=1)
    assert not plan.converged
    assert "--budget" in " ".join(plan.reasons)


def test_a_chaotic_motion_gets_a_plan_that_promises_nothing() -> None:
    """A free sheet of paper, flicked at a corner: shorter steps change its motion, so that none is good enough."""
    paper = ancf.Material(E=2.5e9, nu=0.25, density=750.0)
    sheet = ancf.Rectangle(size=(0.297, 0.21), divisions=(8, 6), thickness=3e-4, material=paper)
    flick = ancf.Force(at="corner:x1y1", force=(0.0, 0.0, 1.0), history=[(0.0, 0.0), (0.01, 1.0), (0.02, 0.0)])
    probes = [ancf.Probe(name="A", at=(0.297, 0.21))]
    model = ancf.Model(bodies={"sheet": sheet}, loads=[flick], probes=probes)
    plan = ancf.plan(model, run=ancf.Dynamic(until=0.15, step=5e-4, every=0.005), tol=1e-2, budget=3.0, threads=1)
    assert not plan.converged
    assert plan.error + plan.error_in_time > 0.1
    assert plan.result.reached == 0.15
    assert "The estimates do not reach the tolerance" in " ".join(plan.reasons)


def test_a_motion_with_energy_from_nowhere_is_not_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a run says of itself is that it is wrong, whatever its probes are."""
    scene = ancf.Scene("", cantilever(), ancf.Dynamic(until=0.1, step=1e-3))
    choice = Choice(Rung(CONTINUOUS, ((2, 1),)), Stepping("hht", step=0.01))
    assert pilots.Pilots(scene, ["A"], np.inf, 1).run(choice).ok
    monkeypatch.setattr("ancf.result.balance_warnings", lambda *_: ("energy comes from nowhere",))
    assert pilots.Pilots(scene, ["A"], np.inf, 1).run(choice).outcome == "energy comes from nowhere"


def test_one_element_between_clamped_edges_does_not_move_and_is_left_out() -> None:
    ends = [ancf.Support(at=f"edge:x{end}", clamp=True) for end in (0, 1)]
    # Without symmetry, of which half an element would be free.
    push = [ancf.LineLoad(at="edge:y1", per_length=(0.0, 0.3, 2.0))]
    sheets = [blown((0.4, 0.3), divisions, ends) for divisions in ((4, 4), (16, 12))]
    models = [
        ancf.Model(bodies=m.bodies, supports=ends, loads=push, probes=[ancf.Probe(name="A", at=(0.3, 0.3))])
        for m in sheets
    ]
    plan = ancf.plan(models[0], run=ancf.Static(), tol=3e-2)
    exact = ancf.solve_static(models[1]).probes["A"].value
    assert plan.converged
    assert distance([plan.result.probes["A"].value], [exact], scales([exact])) < 3e-2


def test_the_mirror_holds_all_that_an_element_has() -> None:
    """The half of a symmetric plate is the whole, also with the twist r_xy of `thin48`."""
    ends = [ancf.Support(at=f"edge:x{end}", clamp=True) for end in (0, 1)]
    whole = ancf.Scene("", blown((0.4, 0.3), (4, 4), ends), ancf.Static())
    part, mirrors = halved(whole)
    assert mirrors == [0, 1]
    for family in (*THIN, CONTINUOUS):
        one, other = (
            pilots.Pilots(scene, ["A"], np.inf, 1).run(Choice(Rung(family, (divisions,))))
            for scene, divisions in ((whole, (4, 4)), (part, (2, 2)))
        )
        assert one.ok
        assert np.allclose(one.values[0], other.values[0], rtol=0.0, atol=1e-9), family


def test_curvatures_that_jump_across_the_mirror_are_those_of_the_low_side() -> None:
    """A bent strip whose probe lies on its mirror: on coarse meshes the twist has another sign on the other side."""
    plate = ancf.Rectangle(size=(0.4, 0.04), divisions=(4, 4), thickness=2e-3, material=RUBBER)
    tape = ancf.Model(
        bodies={"tape": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, 0.1))],
        probes=[ancf.Probe(name="A", at=(0.13, 0.02), quantity="curvature")],
    )
    result = ancf.solve_static(tape)
    low = below(tape, tape.probes[0], [1])
    assert low == pytest.approx((0.13, 0.02), abs=1e-9)
    at, beside = (result.evaluate("tape", [place], "curvature")[-1, 0] for place in ((0.13, 0.02), low))
    assert beside[2] == pytest.approx(-at[2])
    assert abs(beside[2]) > 1e-4 * abs(beside[0])
    plan = ancf.plan(tape, run=ancf.Static(), tol=2e-2, threads=1)
    assert "the low half is enough" in " ".join(plan.reasons)
    body = plan.scene.model.bodies["tape"]
    assert isinstance(body, ancf.Rectangle)
    assert body.size == (0.4, 0.02)


def test_several_probes_in_statics_are_all_precise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is planned, from another folder than that of the scene."""
    (tmp_path / "scenes").mkdir()
    (tmp_path / "elsewhere").mkdir()
    ancf.Scene("", cantilever(), ancf.Static()).write(tmp_path / "scenes/plate.toml")
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert cli.main(["run", "../scenes/plate.toml", "--tol", "5e-2", "-o", "out", "--quiet"]) == 0
    assert {path.name for path in Path("out").iterdir()} >= {"summary.json", "scene.toml", "plan.json", "plan.png"}
    plan = json.loads(Path("out/plan.json").read_text())
    assert set(plan["scale"]) == {"A", "B"}
    exact = ancf.solve_static(cantilever((24, 8), "thin48")).probes
    found = ancf.load_scene("out/scene.toml").solve()
    for name in "AB":
        values = exact[name].value
        assert distance([found.probes[name].value[-1:]], [values[-1:]], scales([values])) < 5e-2


def test_a_surface_is_planned_as_the_cylinder_that_it_is() -> None:
    def position(x: Any, y: Any) -> tuple[Any, Any, Any]:
        return np.cos(x), np.sin(x), y

    common: dict[str, Any] = {"divisions": (4, 4), "thickness": 5e-3, "material": STEEL}
    surface = ancf.Surface(domain=((0.0, 1.0), (0.0, 0.5)), position=position, **common)
    exact = ancf.Cylinder(
        radius=1.0, angle=(0.0, 1.0), length=(0.0, 0.5), **(common | {"divisions": (24, 8)}), element="thin48"
    )
    tips = []
    for body in (surface, exact):
        model = ancf.Model(
            bodies={"roof": body},
            supports=[ancf.Support(at="edge:x0", clamp=True)],
            loads=[ancf.LineLoad(at="edge:x1", per_length=(2e3, 0.0, 0.0))],
            probes=[ancf.Probe(name="A", at=(1.0, 0.5))],
        )
        done = ancf.plan(model, run=ancf.Static(), tol=2e-2).result if body is surface else ancf.solve_static(model)
        tips.append(done.probes["A"].value[[0, -1]])
    assert distance(tips[:1], tips[1:], scales(tips[1:])) < 2e-2


def test_a_tolerance_that_is_not_reached_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    ancf.Scene("", cantilever(), ancf.Static()).write("plate.toml")
    arguments = ["plate.toml", "--tol", "1e-6", "--budget", "0.5", "--quiet"]
    assert cli.main(["plan", *arguments]) == 4
    assert cli.main(["run", *arguments, "-o", "out"]) == 4
    assert capsys.readouterr().err.count("the tolerance 1e-06 is not reached") == 2
    assert Path("out/summary.json").exists()


def test_what_a_scene_without_probes_wants_is_asked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plate.toml"
    model = cantilever()
    bare = ancf.Model(bodies=model.bodies, supports=model.supports, loads=model.loads)
    ancf.Scene("", bare, ancf.Static()).write(path)
    assert cli.main(["run", str(path), "--tol", "0.1", "-o", str(tmp_path / "out")]) == 2
    assert "no probes" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_plan_is_as_long_as_the_scene_deserves() -> None:
    short = ancf.plan(cantilever(), run=ancf.Static(), want="A", tol=0.5)
    assert short.budget == LEAST
    assert short.seconds_as_written is not None
    assert "as it was written would take about" in str(short)
    fine = cantilever((48, 48))
    long = ancf.plan(fine, run=ancf.Static(load_factors=[k / 100 for k in range(1, 101)]), want="A", tol=0.5)
    assert long.seconds_as_written is not None
    assert long.seconds_as_written > short.seconds_as_written
    assert long.budget == min(max(PROPORTION * long.seconds_as_written, LEAST), MOST)


def struck(shape: ancf.Rectangle | ancf.Cylinder, at: str | tuple[float, float], size: float) -> ancf.Scene:
    """Return free steel that a force of 2 ms strikes within 50 ms."""
    pulse = [(0.0, 0.0), (1e-3, 1.0), (2e-3, 0.0)]
    (_, x), (_, y) = ancf.Model(bodies={"p": shape}).domain("p")
    model = ancf.Model(
        bodies={"p": shape},
        loads=[ancf.Force(at=at, force=(0.0, 0.0, size), history=pulse)],
        probes=[ancf.Probe(name="A", at=(x, y), quantity="displacement")],
    )
    return ancf.Scene("", model, ancf.Dynamic(until=0.05, step=1e-4, every=5e-3))


def test_a_pulse_between_the_moments_of_a_rigid_motion_bends_it() -> None:
    """The corner of the elastic plate is 0.155 off the rigid one."""
    plate = ancf.Rectangle(size=(0.5, 0.3), divisions=(6, 4), thickness=3e-3, material=STEEL)
    scene = struck(plate, (0.25, 0.15), 3000.0)
    _, bent = as_rigid(pilots.Pilots(scene, ["A"], np.inf, 1), ((1, 1),), THIN[0], 0.1)
    assert max(bent) > 0.1


def test_a_deflection_says_nothing_about_velocities() -> None:
    """A sheet that hangs by two corners and falls oscillates: its velocity is 0.05 off that of the rigid one."""
    alu = ancf.Material(E=7e10, nu=0.33, density=2700.0)
    sheet = ancf.Rectangle(size=(0.5, 0.5), divisions=(8, 8), thickness=1e-3, material=alu, element="thin48")
    held = [ancf.Support(at=corner, fix=["r"]) for corner in ("corner:x0y0", "corner:x0y1")]
    probe = ancf.Probe(name="v", at=(0.5, 0.25), quantity="velocity")
    model = ancf.Model(bodies={"sheet": sheet}, supports=held, loads=[WEIGHT], probes=[probe])
    run = ancf.Dynamic(until=0.3, step=1e-3, every=0.01)
    pilot, bent = as_rigid(pilots.Pilots(ancf.Scene("", model, run), ["v"], np.inf, 1), ((1, 1),), THIN[0], 0.1)
    assert pilot is not None
    elastic = ancf.simulate(model, until=0.3, rtol=1e-4, every=0.01, method="esdirk")
    error = distance([elastic.probes["v"].value], pilot.values, scales(pilot.values))
    assert error > 0.04
    assert max(bent) > 0.5 * error


def test_rigid_motions_are_as_precise_in_time_as_asked() -> None:
    gutter = ancf.Cylinder(
        radius=0.3, angle=(0.0, 3.0), length=(0.0, 0.4), divisions=(6, 4), thickness=3e-3, material=STEEL
    )
    scene = struck(gutter, "corner:x0y0", 100.0)
    pilot, _ = as_rigid(pilots.Pilots(scene, ["A"], np.inf, 1), ((1, 1),), THIN[0], 0.01)
    assert pilot is not None
    rung, tight = pilot.choice.rung, Stepping("rigid", rtol=1e-9)
    exact = pilots.Pilots(scene, ["A"], np.inf, 1).run(Choice(rung, tight)).values
    assert distance(pilot.values, exact, scales(exact)) < 0.01


def test_what_moves_by_rounding_only_is_told() -> None:
    model = cantilever()
    still = ancf.Model(bodies=model.bodies, supports=model.supports, probes=model.probes)
    with pytest.raises(ancf.InputError, match="does not change"):
        ancf.plan(still, run=ancf.Dynamic(until=0.1, step=1e-3), want="A", threads=1)


def test_errors_of_zero_can_be_drawn() -> None:
    plan = ancf.plan(cantilever(), run=ancf.Static(), want="A", tol=0.1)
    none = [replace(row, error=0.0) for row in plan.rows]
    replace(plan, rows=none).plot().savefig(io.BytesIO())
