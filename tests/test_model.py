"""Models, runs and results in Python."""

import doctest
import importlib
import inspect
import io
import pkgutil
from pathlib import Path

import numpy as np
import pytest

import ancf


def test_examples_in_the_documentation() -> None:
    names = ["ancf", *(f"ancf.{module.name}" for module in pkgutil.iter_modules(ancf.__path__))]
    modules = [importlib.import_module(name) for name in names if name not in ("ancf.__main__", "ancf._core")]
    results = [doctest.testmod(module) for module in modules]
    assert sum(result.attempted for result in results) > 20
    assert not any(result.failed for result in results)


def test_all_is_sorted_and_there() -> None:
    assert sorted(ancf.__all__) == list(ancf.__all__)
    assert all(hasattr(ancf, name) for name in ancf.__all__)


@pytest.mark.parametrize(("function", "options"), [(ancf.solve_static, ancf.Static), (ancf.simulate, ancf.Dynamic)])
def test_arguments_are_those_of_the_scene(function: object, options: type[ancf.Static] | type[ancf.Dynamic]) -> None:
    parameters = inspect.signature(function).parameters  # type: ignore[arg-type]
    for name, field in options.model_fields.items():
        if name == "path":
            continue
        default = inspect.Parameter.empty if field.is_required() else field.default
        assert parameters[name].default == default, name


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"E": "soft"}, 'E = "soft": must be a number'),
        ({"E": np.nan}, "E = nan: must be a finite number"),
        ({"nu": 0.5}, "nu = 0.5: must be less than 0.5"),
        ({"density": -1.0}, "density = -1.0: must be greater than or equal to 0"),
        ({"rho": 1.0}, "rho = 1.0: unknown key; allowed are E, nu, density, mass_damping, viscosity"),
    ],
)
def test_a_wrong_argument_is_named(change: dict[str, object], message: str) -> None:
    with pytest.raises(ancf.InputError) as caught:
        ancf.Material(**{"E": 1e5, "nu": 0.3, **change})  # type: ignore[arg-type]
    assert str(caught.value) == message


def test_wrong_models(rubber: ancf.Material) -> None:
    plate = ancf.Rectangle(size=(1.0, 1.0), divisions=(1, 1), thickness=0.1, material=rubber)
    with pytest.raises(ancf.InputError, match=r"material = \"rubber\": must be a table \(in Python: Material\)"):
        ancf.Rectangle(size=(1.0, 1.0), divisions=(1, 1), thickness=0.1, material="rubber")  # type: ignore[arg-type]
    with pytest.raises(ancf.InputError, match=r"bodies = {}: must hold at least one body"):
        ancf.Model(bodies={})
    probe = ancf.Probe(name="A", at=(0.5, 0.5))
    with pytest.raises(ancf.InputError, match=r'probes.1.name = "A": is the name of another probe'):
        ancf.Model(bodies={"plate": plate}, probes=[probe, probe])
    with pytest.raises(ancf.InputError, match=r"supports.0 = 3: must be a table \(in Python: Support\)"):
        ancf.Model(bodies={"plate": plate}, supports=[3])  # type: ignore[list-item]
    with pytest.raises(ancf.InputError) as caught:
        ancf.Model(bodies={"plate": plate}, probes=[ancf.Probe(name="A", at=(2.0, 0.0))])
    assert [mistake.path for mistake in caught.value.mistakes] == [("probes", 0, "at")]


def test_inputs_are_frozen_and_take_arrays(rubber: ancf.Material) -> None:
    size, divisions = np.array([0.3, 0.2]), np.array([3, 2])
    plate = ancf.Rectangle(size=size, divisions=divisions, thickness=np.float64(0.01), material=rubber)  # type: ignore[arg-type]
    assert plate.size == (0.3, 0.2)
    assert plate.divisions == (3, 2)
    with pytest.raises(ValueError, match="frozen"):
        plate.thickness = 1.0


