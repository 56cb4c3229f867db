"""The files of checkpoints, from which a motion goes on."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from ancf import _core
from ancf.errors import InputError, Mistake


class CheckpointWarning(RuntimeWarning):
    """The last checkpoint of a motion could not be written: what the file holds is older, if there is one."""


def check_folder(checkpoint: str | os.PathLike[str] | None) -> None:
    """Refuse a checkpoint that could not be written, before anything is computed."""
    if checkpoint is None:
        return
    name = os.fspath(checkpoint)
    folder = os.path.dirname(name) or "."
    if os.path.isdir(name):
        raise InputError(Mistake((name,), "is a folder; a checkpoint is a file"))
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        raise InputError(Mistake((name,), f"cannot be written: {folder} must be a folder that is writable"))


@contextmanager
def reading(path: str | os.PathLike[str] | None) -> Iterator[None]:
    """Name the file in the errors of a checkpoint."""
    if path is None:
        yield
        return
    name = os.fspath(path)
    try:
        with open(name, "rb"):
            pass
    except OSError as error:
        raise InputError(Mistake((name,), f"cannot be read: {error.strerror}")) from None
    try:
        yield
    except _core.InputError as error:
        if error.argument != "checkpoint":
            raise
        raise InputError(Mistake((name,), f"is {error.value}; allowed is {error.allowed}")) from None
