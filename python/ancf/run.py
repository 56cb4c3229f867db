"""Kinds of run: statics, motion and modes, with their options."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PlainValidator, model_validator

from ancf import _core
from ancf.errors import InputError, Mistake, Mistakes, show
from ancf.inputs import Input, Positive, PositiveInt, table
from ancf.loads import Gravity, History
from ancf.memory import EXPLICIT, STATE, check_memory, implicit
from ancf.model import Model

_INTERVALS = 100
_MOST_OUTPUTS = 1_000_000
_MOST_STEPS = 10**12
_ROUNDING = 1e-12

Method: TypeAlias = Literal[
    "hht", "generalized_alpha", "newmark", "tr_bdf2", "esdirk", "energy_momentum", "verlet", "rk", "rigid"
]
ProgressCall: TypeAlias = Callable[[float], Any] | None


class _Run(Input, ABC):
    kind: ClassVar[str]
    parameter: ClassVar[str]
    unit: ClassVar[str]
    history: ClassVar[History]

    newton: Literal["mip", "plain"] = "mip"
    tolerance: Positive = 1e-8
    max_iterations: Annotated[PositiveInt, Field(le=1_000_000)] = 30

    @property
    @abstractmethod
    def end(self) -> float:
        """Where the run ends: the time in s, or the load factor."""

    @abstractmethod
    def check(self, model: Model) -> None:
        """Raise `InputError` if the model cannot be run in this way."""

    @abstractmethod
    def start(self, core: _core.Model, threads: int | None, progress: ProgressCall) -> _core.Run:
        """Run the compiled model."""


class Static(_Run):
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
        By arc length the path ends after so many steps, if it has not reached the last load factor.

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


class Dynamic(_Run):
    """Motion from rest, or from given velocities, in fixed steps or with error control.

    Every result starts with the state at t = 0. Without `outputs` and `every` it has up to 100 more, equally spaced.

    Parameters
    ----------
    until : float
        s, greater than 0.
    step : float, optional
        Length of fixed steps, s. Either this or `rtol` is needed.
    rtol : float, optional
        Error control: the errors that the steps add to a position stay, together, below this times the size of the
        body. From 1e-12 to below 1.
    atol : float, optional
        The same in m, added.
    first_step, max_step, min_step : float, optional
        With error control: the first, longest and shortest step, s; where a shorter one is needed the run fails.
    force : bool, default False
        Let a fixed step of an explicit method exceed its limit of stability.
    method : str, default "hht"
        Implicit of order 2: "hht" (HHT-alpha), "generalized_alpha", "newmark" (trapezoidal rule), "tr_bdf2" (L-stable)
        and "energy_momentum" (keeps energy and momenta). Of order 4: "esdirk" (L-stable). Explicit: "verlet" of order
        2, "rk" (Dormand and Prince) of order 5. "rigid", of order 5: no body deforms.
    alpha : float, optional
        Of "hht", from -1/3 to 0; -0.05 if left out.
    rho_inf : float, optional
        Of "generalized_alpha", the spectral radius at infinite frequency, from 0 to 1; 0.9 if left out.
    lumped : bool, default False
        Of "verlet": use a diagonal mass matrix.
    outputs : sequence of float, optional
        Times of the states to record, s; they increase and lie in [0, until].
    every : float, optional
        Instead of `outputs`, the time between states, s; the last is at `until`.
    newton : {"mip", "plain"}, default "mip"
        The iteration: mixed integration points, Magisano, Leonetti and Garcea (2017), or plain.
    tolerance : float, default 1e-8
        Of the last correction, relative to the size of the model.
    max_iterations : int, default 30
        A step that needs more is cut with error control; otherwise the run fails.
    reuse : bool, default True
        Keep factorisations over iterations and steps while they converge fast: modified Newton.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "dynamic"
    parameter: ClassVar[str] = "t"
    unit: ClassVar[str] = "s"
    history: ClassVar[History] = "constant"

    until: Positive
    step: Positive | None = None
    rtol: Annotated[float, Field(ge=1e-12, lt=1)] | None = None
    atol: Annotated[float, Field(ge=0)] | None = None
    first_step: Positive | None = None
    max_step: Positive | None = None
    min_step: Annotated[float, Field(ge=0)] | None = None
    force: bool = False
    method: Method = "hht"
    alpha: Annotated[float, Field(ge=-1 / 3, le=0)] | None = None
    rho_inf: Annotated[float, Field(ge=0, le=1)] | None = None
    outputs: Sequence[float] | None = None
    every: Positive | None = None
    lumped: bool = False
    reuse: bool = True

    @model_validator(mode="after")
    def _agree(self) -> Self:
        mistakes = Mistakes()
        if (self.step is None) == (self.rtol is None):
            mistakes.add(("step",), "give either step, for fixed steps, or rtol, for error control", self.step)
        if self.step is not None and not 1 <= self.until / self.step <= _MOST_STEPS:
            mistakes.add(
                ("step",), f"must not be greater than until, nor less than until / {_MOST_STEPS:.0e}", self.step
            )
        for name, method in (("alpha", "hht"), ("rho_inf", "generalized_alpha"), ("lumped", "verlet")):
            if getattr(self, name) not in (None, False) and self.method != method:
                mistakes.add((name,), f'is for method = "{method}" only', getattr(self, name))
        for name in ("atol", "first_step", "max_step", "min_step"):
            if getattr(self, name) is not None and self.rtol is None:
                mistakes.add((name,), "is for error control, with rtol, only", getattr(self, name))
        if self.force and (self.step is None or self.method not in ("verlet", "rk")):
            mistakes.add(("force",), "is for fixed steps of explicit methods only: verlet, rk", self.force)
        if self.max_step is not None and self.min_step is not None and self.min_step > self.max_step:
            mistakes.add(("min_step",), "must not be greater than max_step", self.min_step)
        if self.outputs is not None and self.every is not None:
            mistakes.add(("every",), "give either every or outputs", self.every)
        if self.every is not None and self.until / self.every > _MOST_OUTPUTS:
            mistakes.add(("every",), f"must be at least until / {_MOST_OUTPUTS}", self.every)
        if self.outputs is not None:
            times = self._outputs()
            increase = all(before < after for before, after in pairwise(times))
            if not increase or not all(0 <= time <= self.until for time in times):
                mistakes.add(("outputs",), f"must increase and lie in [0, {self.until}]", self.outputs)
        mistakes.check()
        return self

    @property
    def end(self) -> float:
        """The last time, s."""
        return self.until

    def times(self) -> list[float]:
        """Return the times of the states to record, the first 0, s."""
        if self.outputs is not None:
            return [0.0, *(time for time in self._outputs() if time > 0)]
        if self.every is None:
            steps = _INTERVALS if self.step is None else round(self.until / self.step)
            intervals = max(1, min(_INTERVALS, steps))
            return [self.until * (index / intervals) for index in range(intervals + 1)]
        whole = int(self.until / self.every * (1 - 1e-12))
        return [*(self.every * index for index in range(whole + 1)), self.until]

    def _outputs(self) -> list[float]:
        """Return `outputs`, what is beyond the end by rounding only, as 3 * 0.1 beyond 0.3, put there."""
        return [self.until if self.until < time < self.until * (1 + _ROUNDING) else time for time in self.outputs or ()]

    def _steps(self) -> tuple[float, bool] | tuple[float, float, float | None, float | None, float]:
        if self.step is not None:
            return self.step, self.force
        assert self.rtol is not None
        return self.rtol, self.atol or 0.0, self.first_step, self.max_step, self.min_step or 0.0

    def check(self, model: Model) -> None:
        """Raise `InputError` if a body has no mass or a load is made for statics."""
        mistakes = Mistakes()
        check_density(model, mistakes, "in motion")
        factorises = self.method not in ("verlet", "rk", "rigid")
        states = STATE * len(self.times())
        with mistakes.gather():
            check_memory(
                model.bodies,
                {name: states + (implicit(body) if factorises else EXPLICIT) for name, body in model.bodies.items()},
            )
        for index, load in enumerate(model.loads):
            if load.history == "ramp":
                allowed = "is for statics; in motion allowed are constant and [[t, factor], ...]"
                mistakes.add(("loads", index, "history"), allowed, load.history)
        mistakes.check()

    def start(
        self,
        core: _core.Model,
        threads: int | None,
        progress: ProgressCall,
        *,
        velocity: NDArray[np.float64] | None = None,
        checkpoint: str | os.PathLike[str] | None = None,
        resume: str | os.PathLike[str] | None = None,
    ) -> _core.Run:
        """Run the compiled model."""
        _check_folder(checkpoint)
        with _checkpoint(resume):
            return _core.simulate(
                core,
                until=self.until,
                steps=self._steps(),
                method=self.method,
                alpha=self.alpha,
                rho_inf=self.rho_inf,
                lumped=self.lumped,
                outputs=self.times(),
                velocity=velocity,
                newton=self.newton,
                tolerance=self.tolerance,
                max_iterations=self.max_iterations,
                reuse=self.reuse,
                checkpoint=checkpoint,
                resume=resume,
                threads=threads,
                progress=progress,
            )


