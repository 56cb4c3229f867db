"""Where a sweep runs: the processors of this machine, or a Dask cluster."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from ancf.errors import InputError, Mistake


def local_executor(jobs: int | None = None) -> Executor:
    """Return an executor for this machine; its threads only wait for the processes of `run_apart`.

    Parameters
    ----------
    jobs : int, optional
        How many runs at a time; one for each processor if left out.
    """
    return ThreadPoolExecutor(jobs or processors())


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


@contextmanager
def dask_executor(address: str) -> Iterator[Executor]:
    """Connect to a Dask cluster, on whose workers `ancf` is installed.

    Parameters
    ----------
    address : str
        Of its scheduler, as "tcp://192.168.0.1:8786".

    Raises
    ------
    InputError
        If Dask is not installed, or there is no cluster.
    """
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise InputError(Mistake(("dask",), 'needs Dask: pip install "ancf[dask]"')) from None
    try:
        client = distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(Mistake(("dask",), f"no scheduler answers: {error}", address)) from None
    with client, client.get_executor() as executor:
        yield executor
