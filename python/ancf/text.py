"""Text in pictures: as it is written, in whatever script."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib as mpl
from matplotlib.font_manager import fontManager

_FAMILIES = (
    "Noto Sans CJK SC",
    "Source Han Sans SC",
    "WenQuanYi Micro Hei",
    "Microsoft YaHei",
    "PingFang SC",
    "Yu Gothic",
    "Hiragino Sans",
    "Malgun Gothic",
    "Arial Unicode MS",
)
"""Fonts of common systems with characters that Matplotlib's own one lacks."""


@contextmanager
def plain_text() -> Iterator[None]:
    """Draw text without taking dollars for formulas, what the usual font lacks in one of the system that has it."""
    installed = fontManager.get_font_names()
    families = [*mpl.rcParams["font.family"], *(family for family in _FAMILIES if family in installed)]
    with mpl.rc_context({"text.parse_math": False, "font.family": families}):
        yield
