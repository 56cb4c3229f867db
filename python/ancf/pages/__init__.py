"""Reports made of headings, paragraphs, tables and pictures, written as Markdown and as one self-contained HTML page.

Text may hold ``code``, as in Markdown between single backquotes, and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True)
class Heading:
    """A heading; level 1 is the title of the report."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Points:
    """A list of short texts."""

    items: Sequence[str]


@dataclass(frozen=True)
class Table:
    """A table of texts, each row as long as the head."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Picture:
    """A picture beside the report, which the HTML page holds in itself."""

    file: str
    caption: str


@dataclass(frozen=True)
class Fold:
    """Blocks under a line that unfolds them."""

    summary: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Script:
    """HTML as it is, which Markdown leaves out."""

    html: str


Block: TypeAlias = Heading | Text | Points | Table | Picture | Fold | Script
