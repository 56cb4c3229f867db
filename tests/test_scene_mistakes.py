"""Every kind of mistake in a scene file: exit status 2, its key path in the message, nothing written."""

from collections.abc import Callable
from pathlib import Path

import pytest

from ancf.cli import main

Edit = Callable[..., Path]

PENDULUM = [
    ("thickness = 0.01", "thicknes = 0.01", "body.plate.thicknes = 0.01: unknown key;", "did you mean thickness?"),
    ("thickness = 0.01", "thicknes = 0.01", "body.plate.thickness: is missing", ""),
    ("thickness = 0.01", "thickness = -0.01", "body.plate.thickness = -0.01: must be greater than 0", ""),
    ("thickness = 0.01", 'thickness = "thin"', 'body.plate.thickness = "thin": must be a number', ""),
    ("thickness = 0.01", "thickness = true", "body.plate.thickness = true: must be a number", ""),
    ("thickness = 0.01", "thickness = nan", "body.plate.thickness = nan: must be a finite number", ""),
    ("thickness = 0.01", "thickness = inf", "body.plate.thickness = inf: must be a finite number", ""),
    ("nu = 0.3", "nu = 0.5", "material.rubber.nu = 0.5: must be less than 0.5", ""),
    ("nu = 0.3", "nu = -1", "material.rubber.nu = -1: must be greater than -1", ""),
    ("density = 7810", "density = 0", "material.rubber.density = 0.0: must be greater than 0 in motion", ""),
    ("E = 1e5", "E = 0", "material.rubber.E = 0: must be greater than 0", ""),
    ("E = 1e5", "E = 1e-300", "material.rubber.E = 1e-300: must be from 1e-30 to 1e+30", ""),
    ("[2, 2]", "[0, 2]", "body.plate.divisions.0 = 0: must be greater than 0", ""),
    ("[2, 2]", "[2.5, 2]", "body.plate.divisions.0 = 2.5: must be a whole number", ""),
    ("[2, 2]", "[2]", "body.plate.divisions = [2]: must be a list of 2 numbers", ""),
    ('"rubber"', '"ruber"', 'body.plate.material = "ruber": allowed is rubber', ""),
    ("E = 1e5\nnu = 0.3\ndensity = 7810", "", "material.rubber.E: is missing", "material.rubber.nu: is missing"),
    ("[body.plate]", "[body]\nwing = 3\n[body.plate]", "body.wing = 3: must be a table (in Python: Rectangle or", ""),
    ('name = "A"', 'name = ""', 'probe.0.name = "": must have at least 1 character', ""),
    ('"rectangle"', '"cube"', 'body.plate.shape = "cube": allowed are rectangle, annulus, cylinder, sphere', ""),
    ('"rectangle"', '"surface"', 'body.plate.shape = "surface": allowed are rectangle, annulus', ""),
    ('shape = "rectangle"', "", "body.plate.shape: is missing; allowed are rectangle, annulus, cylinder, sphere", ""),
    ('"rectangle"\nsize = [0.3, 0.3]', '"annulus"\nradii = [2, 1]\nangle = 1', "body.plate.radii = [2, 1]:", ""),
    ('"rectangle"\nsize = [0.3, 0.3]', '"annulus"\nradii = [1, 2]\nangle = 7', "body.plate.angle = 7:", "2 pi"),
    ('"thin36"', '"thin"', 'body.plate.element = "thin": allowed are thin36, thin48, full48a, full48b', ""),
    ('"thin36"', '"full48a"', 'body.plate.membrane = "full": allowed is none: full48a has the strain of a solid', ""),
    ('"thin36"\nmembrane = "full"', '"thin48"\nmembrane = "lobatto"', 'body.plate.membrane = "lobatto":', "nine"),
    ('"full"', '"reduced"', 'body.plate.membrane = "reduced": allowed are projected, full, lobatto', ""),
    ('"corner:x0y0"', '"corner:x0"', 'support.0.at = "corner:x0": allowed are corner:x0y0, corner:x1y0,', ""),
    ('"corner:x0y0"', "[0.4, 0]", "support.0.at = [0.4, 0.0]:", "0.3"),
    ('["r"]', '["r_z"]', 'support.0.fix.0 = "r_z": allowed are r, r_x, r_y and their components, as r.x', ""),
    ('["r"]', '"r"', 'support.0.fix = "r": must be a list', ""),
    ('fix = ["r"]', "", "support.0.fix: give either the coordinates to fix, clamp = true, or symmetry", ""),
    ('body = "plate"\nat = "c', 'body = "plat"\nat = "c', 'support.0.body = "plat": allowed is plate', ""),
    ('"gravity"', '"gravitty"', 'load.0.kind = "gravitty": allowed are gravity, force, line, pressure, moment', ""),
    ("[0, 0, -9.81]", "[0, -9.81]", "load.0.acceleration = [0, -9.81]: must be a list of 3 numbers", ""),
    ("[0, 0, -9.81]", "[0, 0, nan]", "load.0.acceleration.2 = nan: must be a finite number", ""),
    ("-9.81]", '-9.81]\nhistory = "ramp"', 'load.0.history = "ramp": is for statics', ""),
    ("-9.81]", "-9.81]\nhistory = [[1, 0], [0, 1]]", "load.0.history = [[1, 0], [0, 1]]: the t of", "must increase"),
    ("at = [0.3, 0.3]", "at = [0.3, 0.4]", "probe.0.at = [0.3, 0.4]:", "0.3"),
    ('"position"', '"colour"', 'probe.0.quantity = "colour": allowed are position, displacement,', ""),
    (
        'kind = "dynamic"',
        'kind = "mode"',
        'run.kind = "mode": allowed are static, dynamic, modes; did you mean modes?',
        "",
    ),
    ('"hht"', '"euler"', 'run.method = "euler": allowed are hht, generalized_alpha, newmark, tr_bdf2, esdirk', ""),
    ("step = 5e-3", "", "run.step: give either step, for fixed steps, or rtol, for error control", ""),
    ("step = 5e-3", "step = 5e-3\nrtol = 1e-4", "run.step = 0.005: give either step", ""),
    ("step = 5e-3", "step = 5e-3\natol = 1e-4", "run.atol = 0.0001: is for error control", ""),
    ("step = 5e-3", "rtol = 1e-15", "run.rtol = 1e-15: must be greater than or equal to", ""),
    ('fix = ["r"]', 'fix = ["r"]\ntranslation = [[0, 0, 0, 1], [1, 0, 0, 2]]', "support.0.translation", "0 at time 0"),
    ('fix = ["r"]', 'fix = ["r"]\ntranslation = []', "support.0.translation = []: must be at least two rows", ""),
    (
        'fix = ["r"]',
        'fix = ["r"]\nrotation = { axis = [0, 0, 0], angle = [[0, 0], [1, 1]] }',
        "support.0.rotation.axis = [0, 0, 0]: must have a direction",
        "",
    ),
    (
        'fix = ["r"]',
        'fix = ["r"]\nrotation = { axis = [0, 0, 1], angle = [[1, 0], [0, 1]] }',
        "support.0.rotation.angle = [[1, 0], [0, 1]]: must be at least two rows, their t increasing",
        "",
    ),
    ('"hht"', '"generalized_alpha"', 'run.alpha = -0.05: is for method = "hht" only', ""),
    ("alpha = -0.05", "alpha = 0.1", "run.alpha = 0.1: must be less than or equal to 0", ""),
    ("step = 5e-3", "step = 0", "run.step = 0: must be greater than 0", ""),
    ("step = 5e-3", "step = 5e-3\nevery = 0.01", "run.every = 0.01: give either every or outputs", ""),
    ("[0.025, 0.05]", "[0.05, 0.025]", "run.outputs = [0.05, 0.025]: must increase", ""),
    ("[0.025, 0.05]", "[0.06]", "run.outputs = [0.06]: must increase and lie in [0, 0.05]", ""),
    ("[run]", "[runs]", "run: is missing", "did you mean run?"),
    ("[run]", "[run", "is not TOML", "line"),
]
CANTILEVER = [
    (
        '[[support]]\nat = "edge:x0"\nclamp = true',
        "",
        "support: the body plate can still move: translation along x; in statics supports",
        "rotation about z",
    ),
    ("clamp = true", "clamp = true\nfix = ['r']", "support.0.fix: give either", ""),
    ('at = "edge:x1"', 'at = "corner:x1y0"', 'load.0.at = "corner:x1y0": allowed are edge:x0, edge:x1', ""),
    ("[0.5, 1.0]", "[1.0, 1.0]", "run.load_factors = [1.0, 1.0]: each must differ from the one before", ""),
    ("[0.5, 1.0]", '[1.0]\npath = "curve"', 'run.path = "curve": allowed are load, arc', ""),
    (
        "[[probe]]",
        '[[load]]\nkind = "gravity"\nacceleration = [0, 0, 1]\n[[probe]]',
        "material.steel.density = 0.0:",
        "",
    ),
]


