"""Array types of the reference path, and `einsum` with a type."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IndexArray: TypeAlias = NDArray[np.intp]
BoolArray: TypeAlias = NDArray[np.bool_]


def einsum(subscripts: str, *operands: NDArray[Any], optimize: bool = False) -> FloatArray:
    """Sum products over repeated axes, as `numpy.einsum`, with a float array as result."""
    return np.asarray(np.einsum(subscripts, *operands, optimize=optimize), dtype=np.float64)
