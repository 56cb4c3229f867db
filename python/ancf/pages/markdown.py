"""Reports as Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from ancf.pages import Block, Fold, Heading, Picture, Points, Script, Table, Text


def to_markdown(blocks: Sequence[Block]) -> str:
    """Return a report as Markdown.

    Parameters
    ----------
    blocks : sequence
        Of the classes of `ancf.pages`.

    Returns
    -------
    str
        With a newline at its end.
    """
    return "\n\n".join(part for part in map(_write, blocks) if part) + "\n"


def _write(block: Block) -> str:  # noqa: PLR0911  One for each kind of block.
    match block:
        case Heading(text, level):
            return f"{'#' * level} {text}"
        case Text(text):
            return text
        case Points(items):
            return "\n".join(f"* {item}" for item in items)
        case Table(head, rows):
            lines = [head, ["---"] * len(head), *rows]
            return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)
        case Picture(file, caption):
            return f"![{caption}]({file})"
        case Script():
            return ""
        case Fold(summary, inner):
            return to_markdown([Text(f"{summary}:"), *inner]).strip()
