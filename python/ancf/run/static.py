"""Statics."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import ClassVar, Literal, Self

from pydantic import model_validator

from ancf import _core
from ancf.errors import InputError, Mistake, Mistakes, show
from ancf.inputs import Positive, PositiveInt
from ancf.loads import Gravity, History
from ancf.memory import check_memory, implicit
from ancf.model import Model
from ancf.run.base import LoadedRun, ProgressCall, check_density


class PathWarning(RuntimeWarning):
    """A path by arc length has made as many steps as it may and not reached its last load factor."""


class Static(LoadedRun):
    """Equilibrium under loads that grow: load factors reached in adaptive steps.

    Every result starts with the state without loads, load factor 0.

    Parameters
    ----------
    load_factors : sequence of float, default (1.0,)
        Where to record a state, in the order in which they are reached; each differs from the one before, the first
        from 0. By arc length every step is recorded: the first load factor gives the direction and, if there are
        more, the length of the longest step by what the tangent at the start does in it; the path ends at the last.
    path : {"load", "arc"}, default "load"
        How the path is followed. By the load factor, over stable equilibria only: where one is lost, the structure
        jumps to the next, see `Result.jumps`. Or by arc length, through limit points and turning points, stable or not;
        the load factor may decrease.
    newton : {"mip", "plain"}, default "mip"
        The iteration: mixed integration points, Magisano, Leonetti and Garcea (2017), or plain.
    tolerance : float, default 1e-8
        Of the last correction, relative to the size of the model.
    max_iterations : int, default 30
        A step that needs more is cut.
    first_step : float, optional
        Of the load factor; the first load factor if left out.
    min_step : float, default 1e-5
        The run fails if a smaller step would be needed.
    max_steps : int, default 1000
        By arc length the path ends after so many steps, with a warning if it has not reached the last load factor.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "static"
    parameter: ClassVar[str] = "load factor"
    unit: ClassVar[str] = ""
    history: ClassVar[History] = "ramp"

    load_factors: Sequence[float] = (1.0,)
    path: Literal["load", "arc"] = "load"
    first_step: Positive | None = None
    min_step: Positive = 1e-5
    max_steps: PositiveInt = 1000

    @model_validator(mode="after")
    def _change(self) -> Self:
        if not self.load_factors or any(after == before for before, after in pairwise((0.0, *self.load_factors))):
            message = "each must differ from the one before, and the first from 0"
            raise InputError(Mistake(("load_factors",), message, show(self.load_factors)))
        return self

    @property
    def end(self) -> float:
        """The last load factor."""
        return self.load_factors[-1]

    def check(self, model: Model) -> None:
        """Raise `InputError` if a body can move rigidly, or has no mass where gravity acts."""
        mistakes = Mistakes()
        for body, motion in model.rigid_motions():
            mistakes.add(("supports",), f"the body {body} can still move: {motion}; in statics supports must hold it")
        for index, support in enumerate(model.supports):
            for name in ("translation", "shake", "rotation"):
                if getattr(support, name) is not None:
                    mistakes.add(("supports", index, name), "is for motion; in statics supports stay where they are")
        if any(isinstance(load, Gravity) for load in model.loads):
            check_density(model, mistakes, "where gravity acts")
        with mistakes.gather():
            check_memory(model.bodies, {name: implicit(body) for name, body in model.bodies.items()})
        mistakes.check()

    def start(self, core: _core.Model, threads: int | None, progress: ProgressCall) -> _core.Run:
        """Run the compiled model."""
        return _core.solve_static(
            core,
            load_factors=self.load_factors,
            path=self.path,
            newton=self.newton,
            tolerance=self.tolerance,
            max_iterations=self.max_iterations,
            first_step=self.first_step,
            min_step=self.min_step,
            max_steps=self.max_steps,
            threads=threads,
            progress=progress,
        )
