"""Runs in processes of their own, which are killed when their time is over.

`subprocess` rather than `multiprocessing`: the workers of other executors may be daemons, to which the latter refuses
children.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from ancf.sweep.outcome import lost

_START_LIMIT = 60.0
_lock = threading.Lock()
_idle: list[_Worker] = []
_busy: set[_Worker] = set()


def run_apart(scene: Mapping[str, Any], limit: float | None, threads: int) -> dict[str, Any]:
    """Run a scene in another process; that of an earlier run is used again.

    Parameters
    ----------
    scene : mapping
        Its document.
    limit : float or None
        Seconds after which the process is killed.
    threads : int
        Threads of the run.

    Returns
    -------
    dict
        The summary of the run; of one that left no result just its status and the reason.
    """
    with _lock:
        worker = _idle.pop() if _idle else _Worker()
        _busy.add(worker)
    summary = worker.ask({"scene": dict(scene), "threads": threads}, limit)
    with _lock:
        _busy.discard(worker)
        if worker.usable:
            _idle.append(worker)
    return summary


def end_idle_workers() -> None:
    """End the processes that wait for runs."""
    with _lock:
        while _idle:
            _idle.pop().end()


def kill_busy_workers() -> None:
    """Kill the processes that run something; their runs become "crashed"."""
    with _lock:
        for worker in _busy:
            worker.kill()


class _Worker:
    """A process that answers requests, one after the other."""

    def __init__(self) -> None:
        self.usable = True
        self._log = tempfile.TemporaryFile()  # noqa: SIM115  It lives as long as the process.
        self._process = subprocess.Popen(
            [sys.executable, "-m", "ancf.sweep.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            encoding="utf-8",
            # Ctrl-C reaches only the sweep, which ends its workers.
            start_new_session=True,
        )
        self._ready = False

    def ask(self, request: dict[str, Any], limit: float | None) -> dict[str, Any]:
        """Return the answer, or why there is none; the process has then ended."""
        line, late = "", False
        # The time that a new process takes to start is not that of the run.
        self._ready = self._ready or self._read(_START_LIMIT)[0] == "ready\n"
        if self._ready and self._write(json.dumps(request) + "\n"):
            line, late = self._read(limit)
        if late or not line:
            self.end()
        if line:
            summary: dict[str, Any] = json.loads(line)
            return summary
        return lost("time limit", f"stopped after {limit:g} s") if late else lost("crashed", self._last_words)

    def kill(self) -> None:
        """Kill the process, from any thread."""
        self._process.kill()

    def end(self) -> None:
        """Kill the process and release what it held."""
        self.usable = False
        self._process.kill()
        code = self._process.wait()
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").split("\n")
        told = next((line.strip() for line in reversed(lines) if line.strip()), "no message")
        self._last_words = f"the process ended with status {code}: {told}"
        self._log.close()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with suppress(BrokenPipeError):  # A request that was never read.
                    stream.close()

    def _write(self, line: str) -> bool:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(line)
            self._process.stdin.flush()
        except BrokenPipeError:
            return False
        return True

    def _read(self, limit: float | None) -> tuple[str, bool]:
        """Return a whole line, nothing if the process ends before; and whether it was killed for its time."""
        assert self._process.stdout is not None
        late = threading.Event()

        def stop() -> None:
            late.set()
            self._process.kill()

        timer = threading.Timer(threading.TIMEOUT_MAX if limit is None else limit, stop)
        timer.start()
        try:
            line = self._process.stdout.readline()
        finally:
            timer.cancel()
            timer.join()
        return line if line.endswith("\n") else "", late.is_set()
