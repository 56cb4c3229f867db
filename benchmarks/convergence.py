"""Print and draw how every element converges with the mesh: the tables and pictures of docs/elements.

Run it from any folder: ``python benchmarks/convergence.py`` prints the tables of all elements, ``--write`` puts them
and the pictures into docs/elements. It takes some seconds.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from matplotlib.figure import Figure
from page import DOCS, put

import ancf
from ancf.bodies import NODAL_VECTORS

Element = Literal["thin36", "thin48", "full48a", "full48b"]
Membrane = Literal["projected", "full", "lobatto"]


MEMBRANES: dict[Element, tuple[Membrane | None, ...]] = {
    "thin36": ("projected", "full", "lobatto"),
    "thin48": ("projected", "full"),
    "full48a": (None,),
    "full48b": (None,),
}
"""The membrane variants of each element; a solid has none."""


Solve = Callable[[Element, Membrane | None, tuple[int, int]], float]


@dataclass(frozen=True)
class Case:
    """A problem with a known answer.

    Attributes
    ----------
    name : str
    known : callable
        Returns the answer.
    meshes : tuple of pairs of int
        Elements along both sides, each mesh twice as fine as the one before.
    solve : callable
        Returns what an element with a membrane variant gives on a mesh.
    """

    name: str
    known: Callable[[], float]
    meshes: tuple[tuple[int, int], ...]
    solve: Solve

    def errors(self, element: Element, membrane: Membrane | None) -> list[float]:
        """Relative error on each mesh."""
        return [abs(self.solve(element, membrane, mesh) / self.known() - 1) for mesh in self.meshes]


def strip(direction: Literal["y", "z"], load: float) -> Solve:
    """Tip deflection W / L of a clamped strip under a dead end shear of P L^2 / (E I), L = 10 b = 500 h, nu 0."""
    L, b, h, E = 10.0, 1.0, 0.02, 1.2e6
    axis = "xyz".index(direction)
    stiffness = E * {"y": b**3 * h, "z": b * h**3}[direction] / 12
    shear = [load * stiffness / L**2 / b if i == axis else 0.0 for i in range(3)]

    @cache
    def deflection(element: Element, membrane: Membrane | None, divisions: tuple[int, int]) -> float:
        body = ancf.Rectangle(
            size=(L, b),
            divisions=divisions,
            thickness=h,
            material=ancf.Material(E=E, nu=0.0),
            element=element,
            membrane=membrane,
        )
        model = ancf.Model(
            bodies={"strip": body},
            supports=[ancf.Support(at="edge:x0", clamp=True)],
            loads=[ancf.LineLoad(at="edge:x1", per_length=(shear[0], shear[1], shear[2]))],
            probes=[ancf.Probe(name="tip", at=(L, b / 2), quantity="displacement")],
        )
        return float(ancf.solve_static(model, tolerance=1e-10).probes["tip"].value[-1, axis]) / L

    return deflection


@cache
def cantilever(element: Element, membrane: Membrane | None, divisions: tuple[int, int]) -> float:
    """Corner deflection, m, of a steel plate of 0.5 x 0.15 x 0.001 m under 30 N; Dufva and Shabana (2005)."""
    plate = ancf.Rectangle(
        size=(0.5, 0.15),
        divisions=divisions,
        thickness=1e-3,
        material=ancf.Material(E=2.07e11, nu=0.3),
        element=element,
        membrane=membrane,
    )
    model = ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
        probes=[ancf.Probe(name="corner", at=(0.5, 0.15))],
    )
    # One giant step of a locking element lands on another equilibrium.
    result = ancf.solve_static(model, load_factors=np.linspace(0.1, 1.0, 10).tolist())
    return float(result.probes["corner"].value[-1, 2])


def square(*, clamped: bool, mode: int) -> Solve:
    """Flexural frequency omega a^2 sqrt(rho h / D) of a square plate, a / h = 1000, nu 0.3, after its rigid motions."""

    def frequency(element: Element, membrane: Membrane | None, divisions: tuple[int, int]) -> float:
        h, nu = 1e-3, 0.3
        # D = rho h = 1.
        material = ancf.Material(E=12 * (1 - nu**2) / h**3, nu=nu, density=1 / h)
        plate = ancf.Rectangle(
            size=(1.0, 1.0), divisions=divisions, thickness=h, material=material, element=element, membrane=membrane
        )
        # Motions in the plane are separate at rest, and not wanted.
        vectors = NODAL_VECTORS[element]
        plane = [f"{vector}.{axis}" for vector in vectors for axis in ("z" if vector == "r_z" else "xy")]
        supports = [ancf.Support(at="all", fix=plane)]
        if clamped:
            supports.append(ancf.Support(at="edge:x0", clamp=True))
        model = ancf.Model(bodies={"plate": plate}, supports=supports)
        last = mode if clamped else 3 + mode
        return float(2 * np.pi * ancf.modes(model, count=last).frequency[-1])

    return frequency


STRIPS = ((2, 1), (4, 1), (8, 1), (16, 1))
PLATES = ((2, 2), (4, 4), (8, 8), (16, 16))
HALVED = ((2, 1), (4, 2), (8, 4), (16, 8))

CASES = (
    # Exact for the inextensible elastica.
    Case("strip under end shear", lambda: 0.669964, STRIPS, strip("z", 4.0)),
    # Timoshenko's beam, P L^3 / (3 E I) + 6 P L / (5 G A) with G = E / 2.
    Case("strip bent in its plane", lambda: 3e-5 * (1 / 3 + 0.2 * 0.1**2), STRIPS, strip("y", 3e-5)),
    Case("steel cantilever", lambda: cantilever("thin48", "projected", (32, 16)), HALVED, cantilever),
    # Schwab, Gerstmayr and Meijaard, DETC2007-34754.
    Case("free square, mode 1", lambda: 13.46820, PLATES, square(clamped=False, mode=1)),
    # Rayleigh and Ritz with 22 x 22 products of Legendre polynomials.
    Case("square clamped at one edge, mode 3", lambda: 21.2841, PLATES, square(clamped=True, mode=3)),
)


def table(element: Element) -> Iterator[str]:
    """Lines of the table of an element: relative errors, and the rate between the two finest meshes."""
    counts = [f"{nx}" for nx, _ in STRIPS]
    yield f"| problem | membrane | {' | '.join(f'{count} elements' for count in counts)} | rate |"
    yield "|---" * (len(counts) + 3) + "|"
    for case in CASES:
        for membrane in MEMBRANES[element]:
            errors = case.errors(element, membrane)
            rate = np.log2(errors[-2] / errors[-1])
            numbers = " | ".join(f"{error:.1e}" for error in errors)
            yield f"| {case.name} | {membrane or 'none'} | {numbers} | {rate:.1f} |"


def finest() -> Iterator[str]:
    """Lines of the table of all elements: relative errors on the finest meshes."""
    yield f"| element | membrane | {' | '.join(case.name for case in CASES)} |"
    yield "|---" * (len(CASES) + 2) + "|"
    for element, membranes in MEMBRANES.items():
        for membrane in membranes:
            errors = " | ".join(f"{case.errors(element, membrane)[-1]:.1e}" for case in CASES)
            yield f"| `{element}` | {membrane or 'none'} | {errors} |"


def draw(element: Element) -> Figure:
    """Draw errors over the number of elements along x, a panel a problem, beside lines of the orders 2 and 4."""
    figure = Figure(figsize=(13, 6.5), layout="constrained")
    *panels, last = figure.subplots(2, 3).flat
    last.axis("off")
    for axes, case in zip(panels, CASES, strict=True):
        counts = np.array([nx for nx, _ in case.meshes])
        for membrane in MEMBRANES[element]:
            axes.loglog(counts, case.errors(element, membrane), "o-", label=membrane or element)
        top = max(case.errors(element, membrane)[0] for membrane in MEMBRANES[element])
        for order, style in ((2, "--"), (4, ":")):
            axes.loglog(counts, top * (counts[0] / counts) ** order, style, color="0.7", label=f"order {order}")
        axes.set(title=case.name, xlabel="elements along x", ylabel="relative error", xticks=counts, ylim=(1e-6, 50))
        axes.set_xticks(counts, labels=[str(count) for count in counts])
        axes.minorticks_off()
        axes.legend(fontsize="small")
    figure.suptitle(element)
    return figure


def main() -> None:
    """Print the tables of all elements, or write them and the pictures into the pages."""
    parser = argparse.ArgumentParser(description="how every element converges with the mesh")
    parser.add_argument("--write", action="store_true", help="into docs/elements")
    arguments = parser.parse_args()
    for element in MEMBRANES:
        if arguments.write:
            put(f"elements/{element}.md", "convergence", table(element))
            draw(element).savefig(DOCS / "images" / f"convergence-{element}.png", dpi=100)
        else:
            print(f"{element}\n", *table(element), "", sep="\n")
    if arguments.write:
        put("elements/README.md", "finest", finest())
    else:
        print(*finest(), sep="\n")


if __name__ == "__main__":
    main()
