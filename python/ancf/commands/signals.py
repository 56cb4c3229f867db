"""Signals that end a command: Ctrl-C and the request to terminate."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)

_MOMENT = 0.01
"""s."""

_received = False
_deferred = False
_told_elsewhere = sys.unraisablehook


def watch_signals() -> None:
    """Let the first signal raise `KeyboardInterrupt`, and ignore those that follow: the command ends on it."""
    global _received, _told_elsewhere  # noqa: PLW0603  A process has one state of its signals.
    _received = False
    if sys.unraisablehook is not _raise_again:
        _told_elsewhere, sys.unraisablehook = sys.unraisablehook, _raise_again
    for number in _SIGNALS:
        signal.signal(number, _receive)


def was_stopped() -> bool:
    """Tell whether there was a signal."""
    return _received


@contextmanager
def deferred_signals() -> Iterator[None]:
    """Let a signal raise `KeyboardInterrupt` at the end of the `with` statement only: results are being written."""
    global _deferred  # noqa: PLW0603  As above.
    before, _deferred = _received, True
    try:
        yield
    finally:
        _deferred = False
    if _received and not before:
        raise KeyboardInterrupt


def _raise_again(lost: sys.UnraisableHookArgs) -> None:
    """Raise `KeyboardInterrupt` once more, where Python cannot take it out of a finalizer."""
    if isinstance(lost.exc_value, KeyboardInterrupt):
        signal.signal(signal.SIGINT, _receive)
        threading.Thread(target=_interrupt_later, daemon=True).start()
    else:
        _told_elsewhere(lost)


def _interrupt_later() -> None:
    """Interrupt the main thread once it has left `_raise_again`: there it would be lost like the first time."""
    main = threading.main_thread().ident
    while True:
        time.sleep(_MOMENT)
        stack = traceback.walk_stack(sys._current_frames().get(main or 0))
        if all(frame.f_code is not _raise_again.__code__ for frame, _ in stack):
            _thread.interrupt_main()
            return


def _receive(_number: int, _frame: FrameType | None) -> None:
    global _received  # noqa: PLW0603  As above.
    _received = True
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if not _deferred:
        raise KeyboardInterrupt
