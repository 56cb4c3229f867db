"""``python -m ancf.sweep.worker``: the process in which the runs of a sweep take place, one after the other.

It reads one JSON line for each run from standard input, ``{"scene": document, "threads": n}``, and answers each with
one JSON line on standard output, the summary of the run. It ends with its input, so that no run outlives who wants it.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
import warnings
from queue import SimpleQueue
from typing import Any

from ancf.balance import EnergyWarning
from ancf.courses import CourseWarning
from ancf.errors import InputError
from ancf.output import summarize
from ancf.scene import Scene, run_scene
from ancf.sweep.outcome import lost


def answer(scene: dict[str, Any], threads: int) -> dict[str, Any]:
    """Run a scene.

    Parameters
    ----------
    scene : dict
        Its document.
    threads : int
        How many.

    Returns
    -------
    dict
        The summary of the run, with the processor time of all threads among its seconds; of a scene that is wrong just
        the status "refused" and the reason.
    """
    try:
        made = Scene.of(scene)
        began = time.process_time()
        result = run_scene(made, threads=threads, throw=False)
    except InputError as error:
        return lost("refused", str(error))
    summary = summarize("", result)
    summary["seconds"]["processor"] = time.process_time() - began
    return summary


def main() -> None:
    """Answer until the input ends."""
    # The summary has them.
    for category in (EnergyWarning, CourseWarning):
        warnings.simplefilter("ignore", category)
    # What a run prints must not be taken for an answer.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    requests: SimpleQueue[str] = SimpleQueue()
    threading.Thread(target=_read, args=(requests,), daemon=True).start()
    print("ready", file=answers, flush=True)
    while True:
        print(json.dumps(answer(**json.loads(requests.get())), allow_nan=False), file=answers, flush=True)


def _read(requests: SimpleQueue[str]) -> None:
    for line in sys.stdin:
        requests.put(line)
    os._exit(0)


if __name__ == "__main__":
    main()
