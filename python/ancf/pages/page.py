"""Reports as HTML pages that need nothing else: styles, pictures and scripts are in them."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from pathlib import Path

from ancf.pages import Block, Fold, Heading, Picture, Points, Script, Table, Text

_NUMBER = re.compile(r"[-+~<>]?\s*\d[\d.]*(e[-+]?\d+)?\s*(%|s|x|m|mm)?")


def to_html(title: str, blocks: Sequence[Block], folder: Path) -> str:
    """Return a report as an HTML page.

    Parameters
    ----------
    title : str
        Of the window.
    blocks : sequence
        Of the classes of `ancf.pages`.
    folder : Path
        Where the pictures are.

    Returns
    -------
    str
        The page.
    """
    style = files("ancf.pages").joinpath("style.css").read_text(encoding="utf-8")
    body = "\n".join(_write(block, folder) for block in blocks)
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{escape(title)}</title>\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<style>\n{style}</style>\n</head>\n'
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def _write(block: Block, folder: Path) -> str:  # noqa: PLR0911  One for each kind of block.
    match block:
        case Heading(text, level):
            return f"<h{level}>{_inline(text)}</h{level}>"
        case Text(text):
            return f"<p>{_inline(text)}</p>"
        case Points(items):
            return f"<ul>{''.join(f'<li>{_inline(item)}</li>' for item in items)}</ul>"
        case Table(head, rows):
            top = "".join(f"<th>{_inline(cell)}</th>" for cell in head)
            lines = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
            return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{lines}</tbody></table></div>'
        case Picture(file, caption):
            data = base64.b64encode((folder / file).read_bytes()).decode()
            image = f'<img src="data:image/png;base64,{data}" alt="{escape(caption)}">'
            return f"<figure>{image}<figcaption>{_inline(caption)}</figcaption></figure>"
        case Script(html):
            return html
        case Fold(summary, inner):
            inside = "\n".join(_write(part, folder) for part in inner)
            return f"<details><summary>{_inline(summary)}</summary>{inside}</details>"


def _cell(text: str) -> str:
    kind = ' class="number"' if _NUMBER.fullmatch(text.strip()) else ""
    return f"<td{kind}>{_inline(text)}</td>"


def _inline(text: str) -> str:
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text, quote=False))
