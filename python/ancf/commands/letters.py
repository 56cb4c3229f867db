"""Letters that no font has are boxes in the pictures: one line tells which, in place of a warning for each."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from ancf.commands import OK, complain

_MISSING = re.compile(r"Glyph (\d+) .* missing from font")


@contextmanager
def told_letters() -> Iterator[None]:
    """Gather what Matplotlib says of letters in the `with` statement, and tell it at the end."""
    letters: dict[str, None] = {}

    def show(  # noqa: PLR0917  The arguments of `warnings.showwarning`.
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        if missing := _MISSING.match(str(message)):
            letters[chr(int(missing[1]))] = None
        else:
            shown(message, category, filename, lineno, file, line)

    with warnings.catch_warnings():
        warnings.filterwarnings("always", message=_MISSING.pattern)
        shown, warnings.showwarning = warnings.showwarning, show
        try:
            yield
        finally:
            if letters:
                complain(f"warning: no font has these letters, which are boxes in the pictures: {''.join(letters)}", OK)