class CheckpointWarning(RuntimeWarning):
    """The last checkpoint of a motion could not be written: what the file holds is older, if there is one."""


def _check_folder(checkpoint: str | os.PathLike[str] | None) -> None:
    """Refuse a checkpoint that could not be written, before anything is computed."""
    if checkpoint is None:
        return
    name = os.fspath(checkpoint)
    folder = os.path.dirname(name) or "."
    if os.path.isdir(name):
        raise InputError(Mistake((name,), "is a folder; a checkpoint is a file"))
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        raise InputError(Mistake((name,), f"cannot be written: {folder} must be a folder that is writable"))


@contextmanager
def _checkpoint(path: str | os.PathLike[str] | None) -> Iterator[None]:
    """Name the file in the errors of a checkpoint."""
    if path is None:
        yield
        return
    name = os.fspath(path)
    try:
        with open(name, "rb"):
            pass
    except OSError as error:
        raise InputError(Mistake((name,), f"cannot be read: {error.strerror}")) from None
    try:
        yield
    except _core.InputError as error:
        if error.argument != "checkpoint":
            raise
        raise InputError(Mistake((name,), f"is {error.value}; allowed is {error.allowed}")) from None


class Modes(Input):
    """Natural frequencies and mode shapes of small oscillations, those with the smallest frequencies.

    Parameters
    ----------
    count : int, default 10
        How many, rigid motions of free bodies included.
    load_factor : float, default 0.0
        The model oscillates about its equilibrium at this load factor, found by statics first: prestressed modes. At 0,
        about the shape at rest: loads do not count.

    Raises
    ------
    InputError
        If a value is impossible.
    """

    kind: ClassVar[str] = "modes"
    parameter: ClassVar[str] = "modes"
    unit: ClassVar[str] = "modes"
    history: ClassVar[History] = "ramp"

    count: PositiveInt = 10
    load_factor: float = 0.0

    def check(self, model: Model) -> None:
        """Raise `InputError` if there are fewer modes, a body has no mass, or with loads a body can move rigidly."""
        mistakes = Mistakes()
        check_density(model, mistakes, "where it oscillates")
        with mistakes.gather():
            check_memory(model.bodies, {name: implicit(body) for name, body in model.bodies.items()})
        if self.count > model.dofs:
            mistakes.add(("count",), f"must not be greater than {model.dofs}, the coordinates not fixed", self.count)
        if self.load_factor == 0:
            for index, load in enumerate(model.loads):
                if load.history not in (None, "ramp"):
                    allowed = "acts at load factor 0, too: give the run a load_factor, or the load the history ramp"
                    mistakes.add(("loads", index, "history"), allowed, load.history)
        else:
            with mistakes.gather():
                Static(load_factors=(self.load_factor,)).check(model)
        mistakes.check()


def check_density(model: Model, mistakes: Mistakes, where: str) -> None:
    """Note as mistakes the bodies that have no mass."""
    for name, body in model.bodies.items():
        if body.material.density == 0:
            path = ("bodies", name, "material", "density")
            mistakes.add(path, f"must be greater than 0 {where}", body.material.density)


Run: TypeAlias = Annotated[Static | Dynamic | Modes, PlainValidator(table(Static, Dynamic, Modes, key="kind"))]
