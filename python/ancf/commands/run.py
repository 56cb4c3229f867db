"""``ancf run``: run a scene file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ancf.commands import FAILED, INTERRUPTED, OK, complain, positive
from ancf.errors import InputError, Interrupted
from ancf.film import check_film
from ancf.output import make_folder, remove_folders, replacing, write_result
from ancf.report import describe
from ancf.scene import load_scene

if TYPE_CHECKING:
    from ancf.commands import Subparsers


def add(commands: Subparsers) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser("run", help="run a scene file", description="Run a scene file.")
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for the results")
    parser.add_argument("--plot", action="store_true", help="draw plate.png")
    parser.add_argument(
        "--animate", nargs="?", const="gif", choices=("gif", "mp4"), help="make motion.gif, or motion.mp4 with ffmpeg"
    )
    parser.add_argument("--checkpoint", type=Path, metavar="FILE", help="keep there what is needed to go on")
    parser.add_argument("--resume", type=Path, metavar="FILE", help="go on from a checkpoint, and keep it up to date")
    parser.add_argument("--threads", type=positive, metavar="N", help="default: all")
    parser.add_argument("--quiet", action="store_true", help="no progress bar and no table")
    parser.set_defaults(call=call)


def call(options: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
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
        return complain(f"{stopped}; the results up to there are in {folder}", INTERRUPTED)
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
        return complain(f"the run failed: {result.reason}\ntry: {result.advice}", FAILED)
    return OK
