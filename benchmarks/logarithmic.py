"""Print what logarithmic membrane strains change in the pulled cylinder of docs/shells.md.

The published elements measure such strains. The answer of the scene goes into the NumPy path, where the strain is
changed and the equilibrium is sought again. Run it from any folder with ``python benchmarks/logarithmic.py``; it takes
a minute.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve
from shells import SCENES, SZE, solve

import ancf
from ancf import reference
from ancf.reference.strain import MEMBRANE

FloatArray = NDArray[np.float64]

SCENE = tomllib.loads((SCENES / "pulled_cylinder.toml").read_text(encoding="utf-8"))
SHELL = SCENE["body"]["shell"]
CASES = [case for case in SZE if case.scene == "pulled_cylinder"]
TERMS = 14
"""Of the series of the logarithm; strains are below 0.1."""


@dataclass(frozen=True)
class Logarithmic:
    """The strain ln(I + 2 E) / 2 in place of Green and Lagrange's E, where parameters are orthogonal at rest.

    Attributes
    ----------
    rest : ndarray, shape (elements, samples, 3)
        Half of the metric at rest, the sheared component doubled.
    """

    rest: FloatArray

    def value(self, g: FloatArray) -> FloatArray:
        """Strain, shape (..., 3)."""
        return np.asarray(self._of(MEMBRANE.value(g) - self.rest))

    def gradient(self, g: FloatArray) -> FloatArray:
        """Differentiate the strain, shape (..., 3, 2, 3); complex steps have no cancellation."""
        E = MEMBRANE.value(g) - self.rest
        columns = [self._of(E + 1e-30j * direction).imag / 1e-30 for direction in np.eye(3)]
        return np.asarray(np.einsum("...cd,...dvi->...cvi", np.stack(columns, axis=-1), MEMBRANE.gradient(g)))

    def hessian(self, g: FloatArray) -> FloatArray:
        """Hessian of E: near enough for Newton's method to converge."""
        return MEMBRANE.hessian(g)

    def _of(self, E: Any) -> Any:
        x, y = np.moveaxis(np.sqrt(2 * self.rest[..., :2]), -1, 0)
        xy = E[..., 2] / (2 * x * y)
        physical = np.stack([E[..., 0] / x**2, xy, xy, E[..., 1] / y**2], axis=-1)
        matrix = physical.reshape(*physical.shape[:-1], 2, 2)
        power, total = matrix, matrix
        for n in range(2, TERMS):
            power = -2 * power @ matrix
            total = total + power / n
        return np.stack([total[..., 0, 0] * x**2, total[..., 1, 1] * y**2, 2 * total[..., 0, 1] * x * y], axis=-1)


def plain(curvature: Any) -> reference.Model:
    """Make the scene's model in the NumPy path."""
    (low, high), (_, length) = SHELL["angle"], SHELL["length"]
    material = SCENE["material"]["shell"]
    model = reference.Model(
        reference.RectangleMesh((high - low, length), tuple(SHELL["divisions"])),
        thickness=SHELL["thickness"],
        E=material["E"],
        nu=material["nu"],
        density=1.0,
        curvature=curvature,
        surface=reference.cylinder(SHELL["radius"]),
    )
    model.fix("edge:x0", ["r.y", "r_y.y", "r_x.x", "r_x.z"])
    model.fix("edge:x1", ["r.x", "r_y.x", "r_x.y", "r_x.z"])
    model.fix("edge:y0", ["r.z", "r_x.z", "r_y.x", "r_y.y"])
    model.add_force((high, 0.0), SCENE["load"][0]["force"])
    return model


def equilibrium(model: reference.Model, q: FloatArray) -> FloatArray:
    """Newton's method from the nodal coordinates q."""
    load, free = model.external_force(q, 1.0), model.free
    for _ in range(50):
        residual = load - model.internal_force(q)
        correction = spsolve(model.tangent(q)[free][:, free], residual[free])
        q = q.copy()
        q[free] += correction
        if np.abs(correction).max() < 1e-7:
            return q
    raise SystemExit("no equilibrium")


def main() -> None:
    """Solve and print."""
    print("| curvature | membrane strain | A, y | B, x | C, x |")
    print("|---|---|---|---|---|")
    for curvature in ("paper", "koiter"):
        scene = SCENE | {"body": {"shell": SHELL | {"curvature": curvature}}}
        start = solve(ancf.Scene.of(scene)).q[-1]
        model = plain(curvature)
        membrane, bending = model._energies
        rest = membrane.reference.reshape(*membrane.reference.shape[:1], -1, 3)
        logarithmic = replace(membrane, measure=Logarithmic(rest), reference=np.zeros_like(membrane.reference))
        for name, energy in (("Green and Lagrange", membrane), ("logarithmic", logarithmic)):
            model._energies = (energy, bending)
            q = equilibrium(model, start)
            places = [next(probe["at"] for probe in SCENE["probe"] if probe["name"] == case.probe) for case in CASES]
            moved = [model.position(tuple(at), q) - model.position(tuple(at), model.reference) for at in places]
            found = [float(u[case.component]) / case.published - 1 for u, case in zip(moved, CASES, strict=True)]
            print(f"| {curvature} | {name} | {' | '.join(f'{difference:+.2%}' for difference in found)} |", flush=True)


if __name__ == "__main__":
    main()
