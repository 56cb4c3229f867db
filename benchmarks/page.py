"""Tables of the scripts in the pages of the documentation."""

import argparse
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


def print_or_write(what: str, page: str, **tables: Iterable[str]) -> None:
    """Print tables, or with the option ``--write`` put them between their marks of a page, named from docs."""
    parser = argparse.ArgumentParser(description=what)
    parser.add_argument("--write", action="store_true", help=f"into docs/{page}")
    write = parser.parse_args().write
    for index, (mark, lines) in enumerate(tables.items()):
        if write:
            put(page, mark, lines)
            continue
        if index:
            print()
        for line in lines:
            print(line, flush=True)
