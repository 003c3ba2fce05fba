"""Enclosing boxes of what polygons have beyond axis-parallel planes."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper

_BUCKETS = 512


@helper
def _join(box: Floats, x: float, y: float, z: float) -> None:
    box[0] = min(box[0], x)
    box[1] = min(box[1], y)
    box[2] = min(box[2], z)
    box[3] = max(box[3], x)
    box[4] = max(box[4], y)
    box[5] = max(box[5], z)


@njit(cache=True)
def boxes_beyond(
    points: Floats,
    corners: Int64s,
    first: Int64s,
    solid: bool,
    planes: Floats,
    counts: Int64s,
    beyond: Floats,
) -> None:
    """Enclose what the polygons have below and above each plane.

    Strategy: what a polygon has on one side of a plane is the convex hull of its corners there and of the points
    in which its sides cross the plane. Each corner is joined to the last plane that it is beyond, and a
    running join carries it to the planes before. Points of crossing count for their plane only: at the planes
    before, they are between the point of crossing there and a corner. A table of buckets finds the planes
    around a corner in constant time, so that the time grows with corners and crossings.

    Parameters
    ----------
    points, corners, first
        Convex polygons: polygon p has the corners ``points[corners[first[p]:first[p + 1]]]``; every point is a
        corner.
    solid
        Whether each polygon stands for a box, of which its two corners are the least and the greatest.
    planes
        ``(3, k)`` mm, strictly increasing along each axis up to the count.
    counts
        ``(3,)`` number of planes along each axis, at least 2.
    beyond
        ``(6, k, 6)``, receives the enclosing boxes: row ``axis`` of the closure of what is below the plane, row
        ``axis + 3`` of what is above; inf and -inf where there is nothing.
    """
    beyond[:, :, :3] = np.inf
    beyond[:, :, 3:] = -np.inf
    crossing = beyond.copy()
    index = np.empty(len(points), np.int64)
    table = np.empty(_BUCKETS + 1, np.int64)
    for axis in range(3):
        count = counts[axis]
        row = planes[axis]
        low = row[0]
        scale = _BUCKETS / (row[count - 1] - low)
        k = 0
        for b in range(_BUCKETS + 1):
            while k < count and (row[k] - low) * scale < b - 1e-6:
                k += 1
            table[b] = k
        for i in range(len(points)):
            x = points[i, axis]
            b = int((x - low) * scale)
            k = table[min(max(b, 0), _BUCKETS)]
            while k < count and row[k] < x:
                k += 1
            index[i] = k  # the first plane that is not below the corner
            if k > 0:
                _join(beyond[axis + 3, k - 1], points[i, 0], points[i, 1], points[i, 2])
            if k < count and row[k] == x:
                k += 1
            if k < count:
                _join(beyond[axis, k], points[i, 0], points[i, 1], points[i, 2])
        for p in range(len(first) - 1):
            j = corners[first[p + 1] - 1]
            for at in range(first[p], first[p + 1]):
                i = corners[at]
                u, v = (i, j) if points[i, axis] <= points[j, axis] else (j, i)
                j = i
                k = index[u]
                if k >= count or row[k] > points[v, axis]:
                    continue
                length = points[v, axis] - points[u, axis]
                if length <= 0.0 or (solid and at > first[p]):
                    continue
                while k < count and row[k] <= points[v, axis]:
                    t = (row[k] - points[u, axis]) / length
                    x = points[u, 0] + t * (points[v, 0] - points[u, 0])
                    y = points[u, 1] + t * (points[v, 1] - points[u, 1])
                    z = points[u, 2] + t * (points[v, 2] - points[u, 2])
                    if axis == 0:
                        x = row[k]
                    elif axis == 1:
                        y = row[k]
                    else:
                        z = row[k]
                    if row[k] < points[v, axis]:
                        _join(crossing[axis + 3, k], x, y, z)
                        if solid:
                            _join_section(crossing[axis + 3, k], points[u], points[v], axis)
                    if row[k] > points[u, axis]:
                        _join(crossing[axis, k], x, y, z)
                        if solid:
                            _join_section(crossing[axis, k], points[u], points[v], axis)
                    k += 1
        for k in range(1, count):
            _join_box(beyond[axis, k], beyond[axis, k - 1])
            above = count - 1 - k
            _join_box(beyond[axis + 3, above], beyond[axis + 3, above + 1])
        for k in range(count):
            _join_box(beyond[axis, k], crossing[axis, k])
            _join_box(beyond[axis + 3, k], crossing[axis + 3, k])


@helper
def _join_box(box: Floats, other: Floats) -> None:
    for c in range(3):
        box[c] = min(box[c], other[c])
        box[c + 3] = max(box[c + 3], other[c + 3])


@helper
def _join_section(box: Floats, low: Floats, high: Floats, axis: int) -> None:
    """Join the section of the box from `low` to `high` with a plane, without the coordinate along the axis."""
    for c in range(3):
        if c != axis:
            box[c] = min(box[c], low[c])
            box[c + 3] = max(box[c + 3], high[c])
