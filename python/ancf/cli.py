"""The command line; its commands are in `ancf.commands`, with the meaning of the exit status."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence

from ancf.balance import EnergyWarning
from ancf.commands import CANNOT_WRITE, INTERRUPTED, WRONG_INPUT, chart, complain, info, plan, reproduce, run, stability
from ancf.commands.letters import told_letters
from ancf.commands.signals import was_stopped, watch_signals
from ancf.courses import CourseWarning
from ancf.errors import InputError
from ancf.run import CheckpointWarning, PathWarning

_COMMANDS = (run, plan, chart, stability, reproduce, info)


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
    watch_signals()
    # Commands tell them in their own way.
    for told in (EnergyWarning, CourseWarning, CheckpointWarning, PathWarning):
        warnings.simplefilter("ignore", told)
    try:
        with told_letters():
            status: int = options.call(options)
    except InputError as error:
        return complain(error, WRONG_INPUT)
    except RecursionError:
        return complain("the scene is nested too deeply", WRONG_INPUT)
    except KeyboardInterrupt as stopped:
        return complain(str(stopped) or "interrupted", INTERRUPTED)
    except Exception as error:
        # Libraries turn an interruption into errors of their own: a film's writer does.
        if was_stopped():
            return complain("interrupted", INTERRUPTED)
        if isinstance(error, OSError):
            return complain(error, CANNOT_WRITE)
        raise
    return status


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="ancf", description="Thin flexible bodies that move and bend far.")
    commands = parser.add_subparsers(dest="command", required=True)
    for command in _COMMANDS:
        command.add(commands)
    return parser
