"""Whether something of a body is straight above another, for bodies with few triangles there."""

from itertools import product

import numpy as np

from amprep.arrays import Bools, Floats, Ints

# Strategy. Where a body is above another, a triangle of the lower one that faces up has one of the upper one that faces
# down above a point of its interior. The shadows of two triangles overlap if and only if one has a corner or the
# centroid inside the other, or two edges cross; the height of one above the other is greatest at such a point. This is
# numpy alone: for the few pairs of neighbours on a plate, compiling the queries on trees would take longer.

MOST_PAIRS = 200_000
"""Pairs of triangles whose bounding rectangles overlap; more are left to the trees."""

MOST_TRIANGLES = 20_000
"""Triangles of both bodies together, above which trees are faster."""

EDGE_ON = 1e-6
"""Cosine of the angle to the vertical below which a triangle counts as upright."""

INSIDE = 1e-9
"""mm2; a point is inside a triangle if it spans at least this with each edge, and edges cross by as much."""


def is_above(upper: Floats, lower: Floats, depth: float) -> bool | None:
    """Tell whether something of a body is straight above another; None if that takes too many pairs of triangles.

    Parameters
    ----------
    upper, lower
        ``(n, 3, 3)`` and ``(m, 3, 3)`` mm, outward oriented triangles.
    depth
        mm by which the upper one may be below the lower one, because bodies in contact may overlap.
    """
    over, under = _facing(upper[:, ::-1]), _facing(lower)
    for axis in (0, 1):
        over, under = _within(over, under, axis), _within(under, over, axis)
    if not len(over) or not len(under):
        return False
    over = over[over[:, :, 2].max(axis=1) > under[:, :, 2].min() - depth]
    pairs = _pairs(over, under, depth)
    if pairs is None:
        return None
    one, other = over[pairs[0]], under[pairs[1]]
    return any(bool((met & (_rise(one, other, point) > -depth)).any()) for point, met in _points(one, other))


def _facing(corners: Floats) -> Floats:
    """Return the triangles that are counter-clockwise from above."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(corners[normal[:, 2] > EDGE_ON * np.linalg.norm(normal, axis=1)])


def _within(corners: Floats, others: Floats, axis: int) -> Floats:
    """Return the triangles that overlap the extent of others along an axis."""
    if not len(others):
        return corners[:0]
    values = corners[:, :, axis]
    low, high = others[:, :, axis].min(), others[:, :, axis].max()
    return np.asarray(corners[(values.min(axis=1) < high) & (values.max(axis=1) > low)])


def _pairs(over: Floats, under: Floats, depth: float) -> tuple[Ints, Ints] | None:
    """Return the numbers of triangles whose rectangles overlap, the first not all below the second."""
    low, high, other_low, other_high = (
        over.min(axis=1),
        over.max(axis=1),
        under.min(axis=1),
        under.max(axis=1),
    )
    empty = np.empty(0, np.int64)
    first, second, count = [empty], [empty], 0
    for index in range(len(over)):
        met = (low[index, :2] < other_high[:, :2]) & (high[index, :2] > other_low[:, :2])
        found = np.flatnonzero(met.all(axis=1) & (high[index, 2] > other_low[:, 2] - depth))
        first.append(np.full(len(found), index))
        second.append(found)
        count += len(found)
        if count > MOST_PAIRS:
            return None
    return np.concatenate(first), np.concatenate(second)


def _points(one: Floats, other: Floats) -> list[tuple[Floats, Bools]]:
    """Return candidates for the point of greatest height of each pair, ``(p, 2)``, and whether both shadows have it."""
    found = []
    for a, b in ((one, other), (other, one)):
        for point in (*np.moveaxis(a[:, :, :2], 1, 0), a[:, :, :2].mean(axis=1)):
            sides = [_cross(b[:, k, :2], b[:, (k + 1) % 3, :2], point) for k in range(3)]
            found.append((point, np.min(sides, axis=0) > INSIDE))
    for i, j in product(range(3), range(3)):
        a, b = one[:, i, :2], one[:, (i + 1) % 3, :2]
        c, d = other[:, j, :2], other[:, (j + 1) % 3, :2]
        start, end = _cross(c, d, a), _cross(c, d, b)
        first, last = _cross(a, b, c), _cross(a, b, d)
        crosses = (np.minimum(start, end) < -INSIDE) & (np.maximum(start, end) > INSIDE)
        crosses &= (np.minimum(first, last) < -INSIDE) & (np.maximum(first, last) > INSIDE)
        point = a + (start / np.where(crosses, start - end, 1.0))[:, None] * (b - a)
        found.append((point, crosses))
    return found


def _cross(start: Floats, end: Floats, point: Floats) -> Floats:
    """Return twice the area of the triangles from edges to points, positive on the left, ``(p,)`` mm2."""
    along, away = end - start, point - start
    return np.asarray(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])


def _rise(one: Floats, other: Floats, point: Floats) -> Floats:
    """Return the height of the planes of triangles above those of others at points, ``(p,)`` mm."""
    return _height(one, point) - _height(other, point)


def _height(corners: Floats, point: Floats) -> Floats:
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = point - corners[:, 0, :2]
    return np.asarray(corners[:, 0, 2] - (normal[:, :2] * away).sum(axis=1) / normal[:, 2])
