"""``ancf run``: run a scene file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ancf.commands import FAILED, INTERRUPTED, OK, complain, positive
from ancf.commands.plan import add_options, make_plan, promise
from ancf.commands.signals import deferred_signals
from ancf.errors import InputError, Interrupted, Mistake
from ancf.fields import check_fields
from ancf.modal import AnyResult
from ancf.output import (
    FIELDS,
    PICTURE,
    earlier_aside,
    make_folder,
    remove_extras,
    remove_folders,
    replacing,
    write_result,
)
from ancf.report import describe
from ancf.scene import Scene, load_scene, run_scene

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
    parser.add_argument("--fields", action="store_true", help="write fields.pvd for ParaView and PyVista")
    parser.add_argument("--checkpoint", type=Path, metavar="FILE", help="keep there what is needed to go on")
    parser.add_argument("--resume", type=Path, metavar="FILE", help="go on from a checkpoint, and keep it up to date")
    parser.add_argument("--threads", type=positive, metavar="N", help="default: all")
    parser.add_argument("--quiet", action="store_true", help="no progress bar and no table")
    add_options(parser, tol=None)
    parser.set_defaults(call=call)


def call(options: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
    folder = options.output
    for name in ("want", "budget"):
        if options.tol is None and getattr(options, name) is not None:
            raise InputError(Mistake((name,), "is for planned runs, with --tol"))
    if options.tol is not None and (options.checkpoint or options.resume):
        raise InputError(Mistake(("tol",), "plans without checkpoints: run the scene that the plan has written"))
    scene = load_scene(options.scene)
    film = None if options.animate is None else folder / f"motion.{options.animate}"
    if film is not None:
        from ancf.film import check_film  # noqa: PLC0415  Matplotlib takes longer to import than most scenes to run.

        check_film(film)
    if options.fields:
        check_fields(folder / FIELDS)
    with earlier_aside(folder):
        planned = None if options.tol is None else make_plan(options, folder)
        made = make_folder(folder)
        try:
            result = _solve(options, scene) if planned is None else planned.result  # the chosen pilot was a whole run
        except InputError:
            remove_folders(made)
            raise
        except Interrupted as stopped:
            write_result(folder, scene.title, stopped.result)
            remove_extras(folder)
            return complain(f"{stopped}; the results up to there are in {folder}", INTERRUPTED)
        with deferred_signals():
            write_result(folder, scene.title, result)
            remove_extras(folder)
    if result.states:
        _write_extras(options, scene.title, result, film)
    if not options.quiet:
        print(describe(scene.title, result))
    for doubt in result.warnings:
        complain(f"warning: {doubt}", OK)
    if result.status == "failed":
        return complain(f"the run failed: {result.reason}\ntry: {result.advice}", FAILED)
    return OK if planned is None else promise(planned, folder)


def _solve(options: argparse.Namespace, scene: Scene) -> AnyResult:
    return run_scene(
        scene,
        checkpoint=options.checkpoint or options.resume,
        resume=options.resume,
        threads=options.threads,
        progress=not options.quiet and sys.stderr is not None,
        throw=False,
    )


def _write_extras(options: argparse.Namespace, title: str, result: AnyResult, film: Path | None) -> None:
    folder = options.output
    if options.fields:
        result.write_fields(folder / FIELDS)
    if options.plot:
        with replacing(folder / PICTURE) as (picture,):
            result.plot(title).savefig(picture)
    if film is not None:
        with replacing(film) as (temporary,):
            result.animate(temporary, title)
