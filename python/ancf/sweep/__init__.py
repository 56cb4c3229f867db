"""Many variants of a scene, each run in a process of its own, each outcome on disk as it comes.

    variants -> sweep -> executor -> run_apart -> worker process
                  |
                  v
            log: one JSON line for each outcome

`Variant` is a scene with some settings replaced, `sweep` runs a list of them on any `concurrent.futures.Executor` and
goes on where an earlier call with the same log stopped. A run that fails, crashes or exceeds its time costs only
itself.

>>> from ancf import load_scene
>>> from ancf.sweep import Variant, sweep
>>> scene = load_scene("examples/pendulum.toml")  # doctest: +SKIP
>>> variants = [Variant.of(scene, step=step) for step in (1e-3, 2e-3)]  # doctest: +SKIP
>>> outcomes = sweep(variants, "runs.jsonl", limit=60)  # doctest: +SKIP
>>> [outcome.status for outcome in outcomes]  # doctest: +SKIP
['ok', 'ok']
"""

from ancf.sweep.engine import sweep
from ancf.sweep.executors import dask_executor
from ancf.sweep.outcome import Outcome
from ancf.sweep.timing import Timing, time_alone
from ancf.sweep.variant import Variant

__all__ = ["Outcome", "Timing", "Variant", "dask_executor", "sweep", "time_alone"]
