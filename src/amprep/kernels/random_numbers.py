"""Random numbers for compiled functions, whose state the caller owns."""

import numpy as np
from numpy.typing import NDArray

from amprep.kernels.helper import helper


@helper
def uniform(state: NDArray[np.uint64]) -> float:
    """Return a number from 0 to 1 and step the state (xorshift64*, Vigna 2016, doi:10.1145/2845077)."""
    x = state[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    state[0] = x
    return float((x * np.uint64(0x2545F4914F6CDD1D)) >> np.uint64(11)) / 9007199254740992.0
