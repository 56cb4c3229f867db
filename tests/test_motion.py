"""Methods, error control, damping, moved supports and checkpoints from Python."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import ancf
from ancf.balance import balance_warnings
from ancf.cli import main
from ancf.run import Method

# Those for flexible bodies.
METHODS = [method for method in get_args(Method) if method != "rigid"]
# The pendulum of Dufva and Shabana (2005) with 2 x 2 elements, m: two implementations agree on it.
TIP = [0.22634, 0.22634, -0.44155]


def pendulum(divisions: int = 2, membrane: Any = "full", **support: Any) -> ancf.Model:
    rubber = ancf.Material(E=1e5, nu=0.3, density=7810.0)
    plate = ancf.Rectangle(
        size=(0.3, 0.3), divisions=(divisions, divisions), thickness=0.01, material=rubber, membrane=membrane
    )
    return ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"], **support)],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
        probes=[ancf.Probe(name="A", at=(0.3, 0.3))],
    )


@pytest.mark.parametrize("method", METHODS)
def test_every_method_keeps_the_tolerance(method: Method) -> None:
    result = ancf.simulate(pendulum(), until=0.3, rtol=3e-5, method=method, outputs=[0.3])
    np.testing.assert_allclose(result.probes["A"].value[-1], TIP, atol=3e-4 * 0.3 * 2**0.5)


def test_rejections_are_counted_by_cause() -> None:
    """A first step over all of the motion has too large an error; a load that nothing can carry has no solution."""
    causes = ("inaccurate", "unsolved", "singular", "not_finite")
    counts = ancf.simulate(pendulum(), until=0.3, rtol=1e-4, first_step=0.3, outputs=[0.3]).counts
    assert counts["inaccurate"] > 0
    assert counts["rejected"] == sum(counts[cause] for cause in causes)
    burst = ancf.Pressure(pressure=1e9, history=[(0.1, 0.0), (0.11, 1.0)])
    held = [ancf.Support(at="edge:x0", clamp=True)]
    model = ancf.Model(bodies=pendulum().bodies, supports=held, loads=[burst])
    counts = ancf.simulate(model, until=0.3, step=0.01, throw=False).counts
    assert counts["rejected"] == counts["unsolved"] + counts["not_finite"] == 1


def test_a_motion_that_is_stuck_where_rubber_is_torn_from_its_pin_ends_soon() -> None:
    """Beside the pin a fine mesh is stretched beyond what leaves a strip of St. Venant-Kirchhoff's law any width."""
    side = 0.3 / 16
    model = pendulum(16, "projected").model_copy(update={"probes": [ancf.Probe(name="edge", at=(0.0, side))]})
    with pytest.raises(ancf.SolveError, match=r"singular at .* at \[") as failed:
        ancf.simulate(model, until=0.3, rtol=0.1, method="tr_bdf2")
    result = failed.value.result
    assert isinstance(result, ancf.Result)
    assert 0.23 < result.reached < 0.24
    assert "spread a support" in result.advice
    assert result.counts["steps"] < 200
    assert np.linalg.norm(result.probes["edge"].value[-1]) > 1.1 * (1.0 + 1.0 / 0.3) ** 0.5 * side
    for fine in (pendulum(16), pendulum(12, "projected")):
        assert ancf.simulate(fine, until=0.3, step=1e-3, outputs=[0.3]).reached == 0.3


def test_explicit_steps_above_the_limit_are_refused() -> None:
    with pytest.raises(ancf.SolveError, match="above the limit") as failed:
        ancf.simulate(pendulum(), until=0.3, step=0.05, method="verlet")
    assert failed.value.result.t == [0.0]
    with pytest.warns(ancf.EnergyWarning, match="comes from nowhere"):
        ancf.simulate(pendulum(), until=0.1, step=0.05, method="verlet", force=True, throw=False)


