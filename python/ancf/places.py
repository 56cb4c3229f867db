"""Places on a body: corners, edges, points and all of it."""

from __future__ import annotations

import sys
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainValidator

from ancf.errors import one_of

Domain: TypeAlias = tuple[tuple[float, float], tuple[float, float]]

CORNERS = ("corner:x0y0", "corner:x1y0", "corner:x1y1", "corner:x0y1")
EDGES = ("edge:x0", "edge:x1", "edge:y0", "edge:y1")
ALL = "all"
POINT = "[x, y]"


def is_number(value: object) -> bool:
    """Tell whether `value` is a finite number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def _place(*allowed: str) -> PlainValidator:
    def check(value: Any) -> Any:
        if isinstance(value, str) and value in allowed:
            return value
        if POINT in allowed and isinstance(value, tuple) and len(value) == 2 and all(map(is_number, value)):
            return float(value[0]), float(value[1])
        raise ValueError(one_of(allowed, value))

    return PlainValidator(check)


Anywhere = Annotated[str | tuple[float, float], _place(*CORNERS, *EDGES, POINT, ALL)]
CornerOrPoint = Annotated[str | tuple[float, float], _place(*CORNERS, POINT)]
Edge = Annotated[str, _place(*EDGES)]


def points_at(at: str | tuple[float, float], domain: Domain, number: int) -> NDArray[np.float64]:
    """Return material points that show where a place is.

    Parameters
    ----------
    at : str or pair of float
        The place.
    domain : pair of pairs of float
        The ranges of the natural coordinates.
    number : int
        How many along a side.

    Returns
    -------
    ndarray, shape (points, 2)
        Natural coordinates.
    """
    if not isinstance(at, str):
        return np.array([at])
    ends = at.partition(":")[2]
    ranges = []
    for axis, (low, high) in zip("xy", domain, strict=True):
        named = [value for value, name in ((low, f"{axis}0"), (high, f"{axis}1")) if name in ends]
        ranges.append(np.array(named) if named else np.linspace(low, high, number))
    return np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 2)
