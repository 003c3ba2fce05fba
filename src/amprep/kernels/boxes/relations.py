"""Decide exactly whether a few boxes of fixed orientation fit one room together, compiled.

After Fekete and Schepers, *A combinatorial characterization of higher-dimensional orthogonal packing*, Mathematics
of Operations Research 29 (2004), doi:10.1287/moor.1030.0079, and Martello, Pisinger, Vigo, den Boef and Korst, ACM
TOMS 33 (2007), doi:10.1145/1206040.1206047.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper

IMPOSSIBLE, POSSIBLE, UNKNOWN = 0, 1, 2
"""Verdicts of `fit_together`: there is no packing; there is one; the limit ended the search."""

FIRST, SECOND, OPTION, AXES = 0, 1, 2, 3
"""Columns of the trail: the two boxes of a decision, its option, and a bit for each axis that had a relation before."""


class RelationScratch(NamedTuple):
    """Work arrays for at most m boxes, by depth of the search.

    Attributes
    ----------
    head, tail
        ``(m (m - 1) / 2 + 1, 3, m)`` mm: lengths of the longest chains before and behind each box along each axis.
    axis
        ``(m, m)`` the axis along which the first box is before the second one; -1: not decided.
    trail
        ``(m (m - 1) / 2 + 1, 4)`` decisions.
    """

    head: Floats
    tail: Floats
    axis: Int64s
    trail: Int64s


def relation_scratch(most: int) -> RelationScratch:
    """Return work arrays for at most `most` boxes."""
    pairs = most * (most - 1) // 2
    chains = np.zeros((pairs + 1, 3, most))
    return RelationScratch(
        chains, chains.copy(), np.zeros((most, most), np.int64), np.zeros((pairs + 1, 4), np.int64)
    )


# Strategy. Boxes of fixed orientation fit exactly when an axis and an order can be chosen for every pair so
# that no chain of boxes along an axis is longer than the room. The search decides one pair at a time, the pair with the
# fewest options first, and lengthens the chains through it; a pair without an option makes it go back. Of the two
# orders along an axis without relations only one is tried, because the mirrored packing is as good. Each decision
# takes time in the square of the number of boxes; their number is exponential at worst and limited.


@helper
def _open_pair(count: int, size: Floats, room: Floats, depth: int, scratch: RelationScratch) -> int:
    """Write the undecided pair with the fewest options to the trail; return the number of its options."""
    head, tail, axis, trail = scratch
    fewest = 7
    for i in range(count):
        for j in range(i + 1, count):
            if axis[i, j] >= 0 or axis[j, i] >= 0:
                continue
            options = 0
            for a in range(3):
                both = size[i, a] + size[j, a]
                options += head[depth, a, i] + both + tail[depth, a, j] <= room[a]
                options += head[depth, a, j] + both + tail[depth, a, i] <= room[a]
            if options < fewest:
                fewest = options
                trail[depth, FIRST], trail[depth, SECOND], trail[depth, OPTION] = i, j, -1
                if fewest == 0:
                    return 0
    return fewest


@helper
def _lengthen(count: int, a: int, size: Floats, axis: Int64s, chain: Floats, forward: bool) -> bool:
    """Lengthen the chains along axis `a` by its relations (in place); return False when there is a cycle."""
    for _ in range(count + 1):
        grown = False
        for p in range(count):
            for q in range(count):
                if (axis[p, q] if forward else axis[q, p]) == a and chain[q] < chain[p] + size[p, a]:
                    chain[q] = chain[p] + size[p, a]
                    grown = True
        if not grown:
            return True
    return False


@helper
def _relate(
    count: int, i: int, j: int, a: int, size: Floats, room: Floats, depth: int, scratch: RelationScratch
) -> bool:
    """Put box i before box j along axis `a`, compute the chains of the next depth; return whether all fit."""
    head, tail, axis, _ = scratch
    for b in range(3):
        for k in range(count):
            head[depth + 1, b, k], tail[depth + 1, b, k] = head[depth, b, k], tail[depth, b, k]
    axis[i, j] = a
    if not _lengthen(count, a, size, axis, head[depth + 1, a], True):
        return False
    if not _lengthen(count, a, size, axis, tail[depth + 1, a], False):
        return False
    fits = True
    for k in range(count):
        fits = fits and head[depth + 1, a, k] + size[k, a] + tail[depth + 1, a, k] <= room[a]
    return fits


@njit(cache=True, nogil=True)
def fit_together(
    count: int, size: Floats, room: Floats, limit: int, scratch: RelationScratch
) -> tuple[int, int]:
    """Decide whether boxes of fixed orientation fit a room together.

    Parameters
    ----------
    count, size
        Number of boxes, and ``(count or more, 3)`` mm their sizes.
    room
        ``(3,)`` mm.
    limit
        Greatest number of decisions.
    scratch
        Work arrays, modified in place.

    Returns
    -------
    (int, int)
        IMPOSSIBLE, POSSIBLE, or UNKNOWN after `limit` decisions; and the number of decisions made. After
        POSSIBLE the positions of the boxes are ``scratch.head[count (count - 1) / 2, :, :count]``.
    """
    head, tail, axis, trail = scratch
    pairs = count * (count - 1) // 2
    for i in range(count):
        for a in range(3):
            head[0, a, i] = tail[0, a, i] = 0.0
            if size[i, a] > room[a]:
                return IMPOSSIBLE, 0
        for j in range(count):
            axis[i, j] = -1
    trail[0, AXES] = 0
    depth, decided, down = 0, 0, True
    while depth >= 0:
        if down:
            if depth == pairs:
                return POSSIBLE, decided
            decided += 1
            if decided > limit:
                return UNKNOWN, decided
            if _open_pair(count, size, room, depth, scratch) == 0:
                trail[depth, OPTION] = 6
        i, j, option, axes = (
            trail[depth, FIRST],
            trail[depth, SECOND],
            trail[depth, OPTION],
            trail[depth, AXES],
        )
        axis[i, j] = axis[j, i] = -1
        option += 1
        down = False
        while option < 6 and not down:
            a, turned = option % 3, option >= 3
            before, behind = (j, i) if turned else (i, j)
            length = head[depth, a, before] + size[i, a] + size[j, a] + tail[depth, a, behind]
            if length <= room[a] and not (turned and (axes >> a) & 1 == 0):
                down = _relate(count, before, behind, a, size, room, depth, scratch)
                if not down:
                    axis[before, behind] = -1
            if not down:
                option += 1
        trail[depth, OPTION] = option
        if down:
            depth += 1
            trail[depth, AXES] = axes | (1 << (option % 3))
        else:
            depth -= 1
    return IMPOSSIBLE, decided
