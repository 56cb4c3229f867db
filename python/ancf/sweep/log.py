"""The log of a sweep: a file of JSON lines, one for each outcome, written as it comes."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from ancf.errors import InputError, Mistake
from ancf.sweep.variant import Variant


class Log:
    """Outcomes on disk.

    Parameters
    ----------
    path : str or path
        The file; what is in it already is read, and the line that a killed sweep left half written is removed.

    Raises
    ------
    InputError
        If the file is not the log of a sweep.
    OSError
        If it cannot be read or written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path = Path(path)
        self._rows: dict[str, dict[str, Any]] = {}
        if self._path.exists():
            self._read()
        self._file = self._path.open("a", encoding="utf-8")

    def _read(self) -> None:
        text = self._path.read_bytes()
        whole = text.rfind(b"\n") + 1
        if whole < len(text):
            os.truncate(self._path, whole)
        try:
            for line in text[:whole].splitlines():
                row = json.loads(line)
                self._rows[row["digest"]] = row
        except (ValueError, KeyError, TypeError):
            raise InputError(Mistake((str(self._path),), "is not the log of a sweep")) from None

    def row(self, variant: Variant) -> dict[str, Any] | None:
        """Return what is known of a run."""
        return self._rows.get(variant.digest)

    def settles(self, variant: Variant, limit: float | None) -> bool:
        """Tell whether a run need not be tried again, as where its process crashed or it now has more time."""
        row = self.row(variant)
        if row is None or row["status"] == "crashed":
            return False
        return row["status"] != "time limit" or (limit is not None and limit <= row["limit"])

    def add(self, variant: Variant, limit: float | None, summary: dict[str, Any]) -> None:
        """Write the outcome of a run."""
        known = {"digest": variant.digest, "settings": dict(variant.settings), "repeat": variant.repeat, "limit": limit}
        row = known | summary
        self._file.write(json.dumps(row, allow_nan=False) + "\n")
        self._file.flush()
        self._rows[variant.digest] = row

    def close(self) -> None:
        """Close the file."""
        self._file.close()
