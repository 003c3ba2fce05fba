"""Compare convex patches in plan: which are below others, which conflict, and which are visible from below."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Bools, Floats, Int64s

# Strategy. A patch is a convex polygon in space, so its projection is convex too. All tests are made in plan.
# - Two projections overlap unless a side of one of them separates them (separating axis theorem in the plane).
# - Bounding boxes are compared first; they reject almost all pairs.
# - Visibility from below is decided at sample points only: near each corner, in the middle, and on a square lattice.
#   A patch that is visible only between the samples is missed; the caller uses the test in columns with too
#   many patches for the exact union.
# In each column every patch is compared with every other: O(n * m) per column, and columns are small.

_MARGIN = 1e-6
"""Overlaps (mm) up to this width in plan, and differences in height up to it, count as none."""


class Patches(NamedTuple):
    """Convex pieces of triangles inside columns, sorted by column.

    Attributes
    ----------
    points
        ``(p, 3)`` corners, mm, counter-clockwise seen from above.
    start
        ``(n + 1,)`` index of the first corner of each patch.
    owner
        ``(n, 2)`` column, and number of the triangle.
    of_column
        ``(m + 1,)`` index of the first patch of each column.
    """

    points: Floats
    start: Int64s
    owner: Int64s
    of_column: Int64s

    def chosen(self, keep: Bools) -> "Patches":
        """Return the patches for which `keep` ``(n,)`` is true."""
        sizes = np.diff(self.start)
        start = np.concatenate([[0], np.cumsum(sizes[keep])])
        owner = self.owner[keep]
        of_column = np.searchsorted(owner[:, 0], np.arange(len(self.of_column)))
        return Patches(self.points[np.repeat(keep, sizes)], start, owner, of_column)

    def in_column(self, column: int) -> tuple[Floats, Int64s]:
        """Return the corners of the patches in a column, and the index of the first corner of each."""
        first, last = self.of_column[column : column + 2]
        start = self.start[first : last + 1]
        return self.points[start[0] : start[-1]], start - start[0]


class RaisedPatches(NamedTuple):
    """Patches of one column, each raised by `rise` ``(n,)`` mm; `points` and `start` as in `Patches`."""

    points: Floats
    start: Int64s
    rise: Floats


@njit(cache=True)
def _separates(
    points: Floats, first: int, last: int, others: Floats, other_first: int, other_last: int
) -> bool:
    """Return whether a side of the first polygon separates the two in plan, up to the margin."""
    for i in range(first, last):
        j = i + 1 if i + 1 < last else first
        nx, ny = points[j, 1] - points[i, 1], points[i, 0] - points[j, 0]
        size = np.sqrt(nx * nx + ny * ny)
        if size < 1e-12:
            continue
        nearest = np.inf
        for k in range(other_first, other_last):
            away = ((others[k, 0] - points[i, 0]) * nx + (others[k, 1] - points[i, 1]) * ny) / size
            nearest = min(nearest, away)
        if nearest > -_MARGIN:
            return True
    return False


@njit(cache=True)
def _overlap(
    points: Floats, first: int, last: int, others: Floats, other_first: int, other_last: int
) -> bool:
    """Return whether two convex polygons overlap in plan by more than the margin."""
    if _separates(points, first, last, others, other_first, other_last):
        return False
    return not _separates(others, other_first, other_last, points, first, last)


@njit(cache=True)
def _plan_boxes(points: Floats, start: Int64s) -> Floats:
    """Return least x, least y, greatest x and greatest y of each patch, ``(n, 4)``."""
    box = np.empty((len(start) - 1, 4))
    for i in range(len(start) - 1):
        box[i, 0], box[i, 1], box[i, 2], box[i, 3] = np.inf, np.inf, -np.inf, -np.inf
        for k in range(start[i], start[i + 1]):
            x, y = points[k, 0], points[k, 1]
            box[i, 0], box[i, 1] = min(box[i, 0], x), min(box[i, 1], y)
            box[i, 2], box[i, 3] = max(box[i, 2], x), max(box[i, 3], y)
    return box


@njit(cache=True)
def find_below(supported: Patches, surface: Patches, below: Bools) -> None:
    """Set `below` ``(n,)`` for patches of `surface` that are, at least in part, below a supported patch.

    Only patches of the same column are compared, and a patch is never below one of the same triangle.
    """
    supported_box = _plan_boxes(supported.points, supported.start)
    box = _plan_boxes(surface.points, surface.start)
    for column in range(len(surface.of_column) - 1):
        for h in range(supported.of_column[column], supported.of_column[column + 1]):
            h0, h1 = supported.start[h], supported.start[h + 1]
            highest = np.max(supported.points[h0:h1, 2])
            left, front, right, back = supported_box[h]
            for s in range(surface.of_column[column], surface.of_column[column + 1]):
                if below[s] or surface.owner[s, 1] == supported.owner[h, 1]:
                    continue
                if box[s, 0] >= right or box[s, 2] <= left or box[s, 1] >= back or box[s, 3] <= front:
                    continue
                s0, s1 = surface.start[s], surface.start[s + 1]
                if np.min(surface.points[s0:s1, 2]) <= highest - _MARGIN:
                    below[s] = _overlap(supported.points, h0, h1, surface.points, s0, s1)


@njit(cache=True)
def _sides_conflict(
    points: Floats, first: int, last: int, other_first: int, other_last: int, slack: float
) -> bool:
    """Return whether two patches touch along parts of their sides without sharing a whole side."""
    for i in range(first, last):
        j = i + 1 if i + 1 < last else first
        dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        length = np.sqrt(dx * dx + dy * dy)
        if length <= slack:
            continue
        dx, dy = dx / length, dy / length
        for k in range(other_first, other_last):
            m = k + 1 if k + 1 < other_last else other_first
            ax, ay = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1]
            bx, by = points[m, 0] - points[i, 0], points[m, 1] - points[i, 1]
            if abs(ax * dy - ay * dx) > slack or abs(bx * dy - by * dx) > slack:
                continue
            if min(ax * dx + ay * dy, length) - max(bx * dx + by * dy, 0.0) <= slack:
                continue
            for axis in range(3):
                if points[i, axis] != points[m, axis] or points[j, axis] != points[k, axis]:
                    return True
    return False


@njit(cache=True)
def colour_patches(points: Floats, start: Int64s, slack: float, colour: Int64s) -> None:
    """Colour patches so that two of one colour share a whole side with the same heights, or do not touch.

    The greedy colouring visits patches in their order and gives each the least colour that no conflicting patch before
    it has. Patches conflict if they overlap in plan or touch along parts of their sides.

    Parameters
    ----------
    points, start
        ``(p, 3)`` mm and ``(n + 1,)``, corners of the patches as in `Patches`.
    slack
        Sides this far apart (mm) count as collinear, and shorter contacts as none.
    colour
        ``(n,)``, written in place.
    """
    count = len(start) - 1
    box = _plan_boxes(points, start)
    taken = np.full(count + 1, -1, np.int64)
    for i in range(count):
        left, front, right, back = box[i, 0] - slack, box[i, 1] - slack, box[i, 2] + slack, box[i, 3] + slack
        i0, i1 = start[i], start[i + 1]
        for j in range(i):
            if box[j, 0] > right or box[j, 2] < left or box[j, 1] > back or box[j, 3] < front:
                continue
            if taken[colour[j]] == i:
                continue
            j0, j1 = start[j], start[j + 1]
            if _overlap(points, i0, i1, points, j0, j1) or _sides_conflict(points, i0, i1, j0, j1, slack):
                taken[colour[j]] = i
        colour[i] = 0
        while taken[colour[i]] == i:
            colour[i] += 1


@njit(cache=True)
def _height_at(points: Floats, first: int, last: int, x: float, y: float) -> float:
    """Return the height of a patch above a point in plan, infinity outside the patch."""
    across, along, upward = 0.0, 0.0, 0.0
    low, high = np.inf, -np.inf
    for i in range(first, last):
        j = i + 1 if i + 1 < last else first
        dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        if dx * (y - points[i, 1]) - dy * (x - points[i, 0]) < 0.0:
            return np.inf
        across -= dy * (points[i, 2] + points[j, 2])
        along += dx * (points[i, 2] + points[j, 2])
        upward += (points[i, 0] - points[first, 0]) * dy - (points[i, 1] - points[first, 1]) * dx
        low, high = min(low, points[i, 2]), max(high, points[i, 2])
    if upward <= 0.0:
        return np.inf
    slope = (across * (x - points[first, 0]) + along * (y - points[first, 1])) / upward
    # the slope of a sliver is unreliable, so the height is clamped
    return float(min(max(points[first, 2] - slope, low), high))


@njit(cache=True)
def _is_lowest(
    patches: RaisedPatches, i: int, x: float, y: float, others: RaisedPatches, box: Floats
) -> bool:
    """Return whether a point in plan is in patch `i` and no other patch is lower there."""
    height = _height_at(patches.points, patches.start[i], patches.start[i + 1], x, y) + patches.rise[i]
    if height == np.inf:
        return False
    for k in range(len(others.start) - 1):
        if x < box[k, 0] or x > box[k, 2] or y < box[k, 1] or y > box[k, 3]:
            continue
        other = _height_at(others.points, others.start[k], others.start[k + 1], x, y) + others.rise[k]
        if other < height - _MARGIN:
            return False
    return True


@njit(cache=True)
def find_visible(patches: RaisedPatches, others: RaisedPatches, spacing: float, visible: Bools) -> None:
    """Find patches that are the lowest at one of the sample points: near a corner, in the middle, on the lattice.

    Parameters
    ----------
    patches
        Patches to judge.
    others
        Patches that may hide them; they may be the same.
    spacing
        Pitch (mm) of the lattice of sample points in plan.
    visible
        ``(n,)``, written in place.
    """
    box = _plan_boxes(others.points, others.start)
    own = _plan_boxes(patches.points, patches.start)
    points = patches.points
    for i in range(len(patches.start) - 1):
        first, last = patches.start[i], patches.start[i + 1]
        x, y = np.mean(points[first:last, 0]), np.mean(points[first:last, 1])
        visible[i] = _is_lowest(patches, i, x, y, others, box)
        for k in range(first, last):
            if not visible[i]:
                a, b = 0.99 * points[k, 0] + 0.01 * x, 0.99 * points[k, 1] + 0.01 * y
                visible[i] = _is_lowest(patches, i, a, b, others, box)
        for row in range(int(np.ceil(own[i, 1] / spacing)), int(np.floor(own[i, 3] / spacing)) + 1):
            for column in range(int(np.ceil(own[i, 0] / spacing)), int(np.floor(own[i, 2] / spacing)) + 1):
                if not visible[i]:
                    visible[i] = _is_lowest(patches, i, column * spacing, row * spacing, others, box)