def test_wrong_runs(pendulum: ancf.Model) -> None:
    with pytest.raises(ancf.InputError, match="threads = 0: must be a whole number from 1 to 1024"):
        ancf.simulate(pendulum, until=0.1, step=0.01, threads=0)
    with pytest.raises(ancf.InputError, match="progress = 3: must be"):
        ancf.simulate(pendulum, until=0.1, step=0.01, progress=3)  # type: ignore[arg-type]
    with pytest.raises(ancf.InputError, match=r"velocity: must have the shape \(81,\), not \(3,\)"):
        ancf.simulate(pendulum, until=0.1, step=0.01, velocity=np.zeros(3))
    with pytest.raises(ancf.InputError, match=r"step = 1\.0: must not be greater than until"):
        ancf.simulate(pendulum, until=0.1, step=1.0)


def test_states_and_positions(pendulum: ancf.Model) -> None:
    assert (pendulum.elements, pendulum.dofs) == (4, 78)
    assert pendulum.nodal_coordinates().shape == (81,)
    result = ancf.simulate(pendulum, until=0.02, step=2e-3, outputs=[0.01, 0.02])
    assert result.status == "ok"
    np.testing.assert_allclose(result.t, [0.0, 0.01, 0.02])
    assert result.q.shape == result.v.shape == result.a.shape == (3, 81)
    assert result.momentum.shape == result.angular_momentum.shape == (3, 3)
    # At rest the material point (x, y) is at (x, y, 0); the free corner starts to fall as if it were not held.
    points = [(0.1, 0.2), (0.3, 0.3)]
    np.testing.assert_allclose(result.positions("plate", points)[0], [[0.1, 0.2, 0.0], [0.3, 0.3, 0.0]], atol=1e-15)
    np.testing.assert_array_equal(result.probes["A"].value, result.positions("plate", points)[:, 1])
    velocity = result.evaluate("plate", points, "velocity")
    np.testing.assert_allclose(velocity[1, 1, 2], -9.81 * 0.01, rtol=0.05)
    strain_and_kinetic = result.energy.kinetic + result.energy.membrane + result.energy.bending
    np.testing.assert_allclose(strain_and_kinetic, result.energy.loads, rtol=0.02, atol=1e-12)


def test_wrong_questions(pendulum: ancf.Model) -> None:
    result = ancf.simulate(pendulum, until=0.01, step=5e-3)
    with pytest.raises(ancf.InputError, match=r'body = "plat": allowed is plate$'):
        result.positions("plat", [(0.0, 0.0)])
    with pytest.raises(ancf.InputError, match='quantity = "speed": allowed are position'):
        result.evaluate("plate", [(0.0, 0.0)], "speed")  # type: ignore[arg-type]
    with pytest.raises(ancf.InputError, match=r"points: must have the shape \(points, 2\), not \(2,\)"):
        result.positions("plate", (0.0, 0.0))
    with pytest.raises(ancf.InputError, match=r"points.*0\.4"):
        result.positions("plate", [(0.4, 0.0)])
    with pytest.raises(ancf.InputError, match=r"points = \[\[0, 0\], \[1\]\]: must be an array of numbers"):
        result.positions("plate", [(0, 0), (1,)])
    with pytest.raises(ancf.InputError, match=r"q: must have the shape \(states, 81\), not \(81,\)"):
        pendulum.evaluate("plate", [(0.0, 0.0)], "position", result.q[0])
    with pytest.raises(ancf.InputError, match=r"v: must have the shape \(3, 81\), not \(2, 81\)"):
        pendulum.evaluate("plate", [(0.0, 0.0)], "velocity", result.q, result.v[:2])
    with pytest.raises(ancf.InputError, match=r'body = "plat": allowed is plate$'):
        pendulum.domain("plat")


