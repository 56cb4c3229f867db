"""Motion."""

from __future__ import annotations

import os
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, ClassVar, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ancf import _core
from ancf.errors import Mistakes
from ancf.inputs import Positive
from ancf.loads import History
from ancf.memory import EXPLICIT, STATE, check_memory, implicit
from ancf.model import Model
from ancf.run.base import LoadedRun, ProgressCall, check_density
from ancf.run.checkpoint import check_folder, reading

_INTERVALS = 100
_MOST_OUTPUTS = 1_000_000
_MOST_STEPS = 10**12
_ROUNDING = 1e-12

Method: TypeAlias = Literal[
    "hht", "generalized_alpha", "newmark", "tr_bdf2", "esdirk", "energy_momentum", "verlet", "rk", "rigid"
]


class Dynamic(LoadedRun):
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
        Of "verlet": use a diagonal mass matrix, on which gravity acts.
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
        check_folder(checkpoint)
        with reading(resume):
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
