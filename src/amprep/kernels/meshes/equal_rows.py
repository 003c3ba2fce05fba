"""Equal rows of an array by hashing, in time proportional to their number.

Strategy: an open-addressed table of twice as many places as rows holds the first row of each value. A row is mixed to a
hash and probes places one after another until it finds an equal row or an empty place. Crafted rows could make the
probes many; their total is limited, and the caller sorts the rows instead.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Int64s

_MOST_PROBES = 32
"""Mean number of probes for each row above which the kernel gives up; random rows need fewer than 2."""


@njit(cache=True)
def first_of_equal(rows: NDArray[np.uint64], first: Int64s) -> bool:
    """Find for each row the index of the first equal row.

    Parameters
    ----------
    rows
        ``(n, k)`` uint64.
    first
        ``(n,)``, filled.

    Returns
    -------
    done
        False if too many rows have the same hash; `first` is then of no use.
    """
    count, width = rows.shape
    places = 4
    while places < 2 * count:
        places *= 2
    table = np.full(places, -1, np.int32)
    left = _MOST_PROBES * count + 1000
    for i in range(count):
        mixed = np.uint64(0x9E3779B97F4A7C15)
        for j in range(width):
            mixed = (mixed ^ rows[i, j]) * np.uint64(0xBF58476D1CE4E5B9)
            mixed ^= mixed >> np.uint64(29)
        mixed *= np.uint64(0x94D049BB133111EB)
        place = np.int64((mixed ^ (mixed >> np.uint64(31))) & np.uint64(places - 1))
        while True:
            other = table[place]
            if other < 0:
                table[place] = i
                first[i] = i
                break
            equal = True
            for j in range(width):
                if rows[other, j] != rows[i, j]:
                    equal = False
                    break
            if equal:
                first[i] = other
                break
            left -= 1
            if left < 0:
                return False
            place = (place + 1) & (places - 1)
    return True
