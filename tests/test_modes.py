"""Natural frequencies and mode shapes against closed forms, dense eigenvalues and published ones."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import coo_array

import ancf
from ancf.cli import main

STEEL = ancf.Material(E=2e11, nu=0.0, density=8000.0)
LENGTH, WIDTH, THICKNESS = 1.0, 0.05, 0.002
RIGIDITY = STEEL.E * WIDTH * THICKNESS**3 / 12
MASS = STEEL.density * WIDTH * THICKNESS


def hinged(tension: float) -> ancf.Model:
    """A strip on hinges at both ends, pulled by `tension`, N, at one that can move along x."""
    strip = ancf.Rectangle(
        size=(LENGTH, WIDTH), divisions=(10, 1), thickness=THICKNESS, material=STEEL, element="thin48"
    )
    return ancf.Model(
        bodies={"strip": strip},
        supports=[ancf.Support(at="edge:x0", fix=["r"]), ancf.Support(at="edge:x1", fix=["r.y", "r.z"])],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(tension / WIDTH, 0.0, 0.0))],
    )


def beam(number: int, tension: float) -> float:
    """Return omega^2 of a hinged beam under tension: bending stiffness and that of a string."""
    k = number * np.pi / LENGTH
    return (RIGIDITY * k**4 + tension * k**2) / MASS


def test_a_strip_under_tension_is_a_beam_and_a_string() -> None:
    tension = 5 * RIGIDITY * (np.pi / LENGTH) ** 2
    for load_factor in (0.0, 1.0, 2.0):
        found = ancf.modes(hinged(tension), count=3, load_factor=load_factor)
        expected = [np.sqrt(beam(number, load_factor * tension)) / (2 * np.pi) for number in (1, 2, 3)]
        np.testing.assert_allclose(found.frequency, expected, rtol=1e-3)
        assert found.unstable == 0


def test_about_any_state_and_a_negative_frequency_where_it_buckles() -> None:
    critical = RIGIDITY * (np.pi / LENGTH) ** 2
    model = hinged(-0.5 * critical)
    half = ancf.solve_static(model)
    np.testing.assert_allclose(ancf.modes(model, count=1, q=half.q[-1]).eigenvalue, beam(1, -0.5 * critical), rtol=1e-3)
    rest = model.nodal_coordinates()
    twice = ancf.modes(model, count=2, q=rest + 4 * (half.q[-1] - rest))
    np.testing.assert_allclose(twice.eigenvalue, [beam(1, -2 * critical), beam(2, -2 * critical)], rtol=1e-3)
    assert twice.unstable == 1
    assert twice.frequency[0] == pytest.approx(-np.sqrt(-beam(1, -2 * critical)) / (2 * np.pi), rel=1e-3)


@pytest.mark.parametrize("membrane", ["projected", "full", "lobatto"])
@pytest.mark.parametrize(("size", "divisions"), [((2.0, 0.1), (8, 1)), ((2.0, 0.1), (1, 1)), ((1.0, 0.7), (4, 1))])
def test_a_thin_free_strip_has_six_zeros(
    membrane: Literal["projected", "full", "lobatto"], size: tuple[float, float], divisions: tuple[int, int]
) -> None:
    """Rounded strains at rest are membrane forces that hold a flat strip against turning about its long side."""
    strip = ancf.Rectangle(
        size=size,
        divisions=divisions,
        thickness=0.001,
        material=ancf.Material(E=2e11, nu=0.3, density=7800.0),
        membrane=membrane,
    )
    frequency = ancf.modes(ancf.Model(bodies={"strip": strip}), count=7).frequency
    assert np.all(frequency[:6] == 0)
    assert frequency[6] > 0.5


def test_dense_eigenvalues_are_the_same() -> None:
    plate = ancf.Rectangle(size=(1.0, 0.6), divisions=(3, 2), thickness=0.02, material=STEEL)
    model = ancf.Model(bodies={"plate": plate}, supports=[ancf.Support(at="corner:x0y0", clamp=True)])
    core = model.assemble("ramp")
    n, free = core.coordinates, core.free().astype(int)

    def dense(triplets: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
        rows, columns, values = triplets
        matrix = coo_array((values, (rows.astype(int), columns.astype(int))), shape=(n, n)).toarray()
        part: np.ndarray = matrix[np.ix_(free, free)]
        return part

    q = model.nodal_coordinates()
    expected, vectors = eigh(dense(core.tangent(q)), dense(core.mass()))
    for count in (1, 12, model.dofs):
        found = ancf.modes(model, count=count)
        np.testing.assert_allclose(found.eigenvalue, expected[:count], rtol=1e-8)
        overlap = np.abs(np.sum(found.shapes[:, free] @ dense(core.mass()) * vectors[:, :count].T, axis=1))
        np.testing.assert_allclose(overlap[:10], 1, atol=1e-6)


@pytest.mark.parametrize("membrane", ["projected", "lobatto"])
def test_bending_of_a_clamped_foil_is_no_zero(membrane: Literal["projected", "lobatto"]) -> None:
    """Of 1 um on 1 m its first eigenvalue is as small as rounding, but a clamped body has no rigid motion."""
    foil = ancf.Rectangle(size=(1.0, 0.01), divisions=(12, 1), thickness=1e-6, material=STEEL, membrane=membrane)
    model = ancf.Model(bodies={"foil": foil}, supports=[ancf.Support(at="edge:x0", clamp=True)])
    # cos(x) cosh(x) = -1, and = 1.
    clamped, free = np.array([1.8751, 4.6941, 7.8548]), np.array([4.7300, 7.8532])
    unit = np.sqrt(STEEL.E * 1e-12 / 12 / STEEL.density) / (2 * np.pi)
    assert ancf.modes(model, count=3).frequency == pytest.approx(clamped**2 * unit, rel=8e-3)
    found = ancf.modes(ancf.Model(bodies={"foil": foil}), count=8).frequency
    assert np.all(found[:6] == 0.0)
    assert found[6:] == pytest.approx(free**2 * unit, rel=8e-3)


@pytest.mark.parametrize("count", [4, 14])
def test_rigid_motions_are_zeros(count: int) -> None:
    plate = ancf.Rectangle(size=(0.3, 0.2), divisions=(3, 2), thickness=1e-3, material=STEEL)
    shell = ancf.Cylinder(
        radius=0.5, angle=(0, 1.0), length=(0, 0.4), divisions=(3, 3), thickness=1e-2, material=STEEL, element="thin48"
    )
    found = ancf.modes(ancf.Model(bodies={"plate": plate, "shell": shell}), count=count)
    np.testing.assert_array_equal(found.frequency[:12], 0)
    assert (found.frequency[12:] > 1).all()


def test_the_modes_of_a_cantilever_follow_its_shape() -> None:
    strip = ancf.Rectangle(size=(LENGTH, WIDTH), divisions=(16, 1), thickness=THICKNESS, material=STEEL)
    model = ancf.Model(bodies={"strip": strip}, supports=[ancf.Support(at="edge:x0", clamp=True)])
    found = ancf.modes(model, count=2)
    root = 1.8751040687
    expected = root**2 * np.sqrt(RIGIDITY / MASS) / LENGTH**2 / (2 * np.pi)
    assert found.frequency[0] == pytest.approx(expected, rel=1e-3)
    x = np.linspace(0, LENGTH, 9)
    shape = found.displacements("strip", np.stack([x, np.full(9, WIDTH / 2)], axis=1))[0, :, 2]
    s = root * x / LENGTH
    ratio = (np.cos(root) + np.cosh(root)) / (np.sin(root) + np.sinh(root))
    analytic = np.cosh(s) - np.cos(s) - ratio * (np.sinh(s) - np.sin(s))
    np.testing.assert_allclose(shape / shape[-1], analytic / analytic[-1], atol=1e-3)
    # The modal mass of a beam that is displaced by phi at its end is m L phi^2 / 4.
    assert MASS * LENGTH * shape[-1] ** 2 / 4 == pytest.approx(1, rel=1e-3)


def test_mistakes() -> None:
    model = hinged(1.0)
    with pytest.raises(ancf.InputError, match=r"count = 1000: must not be greater than"):
        ancf.modes(model, count=1000)
    with pytest.raises(ancf.InputError, match=r"q: must have the shape \(\d+,\), not"):
        ancf.modes(model, q=[1.0])
    light = ancf.Rectangle(size=(1, 1), divisions=(1, 1), thickness=0.1, material=ancf.Material(E=1.0, nu=0.0))
    with pytest.raises(ancf.InputError, match=r"density = 0\.0: must be greater than 0"):
        ancf.modes(ancf.Model(bodies={"light": light}))
    constant = ancf.LineLoad(at="edge:x1", per_length=(1.0, 0.0, 0.0), history="constant")
    with pytest.raises(ancf.InputError, match=r"loads\.0\.history = .*: acts at load factor 0"):
        ancf.modes(ancf.Model(bodies=model.bodies, supports=model.supports, loads=[constant]))
    free = ancf.Model(bodies=model.bodies, loads=model.loads)
    with pytest.raises(ancf.InputError, match="can still move"):
        ancf.modes(free, load_factor=1.0)


def test_loads_without_a_potential_are_refused() -> None:
    model = hinged(0.0)
    pressure = ancf.Pressure(pressure=1000.0)
    cantilever = ancf.Model(bodies=model.bodies, supports=[ancf.Support(at="edge:x0", clamp=True)], loads=[pressure])
    with pytest.raises(ancf.SolveError, match="no potential"):
        ancf.modes(cantilever, count=4, load_factor=1.0)


def test_a_pressure_on_a_plate_held_all_round_has_a_potential() -> None:
    plate = ancf.Rectangle(size=(1.0, 1.0), divisions=(6, 6), thickness=0.005, material=STEEL)
    edges = [ancf.Support(at=edge, fix=["r"]) for edge in ("edge:x0", "edge:x1", "edge:y0", "edge:y1")]
    model = ancf.Model(bodies={"plate": plate}, supports=edges, loads=[ancf.Pressure(pressure=1e4)])
    assert ancf.modes(model, count=4, load_factor=1.0).frequency[0] > 2 * ancf.modes(model, count=4).frequency[0]


def test_a_stop_from_the_progress_function() -> None:
    def stop(_: float) -> None:
        raise RuntimeError("enough")

    plate = ancf.Rectangle(size=(1.0, 1.0), divisions=(40, 40), thickness=0.01, material=STEEL)
    with pytest.raises(RuntimeError, match="enough"):
        ancf.modes(ancf.Model(bodies={"plate": plate}), count=100, progress=stop)


SCENE = """
title = "Strip"
[material.steel]
E = 2e11
nu = 0.3
density = 7800
[body.strip]
shape = "rectangle"
size = [1, 0.2]
divisions = [4, 1]
thickness = 0.01
material = "steel"
[run]
kind = "modes"
count = 8
"""


def test_a_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    folder = tmp_path / "out"
    assert main(["run", str(scene), "-o", str(folder), "--plot", "--animate"]) == 0
    told = capsys.readouterr().out
    assert "Strip: ok, 8 modes" in told
    assert "0 Hz  no stiffness" in told
    found = json.loads((folder / "summary.json").read_text())
    assert found["status"] == "ok"
    frequency = found["modes"]["frequency"]
    assert frequency[:6] == [0.0] * 6
    # A free beam: 22.373 sqrt(E I / (m L^4)), stiffer by up to 1 / (1 - nu^2) as a plate.
    lowest = 22.373 * np.sqrt(2e11 * 0.01**2 / 12 / 7800) / (2 * np.pi)
    assert lowest < frequency[6] < lowest / np.sqrt(0.91)
    with np.load(folder / "result.npz") as arrays:
        np.testing.assert_array_equal(arrays["frequency"], frequency)
        assert arrays["shapes"].shape == (8, 90)
    assert {path.name for path in folder.iterdir()} == {"summary.json", "result.npz", "plate.png", "motion.gif"}
    read = ancf.load_scene(scene)
    assert ancf.Scene.of(read.document()) == read
    np.testing.assert_array_equal(read.modes().frequency, frequency)
    with pytest.raises(ancf.InputError, match=r"run\.kind = modes: is found by Scene\.modes"):
        read.solve()


def test_a_scene_of_another_kind_has_no_modes(scenes: Path) -> None:
    with pytest.raises(ancf.InputError, match=r"run\.kind = dynamic: is run by Scene\.solve"):
        ancf.load_scene(scenes / "pendulum.toml").modes()


def test_mistakes_in_a_scene(tmp_path: Path, edit: Callable[..., Path]) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.replace("count = 8", "count = 8\nload_factors = [1.0]"))
    with pytest.raises(ancf.InputError, match=r"run\.load_factors.*did you mean load_factor\?"):
        ancf.load_scene(scene)
    scene.write_text(SCENE.replace("count = 8", "count = 500"))
    with pytest.raises(ancf.InputError, match=r"run\.count = 500: must not be greater than 90"):
        ancf.load_scene(scene)


def test_modes_are_not_swept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE + '[[probe]]\nname = "A"\nat = [1, 0.1]\n')
    assert main(["chart", str(scene), "-o", str(tmp_path / "out")]) == 2
    assert 'run.kind = "modes": must be static or dynamic' in capsys.readouterr().err


@pytest.mark.parametrize(("length", "known"), [(10.0, True), (100.0, False)])
def test_modes_that_rounding_takes_are_an_error(length: float, known: bool) -> None:
    """Of a strip 10 mm wide and 1 mm thick: Euler and Bernoulli's first frequency, or none."""
    strip = ancf.Rectangle(
        size=(length, 0.01), divisions=(16, 1), thickness=1e-3, material=ancf.Material(E=2e11, nu=0.0, density=7800.0)
    )
    model = ancf.Model(bodies={"strip": strip}, supports=[ancf.Support(at="edge:x0", clamp=True)])
    if not known:
        with pytest.raises(ancf.SolveError, match="rounding changes the squared frequency of mode 1"):
            ancf.modes(model, count=2)
        return
    exact = 1.8751**2 / (2 * np.pi * length**2) * np.sqrt(2e11 * 1e-6 / 12 / 7800)
    np.testing.assert_allclose(ancf.modes(model, count=2).frequency[0], exact, rtol=1e-3)


def test_projected_has_false_modes_in_the_plane() -> None:
    """A free square of 2 x 2 elements: docs/modes.md says so; `full` begins near sqrt(E / rho) / (2 a) and above."""
    lowest = {}
    for membrane in ("projected", "full"):
        square = ancf.Rectangle(
            size=(1.0, 1.0),
            divisions=(2, 2),
            thickness=1e-3,
            membrane=membrane,
            material=ancf.Material(E=2e11, nu=0.3, density=7800.0),
        )
        found = ancf.modes(ancf.Model(bodies={"square": square}), count=60)
        squares = found.shapes.reshape(len(found.shapes), -1, 3) ** 2
        plane = squares[..., :2].sum(axis=(1, 2)) > 0.5 * squares.sum(axis=(1, 2))
        lowest[membrane] = found.frequency[plane & (found.frequency > 1e-3)][0]
    assert 0.6 < lowest["full"] / (0.5 * np.sqrt(2e11 / 7800.0)) < 1.2
    assert lowest["projected"] == pytest.approx(0.011 * lowest["full"], rel=0.1)
