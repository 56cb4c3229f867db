"""The ladder: what a scene can be modelled with, from a rigid body to a fine mesh, and how it is stepped in time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

from ancf.bodies import NODAL_VECTORS, Plate
from ancf.model import Model
from ancf.run import Dynamic, Method
from ancf.scene import Scene

COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
"""Elements along a side, times the fewest that put nodes where supports need them."""

LOOSEST = 0.1
"""Error control with a larger tolerance controls nothing."""

_PER_STEP, _PER_RTOL = 0.8, 0.3
"""Powers of the step and of the tolerance of error control with which costs shrink."""
_FINEST_BASE = 16
_KEPT = ("until", "newton", "tolerance", "max_iterations")
"""What a motion keeps of the scene when its stepping is chosen."""


class Family(NamedTuple):
    """An element and the variant of its membrane; None for rigid bodies."""

    element: str
    membrane: str | None

    def __str__(self) -> str:
        return " ".join(part for part in self if part)


RIGID = Family("rigid", None)
THIN = tuple(Family("thin36", membrane) for membrane in ("projected", "lobatto", "full"))
CONTINUOUS = Family("thin48", "projected")


@dataclass(frozen=True)
class Rung:
    """A family on meshes.

    Parameters
    ----------
    family : Family
        The element of all bodies.
    divisions : tuple of pairs of int
        Elements along x and y of each body, in the order of the model.
    """

    family: Family
    divisions: tuple[tuple[int, int], ...]

    @cached_property
    def elements(self) -> int:
        """How many elements there are."""
        return sum(x * y for x, y in self.divisions)

    def sides(self) -> Iterator[tuple[int, int]]:
        """Return body and axis of each side that can be refined."""
        return ((body, axis) for body in range(len(self.divisions)) for axis in (0, 1))

    def scaled(self, side: tuple[int, int], factor: Fraction) -> Rung | None:
        """Return the rung with more or fewer elements along one side; None if that is no whole number."""
        body, axis = side
        count = self.divisions[body][axis] * factor
        if count.denominator != 1:
            return None
        divisions = [list(pair) for pair in self.divisions]
        divisions[body][axis] = int(count)
        return replace(self, divisions=tuple((x, y) for x, y in divisions))

    def __str__(self) -> str:
        return f"{self.family} {' and '.join(f'{x} x {y}' for x, y in self.divisions)}"


@dataclass(frozen=True)
class Stepping:
    """A method of time integration and its step length, s, or the tolerance of its error control."""

    method: Method
    step: float | None = None
    rtol: float | None = None
    reuse: bool = False

    @property
    def explicit(self) -> bool:
        """Whether the highest frequency limits the step."""
        return self.method in ("verlet", "rk")

    @property
    def kind(self) -> tuple[Method, bool, bool]:
        """Method and control, without the length or the tolerance."""
        return self.method, self.step is None, self.reuse

    def tighter(self) -> Stepping:
        """Return one of at most a quarter of the error."""
        if self.step is not None:
            return replace(self, step=self.step / 2)
        assert self.rtol is not None
        return replace(self, rtol=max(self.rtol / 4, 1e-12))

    def longer(self, factor: float) -> Stepping | None:
        """Return one of about `factor` times the length, a tolerance as many times squared; None if it is too loose."""
        if self.step is not None:
            return replace(self, step=self.step * factor)
        assert self.rtol is not None
        return replace(self, rtol=self.rtol * factor**2) if self.rtol * factor**2 <= LOOSEST else None

    def lengthening(self, other: Stepping) -> float:
        """Return about the cost of another one of the same kind, relative to this one."""
        if self.step is not None and other.step is not None:
            return float((self.step / other.step) ** _PER_STEP)
        assert self.rtol is not None
        assert other.rtol is not None
        return float((self.rtol / other.rtol) ** _PER_RTOL)

    def __str__(self) -> str:
        length = f"step {self.step:.3g} s" if self.step is not None else f"rtol {self.rtol:.2g}"
        return f"{self.method}, {length}{', reuse' if self.reuse else ''}"


@dataclass(frozen=True)
class Choice:
    """A rung and, in motion, how it is stepped."""

    rung: Rung
    stepping: Stepping | None = None

    def __str__(self) -> str:
        if self.stepping is None:
            return str(self.rung)
        return f"{self.rung}; {self.stepping}"


def families(model: Model) -> tuple[Family, ...]:
    """Return the thin families that the supports allow: `thin48` only if no vector of another element is fixed."""
    named = {name.partition(".")[0] for support in model.supports for name in support.fix}
    allowed = [family for family in (*THIN, CONTINUOUS) if named <= set(NODAL_VECTORS[family.element])]
    return tuple(allowed)


def coarsest(model: Model) -> tuple[tuple[int, int], ...]:
    """Return for each body the fewest divisions that put a node at every point that is supported."""
    divisions = []
    for name in model.bodies:
        points = [s.at for s in model.supports if s.body == name and not isinstance(s.at, str)]
        sides = []
        for axis, (low, high) in enumerate(model.domain(name)):
            places = [(float(point[axis]) - low) / (high - low) for point in points]
            fits = [n for n in range(1, _FINEST_BASE + 1) if all(abs(n * p - round(n * p)) < 1e-6 * n for p in places)]
            sides.append(fits[0] if fits else _FINEST_BASE)
        divisions.append((sides[0], sides[1]))
    return tuple(divisions)


def outputs(run: Dynamic) -> dict[str, Any]:
    """Return when `run` records states, independently of its steps."""
    if run.outputs is not None:
        return {"outputs": run.outputs}
    return {"every": run.every or run.until / (len(run.times()) - 1)}


def apply(scene: Scene, choice: Choice) -> Scene:
    """Return the scene with the settings of a choice.

    Parameters
    ----------
    scene : Scene
        What to model.
    choice : Choice
        How.

    Returns
    -------
    Scene
        Ready to be run.
    """
    rung, stepping = choice.rung, choice.stepping
    model = scene.model
    bodies: Mapping[str, Plate] = {
        name: _remake(body, rung.family, divisions)
        for (name, body), divisions in zip(model.bodies.items(), rung.divisions, strict=True)
    }
    made = Model(bodies=bodies, supports=model.supports, loads=model.loads, probes=model.probes)
    run = scene.run
    if stepping is not None:
        assert isinstance(run, Dynamic)
        run = Dynamic(
            **{name: getattr(run, name) for name in _KEPT},
            method=stepping.method,
            step=stepping.step,
            rtol=stepping.rtol,
            reuse=stepping.reuse,
            **outputs(run),
        )
    return replace(scene, model=made, run=run)


def _remake(body: Plate, family: Family, divisions: tuple[int, int]) -> Plate:
    element, membrane = ("thin36", "lobatto") if family == RIGID else family
    return body.model_copy(update={"divisions": divisions, "element": element, "membrane": membrane})