def test_a_body_at_rest_is_not_said_to_gain_energy() -> None:
    """Its energies are rounding. EnergyWarning would be an error here."""
    held = [ancf.Support(at="edge:x0", clamp=True)]
    result = ancf.simulate(ancf.Model(bodies=pendulum().bodies, supports=held), until=0.01, step=1e-3)
    assert result.energy.kinetic[-1] < 1e-20
    assert result.warnings == ()
    for method in METHODS:
        at_rest = ancf.Model(bodies=pendulum().bodies, supports=held)
        assert ancf.simulate(at_rest, until=0.01, rtol=1e-3, method=method).warnings == ()


def test_energy_that_comes_from_nowhere_is_told_under_error_control_as_well() -> None:
    """What error control takes is within its tolerance; what it adds is not."""
    run, none = ancf.Dynamic(until=1.0, rtol=0.1), np.zeros(3)
    energy = ancf.Energy(np.linspace(0.0, 1.0, 3), np.array([1.0, 0.9, 1.06]), none, none, none, none)
    (told,) = balance_warnings(run, energy, moved=False)
    assert "rises by 0.16 J, 15% of the largest energy" in told
    assert "a smaller rtol" in told
    energy = ancf.Energy(energy.t, np.array([1.0, 0.9, 0.5]), none, none, none, none)
    assert balance_warnings(run, energy, moved=False) == ()


def test_a_checkpoint_that_cannot_be_written_is_refused_first(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "missing" / "checkpoint"):
        with pytest.raises(ancf.InputError, match=str(path)):
            ancf.simulate(pendulum(), until=0.1, step=0.05, checkpoint=path)


def test_damping_slows_a_free_body_exponentially() -> None:
    rubber = ancf.Material(E=1e5, nu=0.3, density=7810.0, mass_damping=2.0)
    plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(1, 1), thickness=0.01, material=rubber)
    model = ancf.Model(bodies={"plate": plate})
    velocity = np.tile([1.0, 2.0, 3.0, 0, 0, 0, 0, 0, 0], 4)
    result = ancf.simulate(model, until=0.5, step=1e-3, method="esdirk", velocity=velocity)
    np.testing.assert_allclose(result.v[-1][:3], np.exp(-1.0) * velocity[:3], rtol=1e-9)
    lost = result.energy.kinetic[0] - result.energy.kinetic[-1]
    np.testing.assert_allclose(result.energy.dissipated[-1], lost, rtol=1e-9)


@pytest.mark.parametrize("states", [100, 130])
def test_explicit_steps_near_their_limit_stay_equal_between_outputs(states: int) -> None:
    """Where one in three was shorter, to end at the output, a falling flap was 1.5 times its motion off."""
    rubber = ancf.Material(E=1e5, nu=0.3, density=7810.0)
    flap = ancf.Rectangle(size=(0.25, 0.2), divisions=(32, 8), thickness=0.005, material=rubber)
    model = ancf.Model(
        bodies={"flap": flap},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
        probes=[ancf.Probe(name="A", at=(0.25, 0.2))],
    )
    known = ancf.simulate(model, until=0.1, rtol=1e-4, method="esdirk", every=0.1 / states).probes["A"].value
    found = ancf.simulate(model, until=0.1, rtol=0.1, method="verlet", every=0.1 / states).probes["A"].value
    np.testing.assert_allclose(found, known, rtol=0, atol=5e-3 * np.abs(known - known[0]).max())


def test_outputs_may_shorten_steps_below_the_shortest_that_the_tolerance_may_need() -> None:
    """Outputs at 2.4 times the length of a step: some are shorter than `min_step`, for no need of accuracy."""
    steps = ancf.simulate(pendulum(8), until=0.05, rtol=0.1, method="verlet", outputs=[0.05]).counts["steps"]
    step = 0.05 / steps
    result = ancf.simulate(
        pendulum(8), until=0.05, rtol=0.1, method="verlet", every=2.4 * step, min_step=0.9 * step, throw=False
    )
    assert result.status == "ok", result.reason


