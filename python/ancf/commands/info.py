"""``ancf info``: versions, threads and CPU features."""

from __future__ import annotations

import argparse
import platform
from typing import TYPE_CHECKING

import numpy as np

from ancf import _core
from ancf.commands import OK

if TYPE_CHECKING:
    from ancf.commands import Subparsers


def add(commands: Subparsers) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser("info", help="show versions, threads and CPU features")
    parser.set_defaults(call=call)


def call(_: argparse.Namespace) -> int:
    """Run the command and return the exit status."""
    versions = {"ancf": _core.__version__, "python": platform.python_version(), "numpy": np.__version__}
    rows = {**versions, **_core.info()}
    width = max(map(len, rows))
    print("\n".join(f"{name:{width}}  {value}" for name, value in rows.items()))
    return OK
