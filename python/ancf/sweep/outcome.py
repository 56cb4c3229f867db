"""What is kept of a run in a sweep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeAlias

import numpy as np

from ancf.records import Energy, Record

Ending: TypeAlias = Literal["ok", "failed", "refused", "time limit", "crashed"]


@dataclass(frozen=True)
class Outcome:
    """How a run ended, and what it recorded up to there.

    Parameters
    ----------
    status : {"ok", "failed", "refused", "time limit", "crashed"}
        "failed" half way, "refused" as a scene that cannot be run, killed at the "time limit", or "crashed" with its
        process.
    reason, advice : str
        Why it did not end well and what to try.
    reached : float
        The last time, s, or load factor; nan if it never began.
    counts : dict of str to int
        As in `Result`; empty unless the status is "ok" or "failed", as all below.
    seconds : dict of str to float
        As in `Result`.
    probes : dict of str to Record
        As in `Result`.
    energy : Energy or None
        As in `Result`.
    """

    status: Ending
    reason: str
    advice: str
    reached: float
    counts: dict[str, int]
    seconds: dict[str, float]
    probes: dict[str, Record]
    energy: Energy | None

    @classmethod
    def of(cls, summary: Mapping[str, Any]) -> Outcome:
        """Make an outcome of what `ancf.output.summarize` returned, or of the few entries that `lost` gives."""
        energy = summary.get("energy")
        reached = summary.get("reached")
        return cls(
            status=summary["status"],
            reason=summary["reason"],
            advice=summary.get("advice", ""),
            reached=np.nan if reached is None else reached,
            counts=summary.get("counts", {}),
            seconds=summary.get("seconds", {}),
            probes={name: Record(_array(row["t"]), _array(row["value"])) for name, row in _items(summary, "probes")},
            energy=None if energy is None else Energy(**{row.name: _array(energy[row.name]) for row in fields(Energy)}),
        )


def lost(status: Ending, reason: str) -> dict[str, Any]:
    """Return the summary of a run that left no result."""
    return {"status": status, "reason": reason}


def _items(summary: Mapping[str, Any], key: str) -> Any:
    return summary.get(key, {}).items()


def _array(values: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array(values, dtype=np.float64)  # None, for what is not finite, becomes nan.
