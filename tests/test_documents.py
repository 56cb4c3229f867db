"""Models, scenes and results go to other processes and to scene files, and come back the same."""

import copy
import pickle
import tomllib
from pathlib import Path

import numpy as np
import pytest

import ancf

STEEL = ancf.Material(E=2.1e11, nu=0.3)
EVERYTHING = """
title = "Two bodies"
[material.steel]
E = 2.1e11
nu = 0.3
density = 7800.0
viscosity = 1e-6
[material.foil]
E = 7e10
nu = 0.33
density = 2700.0
[body.strip]
shape = "rectangle"
size = [1.0, 0.2]
divisions = [2, 1]
thickness = 0.01
material = "steel"
element = "thin48"
curvature = "koiter"
[body.shell]
shape = "cylinder"
radius = 2.0
angle = [0.0, 0.5]
length = [0.0, 1.0]
divisions = [2, 2]
thickness = 0.01
material = "foil"
membrane = "full"
[[support]]
body = "strip"
at = "edge:x0"
clamp = true
[[support]]
body = "shell"
at = "corner:x0y0"
fix = ["r", "r_x.z"]
rotation = { axis = [0.0, 0.0, 1.0], angle = [[0.0, 0.0], [1.0, 0.5]] }
[[load]]
kind = "gravity"
acceleration = [0.0, 0.0, -9.81]
history = [[0.0, 0.0], [1.0, 1.0]]
[[load]]
kind = "pressure"
body = "shell"
pressure = 10.0
[[probe]]
name = "tip"
body = "strip"
at = [1.0, 0.2]
quantity = "velocity"
[run]
kind = "dynamic"
until = 0.01
step = 0.005
method = "generalized_alpha"
rho_inf = 0.5
outputs = [0.005, 0.01]
"""


@pytest.fixture
def scene() -> ancf.Scene:
    return ancf.Scene.of(tomllib.loads(EVERYTHING))


def test_a_scene_is_written_in_the_words_in_which_it_was_read(scene: ancf.Scene, tmp_path: Path) -> None:
    path = tmp_path / "written.toml"
    scene.write(path)
    assert tomllib.loads(path.read_text(encoding="utf-8")) == tomllib.loads(EVERYTHING)
    assert ancf.load_scene(path) == scene


def test_materials_made_in_python_are_called_like_their_bodies(pendulum: ancf.Model) -> None:
    document = ancf.Scene("", pendulum, ancf.Dynamic(until=1.0, step=0.1)).document()
    assert document["body"]["plate"]["material"] == "plate"
    assert document["material"]["plate"]["E"] == 1e5


def test_a_surface_cannot_be_written(rubber: ancf.Material) -> None:
    sheet = ancf.Surface(
        domain=((0, 1), (0, 1)),
        position=lambda x, y: (x, y, 0.0),
        divisions=(1, 1),
        thickness=0.1,
        material=rubber,
    )
    scene = ancf.Scene("", ancf.Model(bodies={"sheet": sheet}), ancf.Dynamic(until=1.0, step=0.1))
    with pytest.raises(ancf.InputError, match=r"^body\.sheet\.position: a scene file cannot hold a function"):
        scene.document()


def test_copies_of_models_and_results_are_whole(scene: ancf.Scene) -> None:
    result = pickle.loads(pickle.dumps(scene)).solve()
    again = pickle.loads(pickle.dumps(result))
    assert again.model == scene.model
    assert again.run == scene.run
    np.testing.assert_array_equal(again.q, scene.solve().q)
    np.testing.assert_array_equal(
        again.evaluate("strip", [(0.5, 0.1)], "position"), result.positions("strip", [(0.5, 0.1)])
    )
    assert copy.deepcopy(scene.model).dofs == scene.model.dofs


def test_the_bodies_of_a_model_cannot_be_exchanged(pendulum: ancf.Model) -> None:
    with pytest.raises(TypeError, match="does not support item assignment"):
        pendulum.bodies["other"] = pendulum.bodies["plate"]  # type: ignore[index]


def test_errors_with_results_go_to_other_processes(pendulum: ancf.Model) -> None:
    with pytest.raises(ancf.SolveError) as caught:
        ancf.simulate(pendulum, until=0.3, step=0.1, max_iterations=1)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)
    np.testing.assert_array_equal(again.result.q, caught.value.result.q)


def test_a_name_is_that_of_one_material() -> None:
    foil = ancf.Material(E=7e10, nu=0.33)
    plates = {
        name: ancf.Rectangle(size=(1.0, 1.0), divisions=(1, 1), thickness=0.1, material=material)
        for name, material in (("a", STEEL), ("b", foil))
    }
    model = ancf.Model(bodies=plates)
    with pytest.raises(ancf.InputError, match=r'material_names\.b = "metal": is the name of another material'):
        ancf.Scene("", model, ancf.Modes(), {"a": "metal", "b": "metal"})
    with pytest.raises(ancf.InputError, match=r'material_names\.b = "b": is the name of another material'):
        ancf.Scene("", model, ancf.Modes(), {"a": "b"})
    with pytest.raises(ancf.InputError, match=r'material_names = "c": allowed are a, b'):
        ancf.Scene("", model, ancf.Modes(), {"c": "metal"})


def test_a_scene_is_itself_again(tmp_path: Path) -> None:
    plate = ancf.Rectangle(size=(1.0, 1.0), divisions=(1, 1), thickness=0.1, material=STEEL)
    wall = ancf.Support(at="edge:x0", clamp=True)
    scene = ancf.Scene("Plate", ancf.Model(bodies={"plate": plate}, supports=[wall]), ancf.Static())
    scene.write(tmp_path / "scene.toml")
    assert ancf.load_scene(tmp_path / "scene.toml") == scene
