"""Array types of the records, and the copy that freezes them."""

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.signedinteger[Any]]
Bytes = NDArray[np.uint8]
Bools = NDArray[np.bool_]

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
