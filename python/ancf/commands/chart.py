"""``ancf chart``: what accuracy costs in a scene."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ancf.commands import OK, positive, seconds
from ancf.commands.sweeping import add_sweep_arguments, executor
from ancf.output import folder_for
from ancf.scene import load_scene

if TYPE_CHECKING:
    from ancf.commands import Subparsers

_LOG = "runs.jsonl"


def add(commands: Subparsers) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        "chart",
        help="chart speed against accuracy",
        description="Run a scene with many elements, meshes, methods and tolerances, and chart what accuracy costs. "
        "The same command again goes on with what there was no time for.",
    )
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder for the chart")
    parser.add_argument(
        "--axes",
        nargs="+",
        metavar="NAME[=VALUES]",
        help="settings to vary, others stay as in the scene: element membrane mesh=0.5,1,2 (times the divisions of the "
        "scene) method=hht,rk rtol step newton, or any other key of [body], [material] and [run] with its values",
    )
    parser.add_argument(
        "--budget", type=seconds, default=240.0, metavar="SECONDS", help="about how long it may take (default: 240)"
    )
    parser.add_argument(
        "--repeats", type=positive, default=3, metavar="N", help="how often each run is timed (default: 3)"
    )
    add_sweep_arguments(parser)
    parser.set_defaults(call=call)


def call(options: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
    from ancf.chart import default_axes, measure, read_axes, write_chart  # noqa: PLC0415  Pictures are slow to import.
    from ancf.chart.report import describe  # noqa: PLC0415

    scene = load_scene(options.scene)
    axes = read_axes(options.axes, scene) if options.axes else default_axes(scene)
    with folder_for(options.output), executor(options) as runner:
        chart = measure(
            scene,
            axes,
            options.output / _LOG,
            budget=options.budget,
            executor=runner,
            repeats=options.repeats,
            progress=not options.quiet and sys.stderr is not None,
        )
    paths = write_chart(options.output, chart)
    if not options.quiet:
        print(describe(chart))
        print(f"{len(chart.points)} points, {len(chart.lost)} runs without one; see {paths[-1]}")
    return OK
