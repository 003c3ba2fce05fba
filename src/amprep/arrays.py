"""Names of array types, one meaning each, and the copy that freezes an array."""

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
"""Signed integers of any width, where a record does not fix it."""

MeshArrays = tuple[Floats, Int64s]
"""Vertices ``(n, 3)`` mm and triangles ``(m, 3)`` of a closed mesh."""

CONTACT_TOLERANCE = 1e-3
"""mm; penetration up to it is contact, and a box too large by at most it fits."""


def frozen(values: Any, dtype: DTypeLike, width: int | None = None) -> NDArray[Any]:
    """Return a read-only C-contiguous copy of `values`; with `width`, of shape ``(n, width)``.

    Raises
    ------
    ValueError
        If the values do not fill rows of `width`.
    """
    array = np.array(values, dtype=dtype, order="C")
    if width is not None:
        array = array.reshape(-1, width)
    array.setflags(write=False)
    return array
