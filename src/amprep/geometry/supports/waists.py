"""Find narrow places on the outlines of a region: narrow ends, and waists between two wider places."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Bools, Floats, Int64s

INWARDS = np.radians(5.0)
"""Angle by which an outline turns inwards at the corner of a waist."""

_OPPOSITE = 0.7
"""Cosine of the largest angle at which the shortest line across a waist meets the other side."""

_SQUARE = 2.0
"""Size (in widths) of the squares in which sides are listed; pieces of sides are at most half as long."""

_MOST_SQUARES = 1_000_000
"""Largest number of squares; they are larger where there would be more."""


def keep_narrow(
    points: Floats,
    after: Int64s,
    inwards: Bools,
    ends: Bools,
    width: float,
    judged: Callable[[Floats], Bools],
) -> Bools:
    """Tell at which vertices ``(n,)`` a region is thinner than a width, of those that may be narrow ends or waists.

    Where a region becomes narrower and then wider again, one of its two sides turns inwards. So only such corners are
    compared with the sides near them. What a disc of the width near it covers is not thin.

    Parameters
    ----------
    points, after
        ``(n, 2)`` mm, vertices of the outlines, which have the region to their left; the next vertex of each.
    inwards
        ``(n,)`` vertices that may be corners of waists, because the outline turns inwards there.
    ends
        ``(n,)`` vertices that may be narrow ends.
    width
        Length, mm.
    judged
        Tells which points ``(k, 2)`` mm are looked at.
    """
    from amprep.kernels.supports.narrow_places import OutlineSides, keep_narrow_places

    chosen = np.zeros(len(points), np.bool_)
    asked = np.flatnonzero(inwards | ends)
    chosen[asked] = judged(points[asked])
    if not chosen.any():
        return chosen
    inwards = inwards & chosen
    chosen &= ends
    side = points[after] - points
    low, high = points.min(axis=0), points.max(axis=0)
    square = max(_SQUARE * width, float(np.sqrt((high - low).prod() / _MOST_SQUARES)))
    pieces = np.maximum(np.ceil(2.0 * np.hypot(side[:, 0], side[:, 1]) / square), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(points)), pieces)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middle = points[owner] + ((number + 0.5) / pieces[owner])[:, None] * side[owner]
    x, y = ((middle - low) / square).astype(np.int64).T
    shape = ((high - low) / square).astype(np.int64) + 1
    place = y * shape[0] + x
    first = np.concatenate([[0], np.cumsum(np.bincount(place, minlength=int(shape.prod())))])
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    listed = owner[np.argsort(place, kind="stable")]
    outlines = OutlineSides(points, after, before, low, square, shape, first, listed)
    keep_narrow_places(outlines, chosen, inwards, width, _OPPOSITE)
    return chosen
