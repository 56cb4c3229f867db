"""``ancf plan``: find the cheapest settings of a scene that are precise enough."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from ancf.commands import NOT_PROMISED, OK, complain, positive
from ancf.errors import Interrupted
from ancf.output import make_folder, remove_folders
from ancf.plan import Plan, plan

if TYPE_CHECKING:
    from ancf.commands import Subparsers


def add(commands: Subparsers) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "plan",
        help="find the cheapest settings of a scene that are precise enough",
        description="Find the cheapest settings for which the error in what is wanted stays below a tolerance.",
    )
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    add_options(parser, tol=1e-2)
    parser.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="folder for the answer; default: SCENE-plan in this folder"
    )
    parser.add_argument("--threads", type=positive, metavar="N", help="of the pilots; default: all")
    parser.add_argument("--quiet", action="store_true", help="no table")
    parser.set_defaults(call=call)


def add_options(parser: argparse.ArgumentParser, tol: float | None) -> None:
    """Add the arguments that say what is planned, with a default for the tolerance."""
    default = "" if tol is None else f"; default: {tol:g}"
    parser.add_argument(
        "--tol",
        type=_number,
        default=tol,
        metavar="T",
        help=f"plan: largest error, relative to the largest change of what is wanted{default}",
    )
    parser.add_argument(
        "--want", action="append", metavar="PROBE", help="plan: what must be precise; default: all probes"
    )
    parser.add_argument(
        "--budget",
        type=_number,
        metavar="S",
        help="plan: seconds it may take; default: 9 times what the scene as written should take, from 20 to 300",
    )


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is not a number")
    return value


def call(options: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
    folder = options.output or Path(f"{options.scene.stem}-plan")
    return promise(make_plan(options, folder), folder)


def promise(found: Plan, folder: Path) -> int:
    """Return the exit status of a plan; complain if its estimates do not reach the tolerance."""
    if found.converged:
        return OK
    error = found.error + found.error_in_time
    message = (
        f"the tolerance {found.tol:g} is not reached: the estimated error is {error:.2g}; {folder} has the best found"
    )
    return complain(message, NOT_PROMISED)


def make_plan(options: argparse.Namespace, folder: Path) -> Plan:
    """Plan a scene file and write the answer to a folder, also that of an interrupted plan; nothing if it fails."""
    made = make_folder(folder)
    try:
        found = plan(options.scene, want=options.want, tol=options.tol, budget=options.budget, threads=options.threads)
    except Interrupted as stopped:
        _tell(stopped.result, options, folder)
        raise Interrupted(f"{stopped}; {folder} has the best found", stopped.result) from stopped
    except BaseException:
        remove_folders(made)
        raise
    _tell(found, options, folder)
    return found


def _tell(found: Plan, options: argparse.Namespace, folder: Path) -> None:
    found.write(folder)
    if not options.quiet:
        print(f"{found.scene.title or options.scene.stem}, planned")
        print(found)
        print(f"  Written to {folder}; to run it: ancf run {folder / 'scene.toml'} -o DIR", flush=True)
