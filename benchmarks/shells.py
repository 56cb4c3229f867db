"""Print the table of docs/shells.md: published shells, each solved by its scene file with nothing set by hand.

Run it from any folder with ``python benchmarks/shells.py``; it takes half a minute. ``--plot DIR`` draws the deformed
shells as well, ``--quick`` leaves out the slowest; ``--variants`` prints the table of other elements, measures of
curvature and meshes instead.
"""

from __future__ import annotations

import argparse
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import ancf
from ancf.bodies import Plate

SCENES = Path(__file__).resolve().parent.parent / "examples" / "shells"


@dataclass(frozen=True)
class Case:
    """A scene, a component of the displacement of a probe, and what is published for it."""

    scene: str
    probe: str
    component: int
    published: float
    slow: bool = False


SZE = [
    Case("cantilever_shear", "end", 2, 6.698),
    Case("cantilever_shear", "end", 0, -3.286),
    Case("cantilever_moment", "end", 0, -12.0),
    Case("slit_annulus", "A", 2, 13.891),
    Case("slit_annulus", "B", 2, 17.528),
    Case("pinched_hemisphere", "outwards", 0, 4.067),
    Case("pinched_hemisphere", "inwards", 1, -8.178),
    Case("pulled_cylinder", "A", 1, 2.768),
    Case("pulled_cylinder", "B", 0, -4.551),
    Case("pulled_cylinder", "C", 0, -3.269),
    Case("pinched_half_cylinder", "A", 1, -1.71505, slow=True),
    Case("pinched_cylinder", "A", 1, -83.102, slow=True),
    Case("pinched_cylinder", "B", 0, 34.272, slow=True),
    Case("hinged_roof_12.7", "A", 1, -28.876),
    Case("hinged_roof_6.35", "A", 1, -38.190),
]
"""K. Y. Sze, X. H. Liu, S. H. Lo (2004), at full load; the roofs interpolated in its tables."""


VARIANTS: Mapping[str, list[dict[str, Any]]] = {
    "pinched_hemisphere": [
        {},
        {"curvature": "koiter"},
        {"divisions": [32, 32]},
        {"element": "thin48"},
    ],
    "pulled_cylinder": [
        {},
        {"curvature": "koiter"},
        {"divisions": [36, 24]},
        {"divisions": [48, 32]},
        {"divisions": [64, 44]},
        {"membrane": "full"},
        {"element": "thin48"},
    ],
    "pinched_cylinder": [
        {"divisions": [20, 20]},
        {"divisions": [30, 30]},
        {},
        {"divisions": [48, 48]},
        {"membrane": "full"},
        {"curvature": "koiter"},
    ],
    "hinged_roof_6.35": [
        {},
        {"divisions": [16, 16]},
        {"divisions": [24, 24]},
        {"divisions": [24, 24], "element": "thin48"},
        {"divisions": [16, 16], "curvature": "koiter"},
    ],
}
"""What is changed in the body of a scene."""


def solve(scene: ancf.Scene) -> ancf.Result:
    """Solve a static scene."""
    result = scene.solve()
    return result


def draw(scene: ancf.Scene) -> Figure:
    """Solve a scene once more, with a state at every twentieth of the load unless every step is one, and draw it."""
    document = scene.document()
    if document["run"].get("path") != "arc":
        document["run"]["load_factors"] = [step / 20 for step in range(1, 21)]
    return solve(ancf.Scene.of(document)).plot(scene.title)


def strained(result: ancf.Result) -> float:
    """Return the share of a shell in which a principal strain at its top or bottom exceeds 2 %, at full load."""
    ((name, body),) = result.model.bodies.items()
    assert isinstance(body, Plate)
    grid = [low + (high - low) * (np.arange(100) + 0.5) / 100 for low, high in result.model.domain(name)]
    points = np.stack(np.meshgrid(*grid), axis=-1).reshape(-1, 2)
    membrane, curvature = (result.evaluate(name, points, what)[-1] for what in ("membrane_strain", "curvature"))
    largest = np.zeros(len(points))
    for z in (-body.thickness / 2, body.thickness / 2):
        xx, yy, xy = (membrane + z * curvature).T
        largest = np.maximum(largest, np.abs(xx + yy) / 2 + np.hypot(xx - yy, xy) / 2)
    return float(np.mean(largest > 0.02))


def compare_variants() -> None:
    """Solve what differs from the table by more than 0.5 % in other ways, and print."""
    print("| shell | changed | steps | iterations | jumps at | displacements | differences | strained |")
    print("|---|---|---|---|---|---|---|---|")
    for name, variants in VARIANTS.items():
        document = tomllib.loads((SCENES / f"{name}.toml").read_text())
        cases = [case for case in SZE if case.scene == name]
        for changes in variants:
            body = {"shell": document["body"]["shell"] | changes}
            result = solve(ancf.Scene.of(document | {"body": body}))
            values = [float(result.probes[case.probe].value[-1, case.component]) for case in cases]
            cells = [
                name.replace("_", " "),
                ", ".join(f"{key} {value}" for key, value in changes.items()) or "-",
                str(result.counts["steps"]),
                str(result.counts["iterations"]),
                ", ".join(f"{t:.4f}" for t in result.jumps) or "-",
                ", ".join(f"{value:.4f}" for value in values),
                ", ".join(f"{value / case.published - 1:+.2%}" for value, case in zip(values, cases, strict=True)),
                f"{strained(result):.0%}",
            ]
            print("|", " | ".join(cells), "|", flush=True)


def main() -> None:
    """Solve and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--variants", action="store_true")
    options = parser.parse_args()
    if options.variants:
        compare_variants()
        return
    cases = [case for case in SZE if not (options.quick and case.slow)]
    print("| shell | mesh | steps | iterations | jumps at | where | displacement | published | difference |")
    print("|---|---|---|---|---|---|---|---|---|")
    results: dict[str, ancf.Result] = {}
    for case in cases:
        if case.scene not in results:
            scene = ancf.load_scene(SCENES / f"{case.scene}.toml")
            results[case.scene] = solve(scene)
            if options.plot is not None:
                draw(scene).savefig(options.plot / f"shell_{case.scene}.png", dpi=100)
        result = results[case.scene]
        (body,) = result.model.bodies.values()
        assert isinstance(body, Plate)
        value = float(result.probes[case.probe].value[-1, case.component])
        jumps = ", ".join(f"{t:.4f}" for t in result.jumps) or "-"
        counts = result.counts
        cells = [
            case.scene.replace("_", " "),
            "{} x {}".format(*body.divisions),
            str(counts["steps"]),
            str(counts["iterations"]),
            jumps,
            f"{case.probe}, {'xyz'[case.component]}",
            f"{value:.4f}",
            f"{case.published:.4g}",
            f"{value / case.published - 1:+.2%}",
        ]
        print("|", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
