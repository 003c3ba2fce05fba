"""Number equal rows of integers."""

import numpy as np
from numba import njit

from amprep.arrays import Int64s


@njit(cache=True)
def label_rows(rows: Int64s, table: Int64s, label: Int64s) -> int:
    """Number equal rows in order of first appearance, in linear time, by a hash table with open addressing.

    Parameters
    ----------
    rows
        ``(n, 3)``.
    table
        Hash table filled with -1; its length is a power of two above 2 n.
    label
        ``(n,)``, written in place.

    Returns
    -------
    count
        Number of different rows.
    """
    mask = np.int64(len(table) - 1)
    count = 0
    for i in range(len(rows)):
        a, b, c = rows[i, 0], rows[i, 1], rows[i, 2]
        # each value is folded to 32 bits, so that no product overflows
        mixed = ((a ^ (a >> 32)) & 0xFFFFFFFF) * 73856093
        mixed ^= ((b ^ (b >> 32)) & 0xFFFFFFFF) * 19349663
        mixed ^= ((c ^ (c >> 32)) & 0xFFFFFFFF) * 83492791
        slot = (mixed ^ (mixed >> 29) ^ (mixed >> 13)) & mask
        while True:
            j = table[slot]
            if j < 0:
                table[slot] = i
                label[i] = count
                count += 1
                break
            if rows[j, 0] == a and rows[j, 1] == b and rows[j, 2] == c:
                label[i] = label[j]
                break
            slot = (slot + 1) & mask
    return count
