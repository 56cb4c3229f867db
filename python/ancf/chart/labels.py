"""What a run is called: its element, mesh, method and step, read from its scene."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Label:
    """The settings of a run in words.

    Parameters
    ----------
    element : str
        Element and membrane, "thin36 full".
    mesh : str
        Divisions, "8 x 8".
    method : str
        The method of time integration or of Newton's iteration.
    accuracy : str
        Step or tolerance, "rtol 0.001".
    """

    element: str
    mesh: str
    method: str
    accuracy: str

    @classmethod
    def of(cls, scene: Mapping[str, Any]) -> Label:
        """Read the label from the document of a scene."""
        bodies = scene["body"].values()
        run = scene["run"]
        if run["kind"] == "static":
            method, accuracy = f"{run.get('newton', 'mip')} Newton", f"tolerance {run.get('tolerance', 1e-8):g}"
        else:
            method = run.get("method", "hht")
            accuracy = f"step {run['step']:g} s" if "step" in run else f"rtol {run['rtol']:g}"
        return cls(
            element=_join(map(_element, bodies)),
            mesh=_join(" x ".join(map(str, body["divisions"])) for body in bodies),
            method=method,
            accuracy=accuracy,
        )

    @property
    def space(self) -> str:
        """What decides about the error in space."""
        return f"{self.element}, {self.mesh}"

    @property
    def time(self) -> str:
        """What decides about the error in time."""
        return f"{self.method}, {self.accuracy}"

    def __str__(self) -> str:
        return f"{self.space}, {self.time}"


def _element(body: Mapping[str, Any]) -> str:
    element = str(body.get("element", "thin36"))
    return element if element.startswith("full48") else f"{element} {body.get('membrane', 'projected')}"


def _join(texts: Iterable[str]) -> str:
    return " + ".join(dict.fromkeys(texts))
