"""Kinds of run: statics, motion and modes, with their options."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from pydantic import PlainValidator

from ancf.inputs import table
from ancf.run.base import ProgressCall
from ancf.run.checkpoint import CheckpointWarning
from ancf.run.dynamic import Dynamic, Method
from ancf.run.modes import Modes
from ancf.run.static import PathWarning, Static

__all__ = ["CheckpointWarning", "Dynamic", "Method", "Modes", "PathWarning", "ProgressCall", "Run", "Static"]

Run: TypeAlias = Annotated[Static | Dynamic | Modes, PlainValidator(table(Static, Dynamic, Modes, key="kind"))]