@pytest.mark.parametrize(
    ("element", "shape"),
    [*product(["thin36", "thin48"], ["rectangle", "cylinder"]), ("full48a", "rectangle"), ("full48b", "rectangle")],
)
def test_a_free_body_with_lumped_mass_falls_without_being_bent(element: Any, shape: str) -> None:
    """Every point by g t^2 / 2, without strain: gravity acts on the lumped masses, which are those of the body."""
    g, t, density = 9.81, 0.02, 7810.0
    steel = ancf.Material(E=2e11, nu=0.3, density=density)
    options: dict[str, Any] = {"element": element, "thickness": 0.01, "divisions": (3, 2), "material": steel}
    body: ancf.Rectangle | ancf.Cylinder
    if shape == "rectangle":
        body = ancf.Rectangle(size=(0.6, 0.4), **options)
        corners = [(0.0, 0.0), (0.6, 0.0), (0.6, 0.4), (0.0, 0.4)]
    else:
        body = ancf.Cylinder(radius=0.6, angle=(0.0, 1.0), length=(0.0, 0.4), **options)
        corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.0, 0.4)]
    model = ancf.Model(bodies={"body": body}, loads=[ancf.Gravity(acceleration=(0.0, 0.0, -g))])
    result = ancf.simulate(model, until=t, rtol=1e-2, method="verlet", lumped=True)
    fallen = result.evaluate("body", corners, "displacement")[-1]
    np.testing.assert_allclose(fallen, [[0.0, 0.0, -g * t**2 / 2]] * 4, rtol=0, atol=1e-12)
    kinetic = result.energy.kinetic[-1]
    assert result.energy.membrane[-1] + result.energy.bending[-1] < 1e-12 * kinetic
    # The mass of a curved body is that of its interpolated surface.
    known = density * 0.6 * 0.4 * 0.01 * (g * t) ** 2 / 2
    np.testing.assert_allclose(kinetic, known, rtol=1e-12 if shape == "rectangle" else 1e-4)


def test_a_shaken_corner_moves_as_prescribed() -> None:
    model = pendulum(shake={"amplitude": (0.0, 0.01, 0.0), "frequency": 2.0})
    result = ancf.simulate(model, until=0.3, step=1e-3, every=0.05)
    np.testing.assert_allclose(result.q[:, 1], 0.01 * np.sin(4 * np.pi * result.t), atol=1e-8)
    balance = result.energy.kinetic + result.energy.membrane + result.energy.bending - result.energy.loads
    assert abs(balance[-1]) < 1e-3 * result.energy.loads[-1]


def test_what_drags_a_stiff_plate_gives_its_energy() -> None:
    """By mean forces, not by those at the mean of two positions, in which a body that has turned is strained."""
    steel = ancf.Material(E=5e9, nu=0.3, density=1000.0)
    plate = ancf.Rectangle(size=(0.3, 0.1), divisions=(1, 1), thickness=0.003, material=steel, membrane="full")
    drag = ancf.Support(at="corner:x0y0", fix=["r"], translation=[(0, 0, 0, 0), (0.2, 0.1, 0, 0.2)])
    model = ancf.Model(bodies={"plate": plate}, supports=[drag])
    energy = ancf.simulate(model, until=0.4, step=2e-3, method="energy_momentum").energy
    balance = energy.kinetic + energy.membrane + energy.bending - energy.loads
    assert np.max(np.abs(balance)) < 5e-3 * np.max(energy.kinetic)


def test_a_turned_corner_carries_its_gradient() -> None:
    model = pendulum(rotation={"axis": (0.0, 0.0, 1.0), "angle": [[0, 0], [0.1, 0.2], [0.2, 0.5]]})
    turned = ancf.Model(
        bodies=model.bodies,
        supports=[ancf.Support(at="edge:x0", clamp=True, rotation=model.supports[0].rotation)],
    )
    result = ancf.simulate(turned, until=0.2, step=1e-3, outputs=[0.2])
    np.testing.assert_allclose(result.q[-1][3:6], [np.cos(0.5), np.sin(0.5), 0.0], atol=1e-14)