@pytest.mark.parametrize(
    ("scene", "case"),
    [("pendulum.toml", case) for case in PENDULUM] + [("cantilever.toml", case) for case in CANTILEVER],
)
def test_a_mistake_is_named_and_nothing_is_written(
    edit: Edit, tmp_path: Path, capsys: pytest.CaptureFixture[str], scene: str, case: tuple[str, str, str, str]
) -> None:
    old, new, message, hint = case
    path = edit(scene, (old, new))
    assert main(["run", str(path), "-o", str(tmp_path / "new" / "out")]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert hint in told
    assert list(tmp_path.iterdir()) == [path]


def test_all_mistakes_are_told(edit: Edit, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = edit(
        "pendulum.toml",
        ("nu = 0.3", "nu = 0.7"),
        ("thickness = 0.01", "thickness = 0"),
        ("step = 5e-3", "steps = 5"),
        ("[0, 0, -9.81]", "9.81"),
    )
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    paths = ("material.rubber.nu", "body.plate.thickness", "load.0.acceleration", "run.steps")
    assert all(key in told for key in paths)
    assert len(told.splitlines()) == len(paths)


def test_a_body_must_be_named_among_several(edit: Edit, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    wing = '[body.wing]\nshape = "rectangle"\nsize = [1, 1]\ndivisions = [1, 1]\nthickness = 1\nmaterial = "steel"\n'
    path = edit("cantilever.toml", ("[[support]]", f"{wing}[[support]]"))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert all(f"{key}.0.body: is missing; allowed are plate, wing" in told for key in ("support", "load", "probe"))


@pytest.mark.parametrize("name", ["missing.toml", "."])
def test_a_missing_file(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / name
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    assert f"{path}: cannot be read" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_not_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xff\xfe\x00")
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    assert "is not TOML" in capsys.readouterr().err
