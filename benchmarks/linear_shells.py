"""Print how shells of linear theory converge to their published displacements: the table of docs/linear-shells.md.

Run it from any folder: ``python benchmarks/linear_shells.py`` prints the table, ``--write`` puts it into the page. It
takes some seconds.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from page import print_or_write

import ancf

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "examples" / "linear_shells"

FloatArray = NDArray[np.float64]
Mesh = tuple[int, int]


class Variant(NamedTuple):
    """What a shell is made of."""

    element: Literal["thin36", "thin48", "full48a"]
    membrane: Literal["projected", "full"] | None
    curvature: Literal["paper", "koiter"] | None


VARIANTS = (
    Variant("thin36", "projected", "paper"),
    Variant("thin36", "full", "paper"),
    Variant("thin48", "projected", "paper"),
    Variant("thin48", "projected", "koiter"),
    Variant("full48a", None, None),
)


@dataclass(frozen=True)
class Case:
    """A shell with a published displacement.

    Attributes
    ----------
    name : str
    published : float
        A component of the displacement of the probe A.
    component : int
        Which.
    factor : float
        Load factor, so small that the answer is the linear one.
    meshes : tuple of pairs of int
        Elements along both sides.
    model : callable
        Makes the model.
    """

    name: str
    published: float
    component: int
    factor: float
    meshes: tuple[Mesh, ...]
    model: Callable[[Variant, Mesh], ancf.Model]

    def displacement(self, variant: Variant, mesh: Mesh) -> float:
        """Return the displacement per load factor."""
        result = ancf.solve_static(self.model(variant, mesh), load_factors=[self.factor], tolerance=1e-10)
        return float(result.probes["A"].value[-1, self.component]) / self.factor


def scene(name: str) -> Callable[[Variant, Mesh], ancf.Model]:
    """Take a model from its scene file."""

    def make(variant: Variant, mesh: Mesh) -> ancf.Model:
        document = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
        given = {key: value for key, value in variant._asdict().items() if value is not None}
        document["body"]["shell"] |= given | {"divisions": mesh}
        return ancf.Scene.of(document).model

    return make


def surface(
    domain: tuple[tuple[float, float], tuple[float, float]],
    position: Callable[..., Any],
    material: ancf.Material,
    thickness: float,
    load: ancf.LineLoad | ancf.Gravity,
) -> Callable[[Variant, Mesh], ancf.Model]:
    """Make a shell from a map, clamped at edge:x0, with the probe in the middle of edge:x1."""

    def make(variant: Variant, mesh: Mesh) -> ancf.Model:
        shell = ancf.Surface(
            domain=domain,
            position=position,
            divisions=mesh,
            thickness=thickness,
            material=material,
            element=variant.element,
            membrane=variant.membrane,
            curvature=variant.curvature,
        )
        return ancf.Model(
            bodies={"shell": shell},
            supports=[ancf.Support(at="edge:x0", clamp=True)],
            loads=[load],
            probes=[ancf.Probe(name="A", at=(domain[0][1], sum(domain[1]) / 2), quantity="displacement")],
        )

    return make


def twisted_beam(thickness: float, force: tuple[float, float, float]) -> Callable[[Variant, Mesh], ancf.Model]:
    """Make a strip of 12 x 1.1 twisted by 90 degrees, under a force at its end, where its width is along Y."""
    length, width = 12.0, 1.1
    turn = np.pi / 2 / length
    return surface(
        ((0.0, length), (-width / 2, width / 2)),
        lambda x, y: (y * np.cos(turn * x), y * np.sin(turn * x), x),
        ancf.Material(E=29e6, nu=0.22),
        thickness,
        ancf.LineLoad(at="edge:x1", per_length=(force[0] / width, force[1] / width, force[2] / width)),
    )


def saddle(thickness: float) -> Callable[[Variant, Mesh], ancf.Model]:
    """Make the surface z = x^2 - y^2 over a unit square, under its weight of 8000 per volume."""
    return surface(
        ((-0.5, 0.5), (-0.5, 0.5)),
        lambda x, y: (x, y, x * x - y * y),
        ancf.Material(E=2e11, nu=0.3, density=8000.0),
        thickness,
        ancf.Gravity(acceleration=(0.0, 0.0, -1.0)),
    )


def hook() -> Callable[[Variant, Mesh], ancf.Model]:
    """Join two arcs that bend to opposite sides, 60 degrees of radius 14 and 150 degrees of radius 46, in one map."""
    small, large, bend = 14.0, 46.0, np.pi / 3
    first = small * bend

    def position(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        a = np.minimum(x, first) / small
        b = bend - np.maximum(x - first, 0.0) / large
        along = small * (1 - np.cos(a)) + large * (np.cos(b) - np.cos(bend))
        up = small * np.sin(a) + large * (np.sin(bend) - np.sin(b))
        return along, y, up

    return surface(
        ((0.0, first + large * 5 * np.pi / 6), (0.0, 20.0)),
        position,
        ancf.Material(E=3300.0, nu=0.35),
        2.0,
        ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.05, 0.0)),
    )


SQUARES = ((8, 8), (16, 16), (32, 32))
STRIPS = ((12, 2), (24, 4), (48, 8))
HOOKS = ((9, 1), (18, 2), (36, 4))

CASES = (
    Case("Scordelis-Lo roof", -0.3024, 1, 1e-3, SQUARES, scene("scordelis_lo_roof")),
    Case("pinched cylinder", -1.8248e-5, 1, 1.0, SQUARES, scene("pinched_cylinder")),
    Case("hemisphere with a hole", 0.094, 0, 1e-2, SQUARES, scene("pinched_hemisphere_hole")),
    Case("hemisphere", 0.0924, 0, 1e-2, SQUARES, scene("pinched_hemisphere")),
    Case("twisted beam, in the plane", 5.424e-3, 1, 1.0, STRIPS, twisted_beam(0.32, (0, 1, 0))),
    Case("twisted beam, out of it", 1.754e-3, 0, 1.0, STRIPS, twisted_beam(0.32, (1, 0, 0))),
    Case("thin twisted beam, in the plane", 5.256e-3, 1, 1.0, STRIPS, twisted_beam(0.0032, (0, 1e-6, 0))),
    Case("thin twisted beam, out of it", 1.294e-3, 0, 1.0, STRIPS, twisted_beam(0.0032, (1e-6, 0, 0))),
    Case("saddle, 1/1000", -6.3905e-3, 2, 1e-2, SQUARES, saddle(1e-3)),
    Case("saddle, 1/10000", -0.52988, 2, 1e-3, SQUARES, saddle(1e-4)),
    Case("Raasch's hook", 4.936, 1, 1e-3, HOOKS, hook()),
)


def table() -> Iterator[str]:
    """Lines of the table: differences from what is published."""
    yield "| shell | published | element | membrane | curvature | coarse | middle | fine |"
    yield "|---|---|---|---|---|---|---|---|"
    for case in CASES:
        for variant in VARIANTS:
            found = [case.displacement(variant, mesh) / case.published - 1 for mesh in case.meshes]
            cells = [
                case.name,
                f"{abs(case.published):.5g}",
                f"`{variant.element}`",
                variant.membrane or "-",
                variant.curvature or "-",
                *(f"{difference:+.2%}" for difference in found),
            ]
            yield f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    print_or_write("shells of linear theory against their published displacements", "linear-shells.md", linear=table())
