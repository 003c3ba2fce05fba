"""Find local minima that are mere dips."""

import numpy as np
from numba import njit

from amprep.arrays import Bools, Floats, Int64s


@njit(cache=True)
def find_dips(
    height: Floats, first: Int64s, neighbours: Int64s, lowest: Int64s, depth: float, level: float
) -> Bools:
    """Tell which local minima are less deep than `depth`: lower ground is reached without climbing that high.

    Parameters
    ----------
    height
        ``(n,)`` mm of each point.
    first, neighbours
        ``(n + 1,)`` and ``(k,)``: the points that edges lead to from each point.
    lowest
        ``(q,)`` a point of each local minimum.
    depth
        Least height (mm) of the lowest saddle above the minimum.
    level
        Heights that differ by less (mm) are equal.
    """
    is_dip = np.zeros(len(lowest), np.bool_)
    seen = np.full(len(height), -1, np.int64)
    stack = np.empty(len(height), np.int64)
    for i in range(len(lowest)):
        start = lowest[i]
        low = height[start]
        seen[start], stack[0], count = i, start, 1
        while count > 0 and not is_dip[i]:
            count -= 1
            point = stack[count]
            for k in range(first[point], first[point + 1]):
                other = neighbours[k]
                if height[other] < low - level:
                    is_dip[i] = True
                elif seen[other] != i and height[other] < low + depth:
                    seen[other] = i
                    stack[count] = other
                    count += 1
    return is_dip
