"""Print frequencies of shells and of loaded structures beside closed forms and published ones: docs/modes.md.

Run it from any folder: ``python benchmarks/modes.py`` prints the table, ``--write`` puts it into the page. It takes
some seconds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Literal, TypeAlias

import numpy as np
from page import print_or_write
from scipy.linalg import eigh

import ancf

Element: TypeAlias = Literal["thin36", "thin48"]
Row: TypeAlias = tuple[str, float, float]
"""A mode, its known frequency and the found one, in the unit of its case."""


ROTATING = {
    0: (3.5160, 22.0345, 61.6972),
    2: (4.1373, 22.6149, 62.2732),
    6: (7.3604, 26.8091, 66.6839),
    12: (13.1702, 37.6031, 79.6145),
}
"""Omega T of a uniform cantilever on an axis, T = sqrt(rho A L^4 / E I), over the speed of rotation times T.

A. D. Wright, C. E. Smith, R. W. Thresher, J. L. C. Wang, Vibration modes of centrifugally stiffened beams, J. Appl.
Mech. 49 (1982) 197-202.
"""


def rotating_beam(element: Element) -> Iterator[Row]:
    """Find modes out of the plane of rotation; the centrifugal force stands at three Gauss points along an element."""
    L, b, h, n = 1.0, 0.05, 0.001, 12
    material = ancf.Material(E=2e11, nu=0.0, density=8000.0)
    mass = material.density * b * h
    T = float(np.sqrt(mass * L**4 / (material.E * b * h**3 / 12)))
    body = ancf.Rectangle(size=(L, b), divisions=(n, 1), thickness=h, material=material, element=element)
    places, weights = np.polynomial.legendre.leggauss(3)
    x = ((np.arange(n)[:, None] + (1 + places) / 2) * L / n).ravel()
    share = np.tile(weights / 2 * mass * L / n, n)
    for speed, known in ROTATING.items():
        forces = [
            ancf.Force(at=(place, b * side), force=((speed / T) ** 2 * place * part / 2, 0.0, 0.0))
            for place, part in zip(x.tolist(), share.tolist(), strict=True)
            for side in (0.25, 0.75)
        ]
        model = ancf.Model(
            bodies={"beam": body},
            supports=[
                ancf.Support(at="edge:x0", fix=["r", "r_x.z", *(["r_xy.z"] if element == "thin48" else [])]),
                ancf.Support(at="all", fix=["r.y", "r_x.y", "r_y"]),
            ],
            loads=forces,
        )
        found = ancf.modes(model, count=3, load_factor=1.0)
        for mode, (expected, frequency) in enumerate(zip(known, found.frequency, strict=True), 1):
            yield f"speed {speed}, mode {mode}", expected, 2 * np.pi * float(frequency) * T


def loaded_plate(element: Element) -> Iterator[Row]:
    """Find omega a^2 sqrt(rho h / D) of a square on hinges under a multiple of its buckling load, along x."""
    h, nu, n = 1e-3, 0.3, 12
    # D = rho h = a = 1.
    material = ancf.Material(E=12 * (1 - nu**2) / h**3, nu=nu, density=1 / h)
    body = ancf.Rectangle(size=(1.0, 1.0), divisions=(n, n), thickness=h, material=material, element=element)
    buckling = 4 * np.pi**2
    model = ancf.Model(
        bodies={"plate": body},
        supports=[
            ancf.Support(at="edge:x0", fix=["r.z", "r_y.z"]),
            ancf.Support(at="edge:x1", fix=["r.z", "r_y.z"]),
            ancf.Support(at="edge:y0", fix=["r.z", "r_x.z"]),
            ancf.Support(at="edge:y1", fix=["r.z", "r_x.z"]),
            ancf.Support(at="corner:x0y0", fix=["r"]),
            ancf.Support(at="corner:x1y0", fix=["r.y"]),
        ],
        loads=[
            ancf.LineLoad(at="edge:x0", per_length=(buckling, 0.0, 0.0)),
            ancf.LineLoad(at="edge:x1", per_length=(-buckling, 0.0, 0.0)),
        ],
    )
    waves = [(p * np.pi, q * np.pi) for p in (1, 2, 3) for q in (1, 2, 3)]
    lowest = []
    for factor in (0.0, 0.8, -10.0):
        found = ancf.modes(model, count=2, load_factor=factor).eigenvalue
        known = sorted((a**2 + b**2) ** 2 - factor * buckling * a**2 for a, b in waves)
        for mode in (0, 1):
            yield f"load {factor:g}, mode {mode + 1}", np.sqrt(known[mode]), float(np.sqrt(found[mode]))
        lowest.append(float(found[0]))
    # The square of the lowest is linear in the load.
    yield "load at which it is zero", 1.0, 0.8 * lowest[0] / (lowest[0] - lowest[1])


def quarter(element: Element, nu: float, thickness: float, length: float, *ends: ancf.Support) -> ancf.Model:
    """Make a quarter of a cylinder of radius 1, E and density 1, cut along two planes of symmetry."""
    material = ancf.Material(E=1.0, nu=nu, density=1.0)
    body = ancf.Cylinder(
        radius=1.0,
        angle=(0.0, np.pi / 2),
        length=(0.0, length),
        divisions=(16, 16),
        thickness=thickness,
        material=material,
        element=element,
    )
    planes = [
        ancf.Support(at="edge:x0", symmetry="y"),
        ancf.Support(at="edge:x1", symmetry="x"),
    ]
    return ancf.Model(bodies={"shell": body}, supports=[*planes, *ends])


def sanders(m: int, n: int, nu: float, h: float, length: float) -> float:
    """Return the lowest omega of a cylinder, R = E = rho = 1, on diaphragms, with m half waves along and n around it.

    Sanders and Koiter's strains of u cos(k x) cos(n t), v sin(k x) sin(n t), w sin(k x) cos(n t), k = m pi / length;
    A. W. Leissa, Vibration of Shells, NASA SP-288 (1973), chapter 2.
    """
    k = m * np.pi / length
    membrane = np.array([[-k, 0, 0], [0, n, 1], [-n, k, 0]])
    bending = np.array([[0, 0, k**2], [0, n, n**2], [n / 2, 3 * k / 2, 2 * k * n]])
    stress = np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]]) / (1 - nu**2)
    stiffness = membrane.T @ stress @ membrane + h**2 / 12 * bending.T @ stress @ bending
    return float(np.sqrt(eigh(stiffness, eigvals_only=True)[0]))


def diaphragms(element: Element) -> Iterator[Row]:
    """Find 1000 omega R sqrt(rho / E) of the lowest modes of a cylinder on diaphragms, L / R = 2, h / R = 1/500."""
    nu, h, length = 0.3, 1 / 500, 2.0
    ends = [ancf.Support(at=f"edge:y{end}", fix=["r.x", "r.y", "r_x.x", "r_x.y"]) for end in (0, 1)]
    # Against sliding along the axis.
    model = quarter(element, nu, h, length, *ends, ancf.Support(at=(0.0, length / 2), fix=["r.z"]))
    waves = [(m, n) for m in (1, 2, 3) for n in range(0, 20, 2)]
    known = sorted((sanders(m, n, nu, h, length), m, n) for m, n in waves)
    found = 2 * np.pi * ancf.modes(model, count=4).frequency
    for (omega, m, n), frequency in zip(known, found, strict=False):
        yield f"m = {m}, n = {n}", 1000 * omega, 1000 * float(frequency)


def free_cylinder(element: Element) -> Iterator[Row]:
    """Find 1000 omega R sqrt(rho / E) of the modes without extension of a free cylinder, L / R = 1, h / R = 1/500."""
    h, length = 1 / 500, 1.0
    model = quarter(element, 0.0, h, length)
    known: list[tuple[float, str]] = []
    for n in (2, 4):
        rayleigh = h**2 / 12 * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
        love = rayleigh * (1 + 24 / (n * length) ** 2) / (1 + 12 / (n**2 * (n**2 + 1) * length**2))
        known += [(float(np.sqrt(rayleigh)), f"Rayleigh, n = {n}"), (float(np.sqrt(love)), f"Love, n = {n}")]
    found = 2 * np.pi * ancf.modes(model, count=5).frequency
    # The first is the sliding along the axis.
    for (omega, name), frequency in zip(sorted(known), found[1:], strict=True):
        yield name, 1000 * omega, 1000 * float(frequency)


CASES: Sequence[tuple[str, Callable[[Element], Iterator[Row]]]] = (
    ("rotating beam", rotating_beam),
    ("loaded plate", loaded_plate),
    ("cylinder on diaphragms", diaphragms),
    ("free cylinder", free_cylinder),
)


def table() -> Iterator[str]:
    """Lines of the table."""
    yield "| structure | mode | known | `thin36` | `thin48` |"
    yield "|---|---|---|---|---|"
    for name, solve in CASES:
        for (mode, known, thin36), (_, _, thin48) in zip(solve("thin36"), solve("thin48"), strict=True):
            differences = [f"{found / known - 1:+.2%}" for found in (thin36, thin48)]
            yield f"| {name} | {mode} | {known:.5g} | {' | '.join(differences)} |"


if __name__ == "__main__":
    print_or_write("frequencies beside closed forms and published ones", "modes.md", modes=table())