def run(scene: Path, folder: Path, *arguments: str | Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "ancf", "run", scene, "-o", folder, "--quiet", *arguments]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_stopped_run_goes_on_to_the_same_bits(
    edit: Callable[..., Path], tmp_path: Path, number: signal.Signals
) -> None:
    scene = edit(
        "pendulum.toml",
        ("E = 1e5", "E = 1e6"),
        ("divisions = [2, 2]", "divisions = [4, 4]"),
        ("until = 0.05", "until = 2.0"),
        ("step = 5e-3\noutputs = [0.025, 0.05]", "step = 5e-4\nevery = 0.01"),
    )
    whole, stopped, checkpoint = tmp_path / "whole", tmp_path / "stopped", tmp_path / "checkpoint"
    assert run(scene, whole).wait() == 0
    process = run(scene, stopped, "--checkpoint", checkpoint)
    while not checkpoint.exists() and process.poll() is None:
        time.sleep(0.01)
    os.kill(process.pid, number)
    assert process.wait() == (130 if number == signal.SIGINT else -number)
    assert run(scene, stopped, "--resume", checkpoint).wait() == 0
    with np.load(whole / "result.npz") as expected, np.load(stopped / "result.npz") as found:
        for name in ("t", "q", "v", "a"):
            assert np.array_equal(expected[name], found[name])


def test_a_broken_checkpoint_is_refused(tmp_path: Path) -> None:
    checkpoint = tmp_path / "checkpoint"
    ancf.simulate(pendulum(), until=0.01, step=1e-3, checkpoint=checkpoint)
    whole = checkpoint.read_bytes()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 16  # in a number, which stays one
    for broken in (whole[:-8], bytes(flipped)):
        checkpoint.write_bytes(broken)
        with pytest.raises(ancf.InputError, match=r"checkpoint: is damaged: .* allowed is a whole checkpoint file"):
            ancf.simulate(pendulum(), until=0.01, step=1e-3, resume=checkpoint)
    ancf.simulate(pendulum(), until=0.01, step=1e-3, checkpoint=checkpoint)
    with pytest.raises(ancf.InputError, match="nodal coordinates"):
        ancf.simulate(pendulum(4), until=0.01, step=1e-3, resume=checkpoint)
    with pytest.raises(ancf.InputError, match="method"):
        ancf.simulate(pendulum(), until=0.01, step=1e-3, method="esdirk", resume=checkpoint)


def test_a_checkpoint_that_cannot_be_written_any_more_does_not_end_the_run(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    with pytest.warns(ancf.CheckpointWarning, match="not written: .*checkpoint: No such file") as given:
        result = ancf.simulate(
            pendulum(),
            until=0.3,
            step=1e-5,
            method="verlet",
            checkpoint=folder / "checkpoint",
            progress=lambda _: shutil.rmtree(folder, ignore_errors=True),
        )
    assert result.status == "ok"
    assert result.reached == 0.3
    assert [str(doubt.message) for doubt in given] == list(result.warnings)


def test_the_message_about_a_checkpoint_names_the_file(
    scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "no such file"
    arguments = ["run", str(scenes / "pendulum.toml"), "-o", str(tmp_path / "out"), "--resume", str(file)]
    assert main(arguments) == 2
    assert capsys.readouterr().err == f"ancf: {file}: cannot be read: No such file or directory\n"
    file.write_bytes(b"something else")
    assert main(arguments) == 2
    assert capsys.readouterr().err == f"ancf: {file}: is 14 bytes; allowed is a whole checkpoint file of this version\n"
    assert not (tmp_path / "out").exists()


def test_a_checkpoint_of_another_model_is_refused(tmp_path: Path) -> None:
    checkpoint = tmp_path / "checkpoint"
    ancf.simulate(pendulum(), until=0.01, step=1e-3, checkpoint=checkpoint)
    lighter = ancf.Model(bodies=pendulum().bodies, supports=pendulum().supports, probes=pendulum().probes)
    with pytest.raises(ancf.InputError, match="other loads"):
        ancf.simulate(lighter, until=0.01, step=1e-3, resume=checkpoint)
    with pytest.raises(ancf.InputError, match="other options"):
        ancf.simulate(pendulum(), until=0.01, step=5e-4, resume=checkpoint)
