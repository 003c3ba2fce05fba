"""Names of array types, read-only copies of arrays, and where groups of rows start."""

from collections.abc import Iterable, Sized
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Floats = NDArray[np.float64]
Float32s = NDArray[np.float32]
Int64s = NDArray[np.int64]
Int32s = NDArray[np.int32]
Int16s = NDArray[np.int16]
Int8s = NDArray[np.int8]
Bytes = NDArray[np.uint8]
Bools = NDArray[np.bool_]

Ints = NDArray[np.signedinteger[Any]]
"""Signed integers of any width."""

MeshArrays = tuple[Floats, Int64s]
"""Vertices ``(n, 3)`` mm and triangles ``(m, 3)`` of a closed mesh."""

CONTACT_TOLERANCE = 1e-3
"""Tolerance for lengths (mm): less penetration counts as contact, and a box that is this much too large fits."""


def frozen(values: Any, dtype: DTypeLike, width: int | None = None) -> NDArray[Any]:
    """Return a read-only C-contiguous copy of `values`; with `width`, of shape ``(n, width)``.

    Raises
    ------
    ValueError
        When the number of values is not a multiple of `width`.
    """
    array = np.array(values, dtype=dtype, order="C")
    if width is not None:
        array = array.reshape(-1, width)
    array.setflags(write=False)
    return array


def starts_of(groups: Iterable[Sized]) -> Int64s:
    """Return the first row of each of n groups among the rows of all, and the number of these, ``(n + 1,)``."""
    return np.cumsum([0, *map(len, groups)]).astype(np.int64)
