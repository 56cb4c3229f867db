"""Print the README's table of results: what the library computes beside what is known.

Run it from any folder with ``python benchmarks/results.py``. It takes some seconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

import ancf

PROTOTYPE = "independent prototype"
FINE = "the prototype, 16 x 4"
NUMPY = "`ancf.reference`, the same step"
ELASTICA = "inextensible elastica, exact"

Membrane = Literal["projected", "full", "lobatto"]
Curvature = Literal["paper", "koiter"]
# What the prototype was run with.
CURVATURE: dict[Membrane, Curvature] = {"projected": "paper", "full": "paper", "lobatto": "koiter"}


@dataclass(frozen=True)
class Row:
    """One line of the table; `known` is a number with a source, in the digits in which it is known."""

    case: str
    mesh: str
    element: str
    value: float
    known: str
    source: str

    def __str__(self) -> str:
        known = float(self.known)
        digits = max(4, len(self.known.partition(".")[2]))
        difference = round((self.value - known) / abs(known), 4) + 0.0  # No negative zero.
        cells = (self.case, self.mesh, self.element, f"{self.value:.{digits}f}", self.known, f"{difference:+.2%}")
        return " | ".join(("", *cells, self.source, "")).strip()


def cantilever(divisions: tuple[int, int], membrane: Membrane) -> float:
    """Deflection of the corner of a steel plate under 30 N on its end, m; Dufva and Shabana (2005)."""
    plate = ancf.Rectangle(
        size=(0.5, 0.15),
        divisions=divisions,
        thickness=1e-3,
        material=ancf.Material(E=2.07e11, nu=0.3),
        membrane=membrane,
        curvature=CURVATURE[membrane],
    )
    model = ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, -200.0))],
        probes=[ancf.Probe(name="corner", at=(0.5, 0.15))],
    )
    # One giant step of the locking element lands on another equilibrium.
    result = ancf.solve_static(model, load_factors=np.linspace(0.1, 1.0, 10).tolist())
    return float(result.probes["corner"].value[-1, 2])


def strip(load: ancf.LineLoad | ancf.Moment, thickness: float) -> tuple[float, float]:
    """End (x, z) of a clamped strip, L 10, b 1, E 1.2e6, nu 0; h = 0.1 in Sze, Liu and Lo (2004)."""
    material = ancf.Material(E=1.2e6, nu=0.0)
    model = ancf.Model(
        bodies={"strip": ancf.Rectangle(size=(10.0, 1.0), divisions=(16, 1), thickness=thickness, material=material)},
        supports=[ancf.Support(at="edge:x0", clamp=True)],
        loads=[load],
        probes=[ancf.Probe(name="end", at=(10.0, 0.5))],
    )
    x, _, z = ancf.solve_static(model).probes["end"].value[-1]
    return float(x), float(z)


def pendulum(n: int) -> tuple[float, float]:
    """Corner (x = y, z) of a rubber plate opposite to the one it hangs by, after 0.3 s; Dufva and Shabana (2005)."""
    rubber = ancf.Material(E=1e5, nu=0.3, density=7810.0)
    plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(n, n), thickness=0.01, material=rubber, membrane="full")
    model = ancf.Model(
        bodies={"plate": plate},
        supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
        loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
        probes=[ancf.Probe(name="A", at=(0.3, 0.3))],
    )
    result = ancf.simulate(model, until=0.3, step=1e-3, alpha=0.0, outputs=[0.3])
    x, _, z = result.probes["A"].value[-1]
    return float(x), float(z)


def cantilever_rows() -> list[Row]:
    """Return the rows of the cantilever."""
    known: list[tuple[Membrane, int, str, str]] = [
        ("projected", 1, "-0.2739", PROTOTYPE),
        ("projected", 2, "-0.2832", PROTOTYPE),
        ("projected", 4, "-0.2847", PROTOTYPE),
        ("projected", 16, "-0.286", FINE),
        ("full", 1, "-0.183114", "`ancf.reference`"),
        ("full", 2, "-0.261603", "`ancf.reference`"),
        ("full", 4, "-0.2817", PROTOTYPE),
        ("full", 16, "-0.286", FINE),
        ("lobatto", 1, "-0.2949", PROTOTYPE),
        ("lobatto", 2, "-0.2865", PROTOTYPE),
        ("lobatto", 4, "-0.2850", PROTOTYPE),
        ("lobatto", 16, "-0.286", FINE),
    ]
    case = "steel cantilever, deflection, m"
    return [Row(case, f"{n} x 1", rule, cantilever((n, 1), rule), value, source) for rule, n, value, source in known]


def strip_rows() -> list[Row]:
    """Return the rows of the strip, whose closed forms leave out stretch: of the order of (h / R)^2, R the radius."""
    L, h = 10.0, 0.01
    x, z = strip(ancf.LineLoad(at="edge:x1", per_length=(0.0, 0.0, 4.0)), thickness=0.1)
    half = strip(ancf.Moment(at="edge:x1", per_length=np.pi / L * 1.2e6 * h**3 / 12), thickness=h)
    mesh, element = "16 x 1", "projected"
    return [
        Row("strip under end shear, L - x, m", mesh, element, L - x, "3.28941", ELASTICA),
        Row("strip under end shear, z, m", mesh, element, z, "6.69964", ELASTICA),
        Row("strip bent to half a circle, z, m", mesh, element, half[1], f"{2 * L / np.pi:.5f}", "2 L / pi"),
    ]


def pendulum_rows() -> list[Row]:
    """Return the rows of the pendulum."""
    known = [(2, "0.226297", "-0.441566"), (4, "0.228444", "-0.446515"), (8, "0.232723", "-0.437612")]
    rows = []
    for n, x, z in known:
        found = pendulum(n)
        for name, value, expected in zip(("x", "z"), found, (x, z), strict=True):
            rows.append(Row(f"rubber pendulum, {name}, m", f"{n} x {n}", "full", value, expected, NUMPY))
    return rows


def main() -> None:
    """Print the table."""
    print("| case | elements | membrane | computed | known | difference | source of what is known |")
    print("|---|---|---|---|---|---|---|")
    for row in (*cantilever_rows(), *strip_rows(), *pendulum_rows()):
        print(row)


if __name__ == "__main__":
    main()
