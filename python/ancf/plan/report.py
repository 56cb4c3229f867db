"""What a plan says: the settings, why, what was tried, a picture."""

from __future__ import annotations

import json
import math
import os
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ancf.output import replacing
from ancf.plan.ladder import Choice
from ancf.result import Result
from ancf.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCENE, NUMBERS, PICTURE = "scene.toml", "plan.json", "plan.png"


@dataclass(frozen=True)
class Row:
    """A rung that was tried.

    Parameters
    ----------
    settings : str
        Element, mesh and steps.
    predicted_seconds, seconds : float
        Before and after.
    predicted_error, error : float
        Relative; None where nothing was known.
    outcome : str
        "ok", or why it did not reach its end.
    """

    settings: str
    predicted_seconds: float | None
    seconds: float
    predicted_error: float | None
    error: float | None
    outcome: str


@dataclass(frozen=True)
class Plan:
    """The answer of `ancf.plan`.

    Parameters
    ----------
    scene : Scene
        With the chosen settings, ready to be run or written.
    result : Result
        The run of it, which was one of the pilots.
    settings : Choice
        What was chosen.
    tol : float
        The tolerance.
    scale : dict of str to float
        Of each wanted probe its largest change, what errors are relative to.
    error, error_in_time : float
        Estimated errors of the choice, relative: from what is known best, with what that lacks in space; and what it
        lacks in time.
    converged : bool
        Whether the estimates promise the tolerance.
    reasons : list of str
        One sentence each.
    rows : list of Row
        What was tried, in order.
    chosen : int
        Which of the rows was chosen.
    seconds : float
        What the plan took.
    predicted_seconds : float
        What the chosen run was predicted to take.
    threads : int or None
        How many help it; None for all.
    budget : float
        Seconds that the plan was allowed.
    seconds_as_written : float or None
        About what the run of the scene as it was written should have taken; None where that cannot be told.
    """

    scene: Scene = field(repr=False)
    result: Result = field(repr=False)
    settings: Choice = field(repr=False)
    tol: float
    scale: dict[str, float]
    error: float
    error_in_time: float
    converged: bool
    reasons: list[str]
    rows: list[Row] = field(repr=False)
    chosen: int
    seconds: float
    predicted_seconds: float
    threads: int | None
    budget: float = np.inf
    seconds_as_written: float | None = None

    @property
    def choice(self) -> str:
        """The settings in words."""
        return str(self.settings)

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> list[str]:
        width = max(len(row.settings) for row in self.rows)
        head = f"  {'tried':{width}}  predicted s  observed s  predicted error     error"
        lines = [head]
        for index, row in enumerate(self.rows):
            mark = "*" if index == self.chosen else " "
            numbers = f"{_number(row.predicted_seconds):>11}  {_number(row.seconds):>10}"
            numbers += f"  {_number(row.predicted_error):>15}  {_number(row.error):>8}"
            outcome = "" if row.outcome == "ok" else f"  {row.outcome}"
            lines.append(f"{mark} {row.settings:{width}}  {numbers}{outcome}")
        wants = ", ".join(f"{name} {size:.4g}" for name, size in self.scale.items())
        lines.append(f"Chosen: {self.choice}")
        lines += [f"  {reason}" for reason in self.reasons]
        lines.append(f"  Errors are relative to the largest change of what is wanted: {wants}. Tolerance {self.tol:g}.")
        chosen = f"{self.rows[self.chosen].seconds:.2g} s (predicted {self.predicted_seconds:.2g} s)"
        lines.append(f"  The plan took {self.seconds:.2g} s of at most {self.budget:.2g} s, the chosen run {chosen}.")
        lines.append(f"  {self._balance()}")
        return lines

    def _balance(self) -> str:
        """Say after how many runs the plan has paid for itself."""
        written, run = self.seconds_as_written, self.rows[self.chosen].seconds
        if written is None:
            return "What the scene as it was written would take cannot be told before it is run: its steps are free."
        sentence = f"The scene as it was written would take about {written:.2g} s"
        if written <= run:
            return f"{sentence}, less than what the tolerance needs."
        if not self.converged:
            return f"{sentence}."
        # The run of the choice was one of the pilots.
        runs = max(1, math.ceil((self.seconds - run) / (written - run)))
        return f"{sentence}: the plan has paid for itself after {runs} run{'' if runs == 1 else 's'}."

    def document(self) -> dict[str, Any]:
        """Return the numbers of the plan as plain values, as in plan.json."""
        names = [n for n in self.__dataclass_fields__ if n not in ("scene", "result", "settings", "rows")]
        numbers = {name: getattr(self, name) for name in names}
        return {"choice": self.choice} | numbers | {"rows": [asdict(row) for row in self.rows]}

    def plot(self) -> Figure:
        """Draw errors over costs of what was tried, and what is wanted of the choice.

        Returns
        -------
        matplotlib.figure.Figure
            To be saved with its ``savefig``.
        """
        from ancf.plan.picture import draw  # noqa: PLC0415  Matplotlib takes longer to import than most pilots.

        return draw(self)

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Write scene.toml, the chosen scene, plan.json and plan.png.

        Parameters
        ----------
        folder : str or path
            Where to; it exists.

        Raises
        ------
        OSError
            If a file cannot be written.
        """
        place = Path(folder)
        self.scene.write(place / SCENE)
        with replacing(place / NUMBERS, place / f"{PICTURE}") as (numbers, picture):
            numbers.write_text(json.dumps(self.document(), indent=1) + "\n", encoding="utf-8")
            self.plot().savefig(picture, format="png")


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.2g}"
