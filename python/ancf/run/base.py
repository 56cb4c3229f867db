"""What statics and motion have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Field

from ancf import _core
from ancf.errors import Mistakes
from ancf.inputs import Input, Positive, PositiveInt
from ancf.loads import History
from ancf.model import Model

ProgressCall: TypeAlias = Callable[[float], Any] | None


class LoadedRun(Input, ABC):
    """A run in which loads act, with the settings of Newton's method."""

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


def check_density(model: Model, mistakes: Mistakes, where: str) -> None:
    """Note as mistakes the bodies that have no mass."""
    for name, body in model.bodies.items():
        if body.material.density == 0:
            path = ("bodies", name, "material", "density")
            mistakes.add(path, f"must be greater than 0 {where}", body.material.density)
