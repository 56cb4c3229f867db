"""Films of results."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.figure import Figure

from ancf.errors import InputError, Mistake, show
from ancf.modal import ModalResult
from ancf.plot import heading, mode_name
from ancf.result import Result
from ancf.stage import Stage
from ancf.text import plain_text

_FACETS = 600
_FRAMES = 100
_FRAMES_OF_MODES = 30
_FRAMES_PER_SECOND = 20
_DPI = 90


def animate(result: Result, path: str | os.PathLike[str], title: str = "") -> None:
    """Write the motion as a film, of up to 100 of its states.

    Parameters
    ----------
    result : Result
        What to draw.
    path : str or path
        The file; ".gif" or, with ffmpeg, ".mp4".
    title : str, optional
        Written above.

    Raises
    ------
    InputError
        If the file has another ending, or ffmpeg is needed and missing.
    """
    with plain_text():
        _animate(result, path, title)


def animate_mode(result: ModalResult, path: str | os.PathLike[str], title: str = "", mode: int | None = None) -> None:
    """Write one mode as a film, see `ModalResult.animate`."""
    shown = result.visible()
    if mode is None and not shown:
        raise InputError(Mistake(("result",), "must hold at least one mode to be drawn"))
    number = shown[0] if mode is None else mode
    q = result.oscillation(number, np.linspace(0, 2 * np.pi, _FRAMES_OF_MODES, endpoint=False))
    name = mode_name(result, number)
    with plain_text():
        figure = _figure()
        stage = Stage(figure, result.model, q, _FACETS, rest=result.q, bar=False)
        _film(path, figure, stage, [f"{title}, {name}" if title else name] * len(q), range(len(q)))


def _animate(result: Result, path: str | os.PathLike[str], title: str) -> None:
    figure = _figure()
    stage = Stage(figure, result.model, result.q, _FACETS)
    states = np.unique(np.linspace(0, len(result.t) - 1, _FRAMES).round().astype(int)).tolist()
    _film(path, figure, stage, [heading(result, state, title) for state in states], states)


def _figure() -> Figure:
    return Figure(figsize=(7, 6), dpi=_DPI, layout="constrained")


def _film(
    path: str | os.PathLike[str], figure: Figure, stage: Stage, headings: Sequence[str], states: Sequence[int]
) -> None:
    writer = check_film(path)
    with writer.saving(figure, str(path), _DPI):
        for frame, (name, state) in enumerate(zip(headings, states, strict=True)):
            figure.suptitle(name)
            artists = stage.draw(state)
            if frame == 0:
                # Laid out once: half the time, and nothing trembles.
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()
            for artist in artists:
                artist.remove()


def check_film(path: str | os.PathLike[str]) -> AbstractMovieWriter:
    """Return what writes such a file.

    Parameters
    ----------
    path : str or path
        The file.

    Raises
    ------
    InputError
        If it ends neither in ".gif" nor in ".mp4", or ffmpeg is needed and missing.
    """
    ending = Path(path).suffix
    if ending == ".gif":
        return PillowWriter(fps=_FRAMES_PER_SECOND)
    if ending != ".mp4":
        raise InputError(Mistake((str(path),), f"must end in .gif or .mp4, not {show(ending)}"))
    if not FFMpegWriter.isAvailable():
        raise InputError(Mistake((str(path),), "needs the program ffmpeg, which was not found; a .gif does not"))
    return FFMpegWriter(fps=_FRAMES_PER_SECOND)
