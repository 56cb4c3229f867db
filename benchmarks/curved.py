"""Print what coarse meshes of doubly curved shells are too soft or too stiff in: tables of docs/elements.

Strips of a sphere, for docs/elements/thin36.md, and a square patch of one, for docs/elements/thin48.md, in linear
theory: energies under a force against `thin48`, `full`, on a fine mesh. Run it from any folder:
``python benchmarks/curved.py`` prints the tables, ``--write`` puts them into the pages. It takes some seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from page import put

import ancf

Mesh: TypeAlias = tuple[int, int]
Element: TypeAlias = Literal["thin36", "thin48"]
Membrane: TypeAlias = Literal["projected", "full"]

FORCE = 10.0
"""Per thickness^3: displacements are below a hundredth of the thickness, so the answer is the linear one."""


@dataclass(frozen=True)
class Piece:
    """A piece of a sphere of the radius 1, clamped at edge:x0, under a force on edge:x1 along the axis X or Y.

    Attributes
    ----------
    length, width : float
        Along the equator and across it.
    thickness : float
    axis : {"x", "y"}
        Of the force.
    fine : pair of int
        The mesh of the reference solution.
    """

    length: float
    width: float
    thickness: float
    axis: Literal["x", "y"]
    fine: Mesh

    def energy(self, element: Element, membrane: Membrane, mesh: Mesh) -> float:
        """Solve for the energy: half the force times the mean displacement of the loaded edge."""
        force = FORCE * self.thickness**3 / self.width
        shell = ancf.Sphere(
            radius=1.0,
            longitude=(0.0, self.length),
            latitude=(-self.width / 2, self.width / 2),
            divisions=mesh,
            thickness=self.thickness,
            material=ancf.Material(E=1e7, nu=0.3),
            element=element,
            membrane=membrane,
        )
        model = ancf.Model(
            bodies={"shell": shell},
            supports=[ancf.Support(at="edge:x0", clamp=True)],
            loads=[
                ancf.LineLoad(at="edge:x1", per_length=(0.0, force, 0.0) if self.axis == "y" else (force, 0.0, 0.0))
            ],
        )
        result = ancf.solve_static(model, load_factors=[1.0], tolerance=1e-10)
        return float(result.energy.membrane[-1] + result.energy.bending[-1])

    def reference(self) -> float:
        """Solve on the fine mesh."""
        return self.energy("thin48", "full", self.fine)


def differences(piece: Piece, reference: float, element: Element, membrane: Membrane, meshes: list[Mesh]) -> str:
    """Cells with the relative differences of some meshes."""
    return " | ".join(f"{piece.energy(element, membrane, mesh) / reference - 1:+.1%}" for mesh in meshes)


def strips() -> Iterator[str]:
    """Lines of the table of strips: a quarter of the equator, bent out of its surface."""
    meshes = [(8, 1), (16, 1), (8, 2), (16, 2), (32, 4)]
    yield f"| width^2 / (R h) | element | membrane | {' | '.join(f'{n} x {m}' for n, m in meshes)} |"
    yield f"|---|---|---|{'---|' * len(meshes)}"
    for width in (0.05, 0.1, 0.2):
        piece = Piece(np.pi / 2, width, 0.002, "y", (64, 8))
        reference = piece.reference()
        for element in ("thin36", "thin48"):
            for membrane in ("projected", "full"):
                cells = differences(piece, reference, element, membrane, meshes)
                yield f"| {width**2 / piece.thickness:.3g} | `{element}` | {membrane} | {cells} |"


def patches() -> Iterator[str]:
    """Lines of the table of patches, 1 x 1, pushed at the end."""
    meshes = [(n, n) for n in (2, 4, 8, 16)]
    yield f"| R / h | element | membrane | {' | '.join(f'{n} x {m}' for n, m in meshes)} |"
    yield f"|---|---|---|{'---|' * len(meshes)}"
    for thickness in (0.01, 0.002):
        piece = Piece(1.0, 1.0, thickness, "x", (40, 40))
        reference = piece.reference()
        for element in ("thin36", "thin48"):
            for membrane in ("projected", "full"):
                cells = differences(piece, reference, element, membrane, meshes)
                yield f"| {1 / thickness:.0f} | `{element}` | {membrane} | {cells} |"


def main() -> None:
    """Print or write both tables."""
    parser = argparse.ArgumentParser(description="coarse meshes of spheres")
    parser.add_argument("--write", action="store_true", help="into docs/elements")
    write = parser.parse_args().write
    for page, mark, lines in (("thin36", "strips", strips()), ("thin48", "patches", patches())):
        if write:
            put(f"elements/{page}.md", mark, lines)
        else:
            print(*lines, "", sep="\n", flush=True)


if __name__ == "__main__":
    main()
