"""Fields on disk, read back by VTK."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ancf
from ancf.cli import main

pyvista: Any = pytest.importorskip("pyvista")


def read(path: Path) -> list[tuple[float, Any]]:
    """Return each time and its grid."""
    reader = pyvista.get_reader(path)
    states = []
    for time in reader.time_values:
        reader.set_active_time_value(time)
        states.append((time, reader.read()[0]))
    return states


def test_fields_are_those_of_evaluate(pendulum: ancf.Model, tmp_path: Path) -> None:
    result = ancf.simulate(pendulum, until=0.02, step=5e-3)
    path = tmp_path / "fields.pvd"
    result.write_fields(path, subdivisions=3)
    states = read(path)
    np.testing.assert_allclose([time for time, _ in states], result.t)
    for state, (_, grid) in enumerate(states):
        points = grid.point_data["natural_coordinates"]
        assert grid.n_cells == 4 * 9
        assert set(grid.celltypes) == {pyvista.CellType.QUAD}
        for quantity in ("displacement", "velocity", "normal", "moment", "shear_force", "stress_top"):
            expected = result.evaluate("plate", points, quantity)[state]
            np.testing.assert_array_equal(grid.point_data[quantity], expected)
        expected = result.evaluate("plate", points, "von_mises_bottom")[state, :, 0]
        np.testing.assert_array_equal(grid.point_data["von_mises_bottom"], expected)
        np.testing.assert_array_equal(grid.points, result.positions("plate", points)[state])
        # Facets are turned as the surface is.
        normals = grid.extract_surface(algorithm="geometry").compute_normals(auto_orient_normals=False)
        assert (np.sum(normals.point_data["Normals"] * grid.point_data["normal"], axis=1) > 0.9).all()


def test_a_curved_shell_has_curved_facets_and_the_stresses_of_its_probes(tmp_path: Path) -> None:
    steel = ancf.Material(E=2e11, nu=0.3)
    shell = ancf.Cylinder(radius=2, angle=(0, 1), length=(0, 1), divisions=(2, 1), thickness=0.01, material=steel)
    at = (0.25, 0.5)
    model = ancf.Model(
        bodies={"shell": shell},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.Pressure(pressure=1e4)],
        probes=[
            ancf.Probe(name="force", at=at, quantity="membrane_force"),
            ancf.Probe(name="moment", at=at, quantity="moment"),
            ancf.Probe(name="top", at=at, quantity="stress_top"),
            ancf.Probe(name="mises", at=at, quantity="von_mises_bottom"),
        ],
    )
    result = ancf.solve_static(model, load_factors=[0.5, 1.0])
    result.write_fields(tmp_path / "fields.pvd", subdivisions=8)
    states = read(tmp_path / "fields.pvd")
    assert [time for time, _ in states] == [0, 0.5, 1]
    rest = states[0][1]
    angle, z = rest.point_data["natural_coordinates"].T
    # A cubic Hermite arc of the angle a is off by R a^4 / 384; 16 flat facets of 1/16 lose a share of (1/16)^2 / 24.
    on_arc = np.stack([2 * np.cos(angle), 2 * np.sin(angle), z], axis=1)
    np.testing.assert_allclose(rest.points, on_arc, atol=2 * 0.5**4 / 384, rtol=0)
    assert rest.compute_cell_sizes()["Area"].sum() == pytest.approx(2, rel=2 / 16**2 / 24)
    for state, (_, grid) in enumerate(states):
        (point,) = np.flatnonzero((np.abs(grid.point_data["natural_coordinates"] - at) < 1e-12).all(axis=1))
        for probe in model.probes:
            found = np.atleast_1d(grid.point_data[probe.quantity][point])
            np.testing.assert_allclose(found, result.probes[probe.name].value[state], rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(states[2][1].points - rest.points, states[2][1].point_data["displacement"], atol=1e-12)


def test_a_second_run_leaves_nothing_of_the_first(pendulum: ancf.Model, tmp_path: Path) -> None:
    path = tmp_path / "fields.pvd"
    ancf.simulate(pendulum, until=0.02, step=5e-3).write_fields(path, subdivisions=1)
    result = ancf.simulate(pendulum, until=0.01, step=5e-3)
    result.write_fields(path, subdivisions=1, quantities=["cauchy_stress_top"])
    assert sorted(file.name for file in (tmp_path / "fields").iterdir()) == [f"0000{i}.vtu" for i in range(3)]
    assert set(read(path)[0][1].point_data.keys()) == {"cauchy_stress_top", "natural_coordinates"}


def test_shapes_of_modes(tmp_path: Path) -> None:
    steel = ancf.Material(E=2e11, nu=0.3, density=7800.0)
    plate = ancf.Rectangle(size=(1, 0.5), divisions=(2, 1), thickness=0.01, material=steel)
    shell = ancf.Cylinder(radius=1, angle=(0, 1), length=(0, 1), divisions=(2, 1), thickness=0.01, material=steel)
    model = ancf.Model(bodies={"plate": plate, "shell": shell})
    found = ancf.modes(model, count=14)
    found.write_fields(tmp_path / "modes.pvd", subdivisions=2)
    states = read(tmp_path / "modes.pvd")
    assert [time for time, _ in states] == list(range(1, 15))
    for mode, (_, grid) in enumerate(states):
        assert grid.field_data["frequency"][0] == found.frequency[mode]
        first = grid.point_data["natural_coordinates"][:15]
        np.testing.assert_array_equal(grid.point_data["shape"][:15], found.displacements("plate", first)[mode])
        assert np.bincount(grid.cell_data["body"]).tolist() == [8, 8]


def test_from_the_command_line(scenes: Path, tmp_path: Path) -> None:
    arguments = ["run", str(scenes / "cantilever.toml"), "-o", str(tmp_path), "--quiet"]
    assert main([*arguments, "--fields", "--plot"]) == 0
    assert [time for time, _ in read(tmp_path / "fields.pvd")] == [0, 0.5, 1]
    assert "velocity" not in read(tmp_path / "fields.pvd")[0][1].point_data
    # Pictures and fields of an earlier run go when its results do.
    assert main(arguments) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["result.npz", "summary.json"]


def test_without_pyvista(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    folder = tmp_path / "out"
    assert main(["run", str(scenes / "cantilever.toml"), "-o", str(folder), "--fields"]) == 2
    assert 'pip install "ancf[fields]"' in capsys.readouterr().err
    assert not folder.exists()


def test_mistakes(pendulum: ancf.Model, tmp_path: Path) -> None:
    result = ancf.simulate(pendulum, until=0.01, step=5e-3)
    with pytest.raises(ancf.InputError, match=r"must end in \.pvd"):
        result.write_fields(tmp_path / "fields.vtu")
    with pytest.raises(ancf.InputError, match="subdivisions = 0"):
        result.write_fields(tmp_path / "fields.pvd", subdivisions=0)
    with pytest.raises(ancf.InputError, match=r"quantities\.0 = \"stress\""):
        result.write_fields(tmp_path / "fields.pvd", quantities=["stress"])  # type: ignore[list-item]
    assert list(tmp_path.iterdir()) == []
