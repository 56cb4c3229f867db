"""The commands of the command line, one file each: ``add`` gives it its arguments, ``call`` runs it."""

from __future__ import annotations

import argparse
import math
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    Subparsers = argparse._SubParsersAction[argparse.ArgumentParser]

OK, CANNOT_WRITE, WRONG_INPUT, FAILED, NOT_PROMISED, INTERRUPTED = 0, 1, 2, 3, 4, 130
"""Exit status: success, a file could not be written, a mistake in the arguments or the scene, the run failed half way,
the tolerance of a plan is not reached, interrupted."""


def complain(message: object, status: int) -> int:
    """Print `message` to standard error, if there is one, and return `status`."""
    if sys.stderr is not None:
        print(f"ancf: {message}", file=sys.stderr)
    return status


def seconds(text: str) -> float:
    """Read a duration, s."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a number of seconds greater than 0")
    return value


def positive(text: str) -> int:
    """Read a number of threads or repetitions, from 1 to 1024."""
    if not text.isdecimal() or not 1 <= int(text) <= 1024:
        raise argparse.ArgumentTypeError(f"{text} is not a whole number from 1 to 1024")
    return int(text)
