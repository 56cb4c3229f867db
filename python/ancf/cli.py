"""The command line: ``ancf run`` and ``ancf info``.

Exit status: 0 success, 1 a file could not be written, 2 a mistake in the arguments or the scene, 3 the run failed half
way, 130 interrupted.
"""

from __future__ import annotations

import argparse
import platform
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ancf import _core
from ancf.errors import InputError, Interrupted
from ancf.film import check_film
from ancf.output import make_folder, remove_folders, replacing, write_result
from ancf.report import describe
from ancf.scene import load_scene

OK, CANNOT_WRITE, WRONG_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Those of the process if left out.

    Returns
    -------
    int
        The exit status.
    """
    options = _parser().parse_args(arguments)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    try:
        return _info() if options.command == "info" else _run(options)
    except InputError as error:
        return _complain(error, WRONG_INPUT)
    except RecursionError:
        return _complain("the scene is nested too deeply", WRONG_INPUT)
    except OSError as error:
        return _complain(error, CANNOT_WRITE)
    except KeyboardInterrupt:
        return _complain("interrupted", INTERRUPTED)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="ancf", description="Thin flexible bodies that move and bend far.")
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="run a scene file", description="Run a scene file.")
    run.add_argument("scene", type=Path, metavar="SCENE.toml")
    run.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for the results")
    run.add_argument("--plot", action="store_true", help="draw plate.png")
    run.add_argument(
        "--animate", nargs="?", const="gif", choices=("gif", "mp4"), help="make motion.gif, or motion.mp4 with ffmpeg"
    )
    run.add_argument("--checkpoint", type=Path, metavar="FILE", help="keep there what is needed to go on")
    run.add_argument("--resume", type=Path, metavar="FILE", help="go on from a checkpoint, and keep it up to date")
    run.add_argument("--threads", type=_positive, metavar="N", help="default: all")
    run.add_argument("--quiet", action="store_true", help="no progress bar and no table")
    commands.add_parser("info", help="show versions, threads and CPU features")
    return parser


def _positive(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 1024:
        raise argparse.ArgumentTypeError(f"{text} is not a whole number from 1 to 1024")
    return int(text)


def _run(options: argparse.Namespace) -> int:
    folder = options.output
    scene = load_scene(options.scene)
    film = None if options.animate is None else folder / f"motion.{options.animate}"
    if film is not None:
        check_film(film)
    made = make_folder(folder)
    try:
        result = scene.solve(
            checkpoint=options.checkpoint or options.resume,
            resume=options.resume,
            threads=options.threads,
            progress=not options.quiet and sys.stderr is not None,
            throw=False,
        )
    except InputError:
        remove_folders(made)
        raise
    except Interrupted as stopped:
        write_result(folder, scene.title, stopped.result)
        return _complain(f"{stopped}; the results up to there are in {folder}", INTERRUPTED)
    write_result(folder, scene.title, result)
    if options.plot and len(result.t):
        with replacing(folder / "plate.png") as (picture,):
            result.plot(scene.title).savefig(picture)
    if film is not None and len(result.t):
        with replacing(film) as (temporary,):
            result.animate(temporary, scene.title)
    if not options.quiet:
        print(describe(scene.title, result))
    if result.status == "failed":
        return _complain(f"the run failed: {result.reason}\ntry: {result.advice}", FAILED)
    return OK


def _info() -> int:
    versions = {"ancf": _core.__version__, "python": platform.python_version(), "numpy": np.__version__}
    rows = {**versions, **_core.info()}
    width = max(map(len, rows))
    print("\n".join(f"{name:{width}}  {value}" for name, value in rows.items()))
    return OK


def _complain(message: object, status: int) -> int:
    if sys.stderr is not None:
        print(f"ancf: {message}", file=sys.stderr)
    return status
