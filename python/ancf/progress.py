"""Progress of a run: a bar on a terminal, or the user's own function."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from ancf.errors import InputError, Mistake, show

Progress: TypeAlias = Callable[[float], Any] | bool | None


@contextmanager
def meter(progress: Progress, end: float, unit: str) -> Iterator[Callable[[float], Any] | None]:
    """Make the function that a run calls with the time, or the load factor, that it has reached.

    Parameters
    ----------
    progress : bool or callable, optional
        None or False is silent, True a bar on standard error if that is a terminal, a callable is taken as it is.
    end : float
        Where the run ends.
    unit : str
        The unit of the time; empty for a load factor.
    """
    if callable(progress):
        yield progress
    elif progress is None or progress is False:
        yield None
    elif progress is True:
        from tqdm import tqdm  # noqa: PLC0415, only where a bar is wanted: it takes a tenth of our own import

        layout = "{percentage:3.0f}%|{bar}| {n:.4g}/{total:.4g}{unit} [{elapsed}<{remaining}]"
        with tqdm(total=end, unit=f" {unit}" if unit else "", disable=None, bar_format=layout) as bar:
            yield lambda reached: bar.update(reached - bar.n)
    else:
        raise InputError(Mistake(("progress",), "must be true, false or a function of one number", show(progress)))
