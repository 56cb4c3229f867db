"""Tables of the scripts in the pages of the documentation."""

import re
from collections.abc import Iterable
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1] / "docs"


def put(page: str, mark: str, lines: Iterable[str]) -> None:
    """Put lines between the marks ``<!-- mark -->`` and ``<!-- /mark -->`` of a page, named from docs."""
    text = "".join(f"{line}\n" for line in lines)
    path = DOCS / page
    marks = rf"(<!-- {mark} -->\n).*?(<!-- /{mark} -->)"
    old = path.read_text(encoding="utf-8")
    path.write_text(re.sub(marks, lambda match: match[1] + text + match[2], old, flags=re.DOTALL), encoding="utf-8")
