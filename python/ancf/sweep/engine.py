"""The engine: a list of runs, an executor and a log."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import ExitStack
from typing import Any

from tqdm import tqdm

from ancf.sweep.apart import end_idle_workers, kill_busy_workers, run_apart
from ancf.sweep.executors import local_executor
from ancf.sweep.log import Log
from ancf.sweep.outcome import Outcome, lost
from ancf.sweep.variant import Variant

_LAYOUT = "{desc}{percentage:3.0f}%|{bar}| {postfix}[{elapsed}<{remaining}]"


def sweep(
    variants: Sequence[Variant],
    log: str | os.PathLike[str],
    *,
    limit: float | None = None,
    budget: float | None = None,
    executor: Executor | None = None,
    threads: int = 1,
    progress: str | None = None,
) -> list[Outcome | None]:
    """Run variants of scenes, each in a process of its own.

    Parameters
    ----------
    variants : sequence of Variant
        What to run, in this order; equal ones are run once.
    log : str or path
        A file of JSON lines to which each outcome is added as it comes. What an earlier sweep has left there is not run
        again, unless its process crashed or it exceeded a shorter time limit.
    limit : float, optional
        Seconds after which a run is killed; it costs only itself.
    budget : float, optional
        Seconds after which no further run is started.
    executor : concurrent.futures.Executor, optional
        Where to run: `dask_executor`, or if left out `local_executor`, which has as many runs at a time as there are
        processors.
    threads : int, default 1
        Threads of each run.
    progress : str, optional
        What to call the progress bar on standard error; none is shown if left out, or if that is not a terminal.

    Returns
    -------
    list of Outcome or None
        In the order of `variants`; None where the budget did not suffice.

    Raises
    ------
    InputError
        If `log` is another file.
    OSError
        If `log` cannot be written.
    KeyboardInterrupt
        On Ctrl-C, when all runs on this machine have been stopped; all outcomes so far are in `log`.
    """
    end = None if budget is None else time.monotonic() + budget
    book = Log(log)
    todo: dict[str, Variant] = {}
    for variant in variants:
        if not book.settles(variant, limit):
            todo.setdefault(variant.digest, variant)
    bar = tqdm(
        total=sum(variant.effort for variant in variants),
        initial=sum(variant.effort for variant in variants if variant.digest not in todo),
        desc=progress,
        disable=None if progress else True,
        bar_format=_LAYOUT,
    )
    with ExitStack() as stack:
        stack.callback(book.close)
        stack.enter_context(bar)
        stack.callback(end_idle_workers)
        runner = executor or stack.enter_context(local_executor())
        futures = {runner.submit(run_apart, variant.scene, limit, threads): variant for variant in todo.values()}
        try:
            _gather(futures, book, limit, end, bar)
        except BaseException:
            _stop(futures)
            raise
    rows = map(book.row, variants)
    return [None if row is None else Outcome.of(row) for row in rows]


def _gather(
    futures: Mapping[Future[dict[str, Any]], Variant], book: Log, limit: float | None, end: float | None, bar: tqdm[Any]
) -> None:
    """Write outcomes as they come."""
    pending = set(futures)
    while pending:
        left = None if end is None else max(0.0, end - time.monotonic())
        done, pending = wait(pending, left, FIRST_COMPLETED)
        for future in done:
            if not future.cancelled():
                variant = futures[future]
                error = future.exception()
                book.add(variant, limit, future.result() if error is None else lost("crashed", repr(error)))
                bar.update(variant.effort)
        if not done:
            # The budget is spent: what runs may end, what waits is left out.
            end = None
            for future in pending:
                future.cancel()


def _stop(futures: Iterable[Future[dict[str, Any]]]) -> None:
    """Let nothing begin, and end what runs on this machine."""
    for future in futures:
        future.cancel()
    running = [future for future in futures if not future.cancelled()]
    while wait(running, 0.1).not_done:
        kill_busy_workers()
