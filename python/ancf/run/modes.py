"""Modes."""

from __future__ import annotations

from typing import ClassVar

from ancf.errors import Mistakes
from ancf.inputs import Input, PositiveInt
from ancf.loads import History
from ancf.memory import check_memory, implicit
from ancf.model import Model
from ancf.run.base import check_density
from ancf.run.static import Static


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
