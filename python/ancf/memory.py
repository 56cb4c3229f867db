"""Memory that a model or a run needs at least, compared with what there is before anything is computed.

What is refused here could not work: the compiled module cannot go on where memory ends, nor name the reason.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from ancf.bodies import NODAL_VECTORS, Plate
from ancf.errors import InputError, Mistake, show

MODEL = 25
"""Bytes a nodal coordinate of a model that is not run; measured are 28 and more."""
EXPLICIT = 300
"""The same for a run that factorises no tangent."""
STATE = 24
"""The same for a state that is kept: coordinates, velocities and accelerations."""

_FACTORS = 500, 300
_LITTLE = 1e6
"""Bytes for which the system is not asked: that is felt in the shortest runs."""


def implicit(body: Plate) -> float:
    """Return the bytes a nodal coordinate of a run that factorises tangents: they fill up with the width of a body.

    Measured with `thin36`, which needs least, are 700 in a strip of single elements and 5300 for 200 x 200.
    """
    strip, doubled = _FACTORS
    return strip + doubled * math.log2(min(body.divisions))


def check_memory(bodies: Mapping[str, Plate], needs: Mapping[str, float]) -> None:
    """Raise `InputError` if memory cannot suffice.

    Parameters
    ----------
    bodies : mapping of str to Plate
        Of a model.
    needs : mapping of str to float
        Bytes a nodal coordinate of each body, at least.
    """
    coordinates = {name: _coordinates(body) for name, body in bodies.items()}
    needed = sum(coordinates[name] * needs[name] for name in bodies)
    if needed <= _LITTLE:
        return
    there = available()
    if needed > there:
        largest = max(bodies, key=lambda name: coordinates[name] * needs[name])
        message = (
            f"{sum(coordinates.values()):.3g} nodal coordinates need at least {_gigabytes(needed)} of memory, "
            f"{_gigabytes(there)} are available"
        )
        raise InputError(Mistake(("bodies", largest, "divisions"), message, show(bodies[largest].divisions)))


def _coordinates(body: Plate) -> int:
    along_x, along_y = body.divisions
    return 3 * len(NODAL_VECTORS[body.element]) * (along_x + 1) * (along_y + 1)


def _gigabytes(size: float) -> str:
    return f"{size / 1e9:.3g} GB"


def available() -> float:
    """Return the bytes that this process may still take, at most; infinite where the system does not tell."""
    found = [math.inf]
    with suppress(OSError):
        sizes = dict(line.split(":") for line in Path("/proc/meminfo").read_text().splitlines())
        found.append(sum(1024.0 * int(sizes[key].removesuffix("kB")) for key in ("MemAvailable", "SwapFree")))
    # Of a container; "max" where there is no limit.
    with suppress(OSError, ValueError):
        found.append(float(int(Path("/sys/fs/cgroup/memory.max").read_text())))
    with suppress(ImportError, OSError):
        import resource  # noqa: PLC0415  Not on every system.

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit != resource.RLIM_INFINITY:
            taken = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
            found.append(float(limit - taken))
    return max(0.0, min(found))