def test_states_may_be_arrays_of_any_kind(pendulum: ancf.Model) -> None:
    q = np.round(pendulum.nodal_coordinates() * 1024).reshape(1, -1)
    expected = pendulum.evaluate("plate", [(0.3, 0.3)], "position", q)
    for same in (q.astype(int), q.astype(np.float32), q.tolist(), np.repeat(q, 2, axis=1)[:, ::2]):
        np.testing.assert_array_equal(pendulum.evaluate("plate", [(0.3, 0.3)], "position", same), expected)
    still = ancf.simulate(pendulum, until=0.01, step=5e-3, velocity=[0] * 81, threads=np.int64(1))  # type: ignore[arg-type]
    np.testing.assert_array_equal(still.q, ancf.simulate(pendulum, until=0.01, step=5e-3).q)


def test_what_is_optional_may_be_none(pendulum: ancf.Model) -> None:
    support = ancf.Support(at="edge:x0", clamp=True, translation=None, shake=None, rotation=None, symmetry=None)
    assert support == ancf.Support(at="edge:x0", clamp=True)
    assert ancf.Gravity(acceleration=(0.0, 0.0, -9.81), history=None) == pendulum.loads[0]


def test_results_are_compared_by_identity(pendulum: ancf.Model) -> None:
    result, other = (ancf.simulate(pendulum, until=0.01, step=5e-3) for _ in range(2))
    assert result == result  # noqa: PLR0124
    assert result != other
    assert result.energy != other.energy


def test_a_changed_copy_is_checked_and_made_anew(pendulum: ancf.Model) -> None:
    finer = pendulum.model_copy(
        update={"bodies": {"plate": pendulum.bodies["plate"].model_copy(update={"divisions": (3, 2)})}}
    )
    assert (finer.elements, len(finer.nodal_coordinates())) == (6, 9 * 12)
    with pytest.raises(ancf.InputError, match=r"thickness = 0: must be greater than 0"):
        pendulum.bodies["plate"].model_copy(update={"thickness": 0})


def test_a_long_narrow_strip_is_held_at_its_ends(rubber: ancf.Material) -> None:
    strip = ancf.Rectangle(size=(10.0, 1e-3), divisions=(4, 1), thickness=1e-4, material=rubber)
    ends = [ancf.Support(at=edge, fix=["r"]) for edge in ("edge:x0", "edge:x1")]
    assert ancf.Model(bodies={"strip": strip}, supports=ends).rigid_motions() == []
    hinge = [ancf.Support(at=corner, fix=["r"]) for corner in ("corner:x0y0", "corner:x1y0")]
    assert ancf.Model(bodies={"strip": strip}, supports=hinge).rigid_motions() == [("strip", "rotation about x")]


def test_outputs_beyond_the_end_by_rounding_are_at_the_end(pendulum: ancf.Model) -> None:
    result = ancf.simulate(pendulum, until=0.3, step=0.1, outputs=[n * 0.1 for n in (1, 2, 3)])
    assert result.t.tolist() == [0.0, 0.1, 0.2, 0.3]
    with pytest.raises(ancf.InputError, match=r"outputs = \[0\.3001\]: must increase and lie in \[0, 0\.3\]"):
        ancf.simulate(pendulum, until=0.3, step=0.1, outputs=[0.3001])


def test_a_free_plate_keeps_its_velocity(rubber: ancf.Material) -> None:
    plate = ancf.Rectangle(size=(0.3, 0.2), divisions=(2, 1), thickness=0.01, material=rubber)
    model = ancf.Model(bodies={"plate": plate}, probes=[ancf.Probe(name="A", at=(0.1, 0.1))])
    velocity = np.zeros((6, 3, 3))
    velocity[:, 0] = (1.0, 2.0, 3.0)
    result = ancf.simulate(model, until=0.1, step=0.02, velocity=velocity.ravel(), outputs=[0.1])
    np.testing.assert_allclose(result.probes["A"].value[-1], [0.2, 0.3, 0.3], rtol=1e-12)
    np.testing.assert_allclose(result.momentum[-1], 0.3 * 0.2 * 0.01 * 7810.0 * np.array([1, 2, 3]), rtol=1e-12)


