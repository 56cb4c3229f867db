"""``ancf stability``: where methods fail."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ancf.commands import FAILED, OK, complain, seconds
from ancf.commands.sweeping import add_sweep_arguments, executor
from ancf.errors import InputError, Mistake
from ancf.output import folder_for
from ancf.scene import load_scene

if TYPE_CHECKING:
    from ancf.commands import Subparsers

_LOG = "runs.jsonl"

_OF_A_MAP = ("against", "methods", "steps", "limit")


def add(commands: Subparsers) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "stability",
        help="map where methods fail",
        description="Run a scene in motion with every method over steps and a stiffness parameter, and map how the "
        "runs went; or run the suite of cases in which such programs fail.",
    )
    parser.add_argument("scene", type=Path, metavar="SCENE.toml", nargs="?")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for the map")
    parser.add_argument("--suite", action="store_true", help="run the suite instead of a scene")
    parser.add_argument("--quick", action="store_true", help="of the suite only what takes a few seconds")
    parser.add_argument(
        "--against",
        metavar="NAME[=VALUES]",
        help="the stiffness parameter: E (default), thickness, mesh, viscosity, with values if wanted: E=1e5,1e7",
    )
    parser.add_argument("--methods", nargs="+", metavar="NAME", help="default: six of them")
    parser.add_argument("--steps", nargs="+", type=seconds, metavar="SECONDS", help="default: the motion in 10 to 640")
    parser.add_argument("--limit", type=seconds, metavar="SECONDS", help="when a run is stopped (default: 60)")
    add_sweep_arguments(parser)
    parser.set_defaults(call=call)


def call(options: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
    if options.suite == (options.scene is not None):
        raise InputError(Mistake(("stability",), "give either a scene or --suite"))
    for name in _OF_A_MAP if options.suite else ():
        if getattr(options, name) is not None:
            raise InputError(Mistake((name,), "is for the map of a scene, not for --suite"))
    if options.quick and not options.suite:
        raise InputError(Mistake(("quick",), "is for --suite"))
    return _suite(options) if options.suite else _map(options)


def _map(options: argparse.Namespace) -> int:
    from ancf.chart.axes import read_values  # noqa: PLC0415  Pictures are slow to import.
    from ancf.stability import scan, write_map  # noqa: PLC0415
    from ancf.stability.report import describe  # noqa: PLC0415

    scene = load_scene(options.scene)
    parameter, given, values = (options.against or "E").partition("=")
    with folder_for(options.output), executor(options) as runner:
        found = scan(
            scene,
            options.output / _LOG,
            parameter=parameter,
            values=read_values(parameter, values) if given else None,
            methods=options.methods,
            steps=options.steps,
            limit=options.limit or 60.0,
            executor=runner,
            progress=not options.quiet and sys.stderr is not None,
        )
    paths = write_map(options.output, found)
    if not options.quiet:
        print(describe(found))
        print(f"see {paths[-1]}")
    return OK


def _suite(options: argparse.Namespace) -> int:
    from ancf.stability import run_suite  # noqa: PLC0415  As above.

    with folder_for(options.output), executor(options) as runner:
        verdicts = run_suite(
            options.output / _LOG,
            quick=options.quick,
            executor=runner,
            progress=not options.quiet and sys.stderr is not None,
        )
    failed = [verdict for verdict in verdicts if verdict.problems]
    if not options.quiet:
        for verdict in verdicts:
            print(f"{'FAILED' if verdict.problems else 'ok    '}  {verdict.case.name}")
            for line in (*verdict.problems, verdict.told):
                print(f"        {line}")
    if failed:
        return complain(f"{len(failed)} of {len(verdicts)} cases were not as expected", FAILED)
    return OK
