"""Print two shells of docs/shells.md beside the thin corotational shell of Kratos, an independent code.

Run it from any folder with ``python benchmarks/kratos_shells.py``, ``--write`` puts the tables into the page; it takes
a quarter of an hour. Kratos comes from the package index: ``pip install KratosMultiphysics==10.4.4
KratosStructuralMechanicsApplication==10.4.4 KratosLinearSolversApplication==10.4.4``. It has a scene's geometry,
material, load and supports, in load steps that are set by hand.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from page import print_or_write
from paths import HALF, LAWS
from shells import SCENES, SZE, solve

import ancf

ELEMENT = "ShellThinElementCorotational3D4N"
SUPPORTS = {
    "clamp": ("DX", "DY", "DZ", "RX", "RY", "RZ"),
    "x": ("DX", "RY", "RZ"),
    "y": ("DY", "RX", "RZ"),
    "z": ("DZ", "RX", "RY"),
    "diaphragm": ("DX", "DY", "RZ"),
}
"""Degrees of freedom of Kratos that a support of a scene holds: clamped, symmetric to a plane, keeping the circle."""


@dataclass(frozen=True)
class Case:
    """A cylinder of ``examples/shells``, the load factors that are compared, and the load steps to each of them."""

    scene: str
    edges: dict[str, str]
    loaded: str
    factors: Sequence[float]
    steps: int


HALF_CYLINDER = Case("pinched_half_cylinder", {"y0": "clamp", "x0": "y", "x1": "x"}, "x1y1", [*HALF, 1.0], steps=2)
DIAPHRAGMS = Case(
    "pinched_cylinder",
    {"x0": "y", "x1": "x", "y0": "z", "y1": "diaphragm"},
    "x1y0",
    [0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.75, 1.0],
    steps=6,
)


def kratos(case: Case, divisions: tuple[int, int]) -> list[list[float]]:
    """Return the displacements of the probes that ``SZE`` names, at each load factor."""
    K, application, factory = (
        import_module(f"KratosMultiphysics{name}")
        for name in ("", ".StructuralMechanicsApplication", ".python_linear_solver_factory")
    )
    K.Logger.GetDefaultOutput().SetSeverity(K.Logger.Severity.WARNING)
    scene = tomllib.loads((SCENES / f"{case.scene}.toml").read_text(encoding="utf-8"))
    shell, material, (load,) = scene["body"]["shell"], scene["material"]["shell"], scene["load"]
    model = K.Model()
    part = model.CreateModelPart("shell")
    part.SetBufferSize(2)
    part.ProcessInfo[K.DOMAIN_SIZE] = 3
    held = (K.DISPLACEMENT, K.ROTATION, K.REACTION, K.REACTION_MOMENT, K.VOLUME_ACCELERATION, application.POINT_LOAD)
    for variable in held:
        part.AddNodalSolutionStepVariable(variable)
    section = part.CreateNewProperties(1)
    section.SetValue(K.THICKNESS, float(shell["thickness"]))
    section.SetValue(K.YOUNG_MODULUS, float(material["E"]))
    section.SetValue(K.POISSON_RATIO, float(material["nu"]))
    section.SetValue(K.CONSTITUTIVE_LAW, K.KratosGlobals.GetConstitutiveLaw("LinearElasticPlaneStress2DLaw").Clone())

    (nx, ny), angle, length = divisions, shell["angle"], shell["length"]
    along, across = np.linspace(angle[0], angle[1], nx + 1), np.linspace(length[0], length[1], ny + 1)
    node = np.arange(1, along.size * across.size + 1).reshape(along.size, across.size)
    for (i, j), number in np.ndenumerate(node):
        x, y = float(shell["radius"]) * np.array((np.cos(along[i]), np.sin(along[i])))
        part.CreateNewNode(int(number), x, y, across[j])
    corners = np.stack((node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]), axis=-1).reshape(-1, 4)
    for name, nodes in enumerate(corners.tolist(), start=1):
        part.CreateNewElement(ELEMENT, name, nodes, section)
    freedoms = {}
    for axis in "XYZ":
        for short, variable, reaction in (("D", "DISPLACEMENT", "REACTION"), ("R", "ROTATION", "REACTION_MOMENT")):
            freedoms[short + axis] = getattr(K, f"{variable}_{axis}")
            K.VariableUtils().AddDof(freedoms[short + axis], getattr(K, f"{reaction}_{axis}"), part)
    ends = {"x0": node[0], "x1": node[-1], "y0": node[:, 0], "y1": node[:, -1]}
    for edge, support in case.edges.items():
        for name in ends[edge].tolist():
            for freedom in SUPPORTS[support]:
                part.GetNode(name).Fix(freedoms[freedom])

    def at(corner: str) -> int:
        return int(np.intersect1d(ends[corner[:2]], ends[corner[2:]])[0])

    force = part.CreateNewCondition("PointLoadCondition3D1N", 1, [at(case.loaded)], section)
    solver = factory.ConstructSolver(K.Parameters('{"solver_type": "LinearSolversApplication.sparse_lu"}'))
    newton = K.ResidualBasedNewtonRaphsonStrategy(
        part,
        K.ResidualBasedIncrementalUpdateStaticScheme(),
        K.ResidualCriteria(1e-6, 1e-6),
        K.ResidualBasedBlockBuilderAndSolver(solver),
        60,
        False,
        False,
        True,
    )
    newton.SetEchoLevel(0)
    newton.Initialize()
    places = {"x0": 0, "y0": 0, "x1": -1, "y1": -1}
    probed = []
    for published in (published for published in SZE if published.scene == case.scene):
        (place,) = (probe["at"] for probe in scene["probe"] if probe["name"] == published.probe)
        corner = next(
            x + y
            for x in ("x0", "x1")
            for y in ("y0", "y1")
            if np.allclose(place, [along[places[x]], across[places[y]]])
        )
        probed.append((at(corner), freedoms["D" + "XYZ"[published.component]]))
    found, last, step = [], 0.0, 0
    for factor in case.factors:
        for share in np.linspace(last, factor, case.steps + 1)[1:]:
            step += 1
            part.CloneTimeStep(float(step))
            part.ProcessInfo[K.STEP] = step
            force.SetValue(application.POINT_LOAD, K.Array3([float(share * f) for f in load["force"]]))
            newton.InitializeSolutionStep()
            newton.Predict()
            converged = newton.SolveSolutionStep()
            newton.FinalizeSolutionStep()
        found.append([part.GetNode(name).GetSolutionStepValue(what) if converged else np.nan for name, what in probed])
        last = factor
    return found


def ours(case: Case, **changes: Any) -> list[list[float]]:
    """Return the same of ours, with changes in the body."""
    document = tomllib.loads((SCENES / f"{case.scene}.toml").read_text(encoding="utf-8"))
    document["body"]["shell"] |= changes
    document["run"]["load_factors"] = list(case.factors)
    result = solve(ancf.Scene.of(document))
    rows = np.searchsorted(result.t, case.factors)
    columns = [result.probes[one.probe].value[rows, one.component] for one in SZE if one.scene == case.scene]
    return [list(row) for row in np.transpose(columns)]


def half_cylinder() -> Iterator[str]:
    """Lines of differences from the published path."""
    case = HALF_CYLINDER
    published = np.array(
        [*(value for (value,) in HALF.values()), *(one.published for one in SZE if one.scene == case.scene)]
    )
    columns: dict[str, Callable[[], list[list[float]]]] = {
        "Kratos, 32 x 32": lambda: kratos(case, (32, 32)),
        "Kratos, 48 x 48": lambda: kratos(case, (48, 48)),
        "ours, koiter, `thin48` 32 x 32": lambda: ours(case, **LAWS[1], element="thin48"),
    }
    found = [np.array(column())[:, 0] / published - 1 for column in columns.values()]
    yield f"| load | {' | '.join(columns)} |"
    yield f"|---|{'---|' * len(columns)}"
    for factor, row in zip(case.factors, np.transpose(found), strict=True):
        yield f"| {factor:g} | {' | '.join(f'{difference:+.2%}' for difference in row)} |"


def diaphragms() -> Iterator[str]:
    """Lines of displacements at full load."""
    case = DIAPHRAGMS
    published = np.array([one.published for one in SZE if one.scene == case.scene])
    yield "| code | mesh | A, y | B, x |"
    yield "|---|---|---|---|"
    for name, found in (("Kratos", kratos(case, (40, 40))), ("ours, koiter", ours(case, **LAWS[1]))):
        cells = (f"{difference:+.2%}" for difference in found[-1] / published - 1)
        yield f"| {name} | 40 x 40 | {' | '.join(cells)} |"


if __name__ == "__main__":
    print_or_write(
        "two shells beside another code", "shells.md", kratos_half=half_cylinder(), kratos_diaphragms=diaphragms()
    )
