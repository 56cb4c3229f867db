"""``ancf reproduce``: published examples, run again."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ancf.commands import OK, positive, seconds
from ancf.commands.sweeping import add_sweep_arguments, executor
from ancf.output import make_folder

if TYPE_CHECKING:
    from ancf.commands import Subparsers

_STUDIES = ("dufva-shabana-2005",)


def add(commands: Subparsers) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "reproduce",
        help="run the examples of a paper",
        description="Run every example of a paper and write a report: ours beside the figures of the paper.",
    )
    parser.add_argument("study", choices=_STUDIES)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for the report")
    parser.add_argument("--quick", action="store_true", help="coarse meshes only, to see that it works")
    parser.add_argument(
        "--repeats", type=positive, default=5, metavar="N", help="how often each run is timed (default: 5)"
    )
    parser.add_argument(
        "--limit", type=seconds, default=300.0, metavar="SECONDS", help="when a run is stopped (default: 300)"
    )
    add_sweep_arguments(parser)
    parser.set_defaults(call=call)


def call(options: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
    from ancf.reproduce import dufva_shabana  # noqa: PLC0415  Pictures are slow to import.

    make_folder(options.output)
    with executor(options) as runner:
        paths = dufva_shabana.reproduce(
            options.output,
            quick=options.quick,
            repeats=options.repeats,
            limit=options.limit,
            executor=runner,
            progress=not options.quiet and sys.stderr is not None,
        )
    if not options.quiet:
        print(f"see {paths[-1]}")
    return OK
