"""What commands that run many scenes have in common."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from ancf.sweep import dask_executor


def add_sweep_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what says where the runs take place."""
    parser.add_argument(
        "--dask", metavar="ADDRESS", help="run on the Dask cluster with this scheduler; timings are still taken here"
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bars and no table")


@contextmanager
def executor(options: argparse.Namespace) -> Iterator[Executor | None]:
    """Return where the runs take place; None is this machine."""
    if options.dask is None:
        yield None
    else:
        with dask_executor(options.dask) as runner:
            yield runner
