"""The files of a run: summary.json and result.npz, written whole or not at all."""

from __future__ import annotations

import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from ancf.errors import InputError, Mistake
from ancf.modal import AnyResult, ModalResult
from ancf.records import Reaction
from ancf.run import Static

SUMMARY = "summary.json"
STATES = "result.npz"
PICTURE = "plate.png"
FILMS = ("motion.gif", "motion.mp4")
FIELDS = "fields.pvd"
EARLIER = "earlier"


def make_folder(folder: Path) -> list[Path]:
    """Make a folder that can be written to.

    Parameters
    ----------
    folder : Path
        The folder, with any that are missing above it.

    Returns
    -------
    list of Path
        The folders that were made, innermost first.

    Raises
    ------
    InputError
        If it cannot be made or written to; nothing is left behind.
    """
    made: list[Path] = []
    try:
        for missing in reversed([path for path in (folder, *folder.parents) if not path.exists()]):
            missing.mkdir()
            made.insert(0, missing)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        remove_folders(made)
        raise InputError(Mistake((str(folder),), f"cannot be written to: {error.strerror}")) from None
    return made


def remove_folders(folders: list[Path]) -> None:
    """Remove empty folders, innermost first."""
    for folder in folders:
        folder.rmdir()


@contextmanager
def folder_for(folder: Path) -> Iterator[None]:
    """Make a folder as `make_folder` does; wrong input that shows before anything is written leaves none behind."""
    made = make_folder(folder)
    try:
        yield
    except InputError:
        if not any(folder.iterdir()):
            remove_folders(made)
        raise


def remove_extras(folder: Path) -> None:
    """Remove the pictures and fields of an earlier run: the results that they show have been replaced."""
    fields = (folder / FIELDS).with_suffix("")
    for path in (*(folder / name for name in (PICTURE, *FILMS, FIELDS)), *fields.glob("[0-9]*.vtu")):
        path.unlink(missing_ok=True)
    with suppress(OSError):
        fields.rmdir()


@contextmanager
def earlier_aside(folder: Path) -> Iterator[None]:
    """Keep the results of an earlier run in a folder of their own until the `with` statement ends.

    So a run that is killed leaves no summary that could be taken for its own, and does not lose what was there before.
    """
    aside = folder / EARLIER
    for name in (SUMMARY, STATES):
        if (folder / name).exists():
            aside.mkdir(exist_ok=True)
            (folder / name).replace(aside / name)
    try:
        yield
    finally:
        if aside.is_dir():
            if not (folder / SUMMARY).exists():
                for path in aside.iterdir():
                    path.replace(folder / path.name)
            shutil.rmtree(aside, ignore_errors=True)


@contextmanager
def replacing(*paths: Path) -> Iterator[tuple[Path, ...]]:
    """Give temporary names for files, which take their places together when the `with` statement ends well.

    An error that names no file, as that of a full disk, names those that could not be written.
    """
    temporary = tuple(path.with_name(f".{os.getpid()}-{path.name}") for path in paths)
    try:
        yield temporary
        for source, target in zip(temporary, paths, strict=True):
            source.replace(target)
    except OSError as error:
        if error.filename is None:
            error.filename = ", ".join(map(str, paths))
        raise
    finally:
        for source in temporary:
            source.unlink(missing_ok=True)


def write_result(folder: Path, title: str, result: AnyResult) -> None:
    """Write summary.json and result.npz: the arrays t, q, v, a, or of modes frequency, eigenvalue, shapes, q.

    Parameters
    ----------
    folder : Path
        Where to; made again if it was removed meanwhile.
    title : str
        Of the scene.
    result : Result or ModalResult
        What to write.

    Raises
    ------
    OSError
        If a file cannot be written; an earlier run's files are left as they were.
    """
    names = ("frequency", "eigenvalue", "shapes", "q") if isinstance(result, ModalResult) else ("t", "q", "v", "a")
    arrays = {name: getattr(result, name) for name in names}
    folder.mkdir(parents=True, exist_ok=True)
    with replacing(folder / STATES, folder / SUMMARY) as (states, summary):
        with states.open("wb") as file:
            np.savez_compressed(file, **arrays)
        summary.write_text(json.dumps(summarize(title, result), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def summarize(title: str, result: AnyResult) -> dict[str, Any]:
    """Return what summary.json holds; numbers that are not finite become None.

    Parameters
    ----------
    title : str
        Of the scene.
    result : Result or ModalResult
        What to summarize.

    Returns
    -------
    dict
        Of plain Python values.
    """
    summary: dict[str, Any] = {
        "title": title,
        "status": result.status,
        "reached": _plain(result.reached),
        "reason": result.reason,
        "advice": result.advice,
        "warnings": list(result.warnings),
        "counts": _plain(result.counts),
        "seconds": _plain(result.seconds),
    }
    if isinstance(result, ModalResult):
        return summary | {"jumps": _plain(result.jumps), "modes": {"frequency": _plain(result.frequency)}}
    energy = {field.name: getattr(result.energy, field.name) for field in fields(result.energy)}
    probes = {name: {"t": _plain(probe.t), "value": _plain(probe.value)} for name, probe in result.probes.items()}
    reactions = [_reaction(reaction) for reaction in result.reactions]
    summary |= {"probes": probes, "energy": _plain(energy), "reactions": reactions}
    if isinstance(result.run, Static):
        summary["jumps"] = _plain(result.jumps)
    return summary


def _reaction(reaction: Reaction) -> dict[str, Any]:
    arrays = {name: _plain(getattr(reaction, name)) for name in ("t", "point", "force", "moment")}
    return {"body": reaction.support.body, "at": _plain(reaction.support.at), **arrays}


def _plain(value: Any) -> Any:
    match value:
        case np.ndarray() | np.generic():
            return _plain(value.tolist())
        case dict():
            return {key: _plain(item) for key, item in value.items()}
        case list() | tuple():
            return [_plain(item) for item in value]
        case float() if not math.isfinite(value):
            return None
        case _:
            return value
