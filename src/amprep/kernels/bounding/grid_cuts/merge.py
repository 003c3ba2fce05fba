"""Merge sets of cells whose common hull adds little volume."""

import numpy as np
from numba import njit

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.kernels.bounding.grid_cuts.extremes import add_point, estimate_volume, set_frame
from amprep.kernels.bounding.grid_cuts.records import DIRECTIONS, Directions
from amprep.kernels.helper import helper

# Strategy. A matrix holds by how much the hull of each pair of sets that touch is larger than both. The least entry is
# merged, and the entries of the new set are computed again: about a thousand estimates for 64 sets. The extreme points
# of two sets are chosen again for their common box, so that errors do not add up.


@helper
def _distinct(index: Int32s, kept: Int32s) -> int:
    """Write the different values of a row to another one; return their number."""
    count = 0
    for d in range(DIRECTIONS):
        known = False
        for e in range(count):
            known |= kept[e] == index[d]
        if not known:
            kept[count] = index[d]
            count += 1
    return count


@helper
def _measure(
    points: Floats,
    extreme: Int32s,
    count: Int64s,
    i: int,
    j: int,
    directions: Directions,
    work: tuple[Floats, Floats, Floats, Floats, Floats, Int32s],
) -> float:
    """Find the extreme points of two sets; return the volume of their common hull, nearly."""
    low, high, frame, local, value, index = work
    for c in range(3):
        low[c], high[c] = np.inf, -np.inf
    for k in range(2):
        at = i if k == 0 else j
        for e in range(count[at]):
            for c in range(3):
                low[c] = min(low[c], points[extreme[at, e], c])
                high[c] = max(high[c], points[extreme[at, e], c])
    set_frame(low, high, frame)
    for d in range(DIRECTIONS):
        value[d] = -np.inf
    for k in range(2):
        at = i if k == 0 else j
        for e in range(count[at]):
            add_point(points, extreme[at, e], frame, directions, value, index)
    return float(estimate_volume(points, frame, directions, value, index, local))


@njit(cache=True, nogil=True)
def merge_sets(
    points: Floats,
    extreme: Int32s,
    near: Bools,
    directions: Directions,
    volume: Floats,
    merged: Int64s,
    total: Floats,
) -> None:
    """Merge two sets, again and again, the hull of which adds least volume to theirs, until one is left.

    Parameters
    ----------
    points, extreme
        The points, and for each of n sets the extreme points, ``(n, DIRECTIONS)``; modified.
    near
        ``(n, n)`` pairs that are preferred, because they touch; modified.
    directions
        The directions.
    volume
        ``(n,)`` volumes of the hulls of the sets; modified.
    merged
        ``(n - 1, 2)``, receives the sets that are merged; the first gets the place of both.
    total
        ``(n,)``, receives the total volume of the hulls of 1, 2, ... n sets.
    """
    n = len(extreme)
    work = (
        np.empty(3),
        np.empty(3),
        np.empty(6),
        np.empty((DIRECTIONS, 3)),
        np.empty(DIRECTIONS),
        np.empty(DIRECTIONS, np.int32),
    )
    kept = np.empty(DIRECTIONS, np.int32)
    alive = np.ones(n, np.bool_)
    count = np.empty(n, np.int64)
    cost = np.full((n, n), np.inf)
    for i in range(n):
        count[i] = _distinct(extreme[i], kept)
        for d in range(count[i]):
            extreme[i, d] = kept[d]
    a = -1
    for step in range(n):
        for i in range(n):
            for j in range(i):
                if alive[i] and alive[j] and near[i, j] and (step == 0 or a in (i, j)):
                    cost[i, j] = (
                        _measure(points, extreme, count, i, j, directions, work) - volume[i] - volume[j]
                    )
        total[n - 1 - step] = 0.0
        for i in range(n):
            if alive[i]:
                total[n - 1 - step] += volume[i]
        if step == n - 1:
            break
        best, a, b = np.inf, -1, -1
        for i in range(n):
            for j in range(i):
                if alive[i] and alive[j] and near[i, j] and cost[i, j] < best:
                    best, a, b = cost[i, j], i, j
        if a < 0:  # no two sets touch: the two of least volume are merged
            for i in range(n):
                if alive[i] and (a < 0 or volume[i] < volume[a]):
                    a, b = i, a
                elif alive[i] and (b < 0 or volume[i] < volume[b]):
                    b = i
        merged[step, 0], merged[step, 1] = a, b
        volume[a] = _measure(points, extreme, count, a, b, directions, work)
        alive[b] = False
        count[a] = _distinct(work[5], kept)
        for d in range(count[a]):
            extreme[a, d] = kept[d]
        for j in range(n):
            near[a, j] = near[a, j] or near[b, j]
            near[j, a] = near[a, j]
        near[a, a] = False