def test_progress_is_told_and_an_exception_in_it_stops_the_run(pendulum: ancf.Model) -> None:
    reached: list[float] = []
    ancf.simulate(pendulum, until=0.02, step=5e-3, progress=reached.append)
    assert reached == sorted(reached)
    assert reached[-1] == pytest.approx(0.02)

    def stop(t: float) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough") as caught:
        ancf.simulate(pendulum, until=20.0, step=1e-3, progress=stop)
    result = caught.value.result  # type: ignore[attr-defined]
    assert isinstance(result, ancf.Result)
    assert result.status == "interrupted"
    assert result.reached < 20
    assert "stopped the run at t =" in caught.value.__notes__[0]


def test_a_bar_shows_on_a_terminal_only(pendulum: ancf.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    for stream, shown in ((Terminal(), True), (io.StringIO(), False)):
        monkeypatch.setattr("sys.stderr", stream)
        ancf.simulate(pendulum, until=0.02, step=5e-3, progress=True)
        assert ("0.02/0.02 s" in stream.getvalue()) == shown


def test_a_failed_run_keeps_what_it_had(pendulum: ancf.Model) -> None:
    with pytest.raises(ancf.SolveError, match=r"the run failed at t = .* s: .*\. Try: ") as caught:
        ancf.simulate(pendulum, until=1.0, step=0.5, max_iterations=1)
    result = caught.value.result
    assert result.status == "failed"
    assert result.reason
    assert result.advice
    assert result.t[0] == 0
    assert len(result.t) == len(result.q) == len(result.probes["A"].value)
    same = ancf.simulate(pendulum, until=1.0, step=0.5, max_iterations=1, throw=False)
    assert (same.status, same.reached) == ("failed", result.reached)


def test_no_load_and_hardly_any_are_solved(rubber: ancf.Material) -> None:
    plate = ancf.Rectangle(size=(1.0, 0.2), divisions=(4, 1), thickness=0.01, material=rubber)
    wall = ancf.Support(at="edge:x0", clamp=True)
    for load in (0.0, 1e-15):
        model = ancf.Model(
            bodies={"plate": plate},
            supports=[wall],
            loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, load))],
            probes=[ancf.Probe(name="tip", at=(1.0, 0.1), quantity="displacement")],
        )
        result = ancf.solve_static(model)
        assert result.counts["steps"] == 1
        # P L^3 / (3 E I), to the few per cent that a clamped plate of finite width is stiffer.
        expected = load * 0.2 / (3 * 1e5 * 0.2 * 0.01**3 / 12)
        assert result.probes["tip"].value[-1, 2] == pytest.approx(expected, rel=0.06, abs=1e-18)


def test_the_last_good_state_is_kept(pendulum: ancf.Model) -> None:
    result = ancf.simulate(pendulum, until=1.0, step=0.02, outputs=[0.0, 1.0], max_iterations=3, throw=False)
    assert result.status == "failed"
    assert 0 < result.reached < 1
    assert result.t.tolist() == [0.0, result.reached]


def test_titles_are_plain_text(pendulum: ancf.Model, tmp_path: Path) -> None:
    result = ancf.simulate(pendulum, until=0.01, step=5e-3)
    result.plot("$a_{$").savefig(tmp_path / "plate.png")


def test_what_the_usual_font_lacks_is_drawn_in_another(
    pendulum: ancf.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    letter = "\N{COMBINING ENCLOSING CIRCLE}"  # not of DejaVu, but of another font of Matplotlib's
    result = ancf.simulate(pendulum, until=0.01, step=5e-3)
    with pytest.warns(UserWarning, match="Glyph 8413 .* missing"):
        result.plot(letter).savefig(tmp_path / "plate.png")
    monkeypatch.setattr("ancf.text._FAMILIES", ("none such", "STIXGeneral"))
    result.plot(letter).savefig(tmp_path / "plate.png")


def test_too_many_outputs_are_refused(pendulum: ancf.Model) -> None:
    with pytest.raises(ancf.InputError, match="every = 1e-12: must be at least until / 1000000"):
        ancf.simulate(pendulum, until=0.01, step=1e-3, every=1e-12)
