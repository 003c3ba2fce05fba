"""Compares convex patches in plan: which lie below others, get in each other's way, or are seen from below."""

import numpy as np
from numba import njit


@njit(cache=True)
def _apart(points, first, last, others, other_first, other_last, margin):
    """Whether a side of the first convex polygon separates the two in plan, or they overlap by at most `margin`."""
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
        if nearest > -margin:
            return True
    return False


@njit(cache=True)
def _overlap(points, first, last, others, other_first, other_last, margin):
    """Whether two convex polygons overlap in plan by more than `margin`."""
    if _apart(points, first, last, others, other_first, other_last, margin):
        return False
    return not _apart(others, other_first, other_last, points, first, last, margin)


@njit(cache=True)
def _plan_box(points, start, box):
    """Write least x and y, greatest x and y of each patch to `box` ``(n, 4)``."""
    for i in range(len(start) - 1):
        box[i, 0], box[i, 1], box[i, 2], box[i, 3] = np.inf, np.inf, -np.inf, -np.inf
        for k in range(start[i], start[i + 1]):
            x, y = points[k, 0], points[k, 1]
            box[i, 0], box[i, 1] = min(box[i, 0], x), min(box[i, 1], y)
            box[i, 2], box[i, 3] = max(box[i, 2], x), max(box[i, 3], y)


@njit(cache=True)
def find_below(hold_points, hold_start, hold_owner, hold_columns, points, start, owner, columns, below):
    """Find patches that lie under, at least in part, a patch of their column that is to be held.

    Both families are sorted by column; `hold_columns` and `columns` ``(m + 1,)`` say where each column's
    patches start. A patch whose owner names the same triangle as the one to be held is that one.

    Parameters
    ----------
    below
        ``(n,)`` bool, written in place.
    """
    margin = 1e-6
    hold_box, box = np.empty((len(hold_start) - 1, 4)), np.empty((len(start) - 1, 4))
    _plan_box(hold_points, hold_start, hold_box)
    _plan_box(points, start, box)
    for column in range(len(columns) - 1):
        for h in range(hold_columns[column], hold_columns[column + 1]):
            h0, h1 = hold_start[h], hold_start[h + 1]
            highest = np.max(hold_points[h0:h1, 2])
            left, front, right, back = hold_box[h]
            for s in range(columns[column], columns[column + 1]):
                if below[s] or owner[s, 1] == hold_owner[h, 1]:
                    continue
                if box[s, 0] >= right or box[s, 2] <= left or box[s, 1] >= back or box[s, 3] <= front:
                    continue
                s0, s1 = start[s], start[s + 1]
                if np.min(points[s0:s1, 2]) <= highest - margin:
                    below[s] = _overlap(hold_points, h0, h1, points, s0, s1, margin)


@njit(cache=True)
def _clash(points, first, last, other_first, other_last, slack):
    """Whether two patches meet along parts of their sides, other than in a whole side that both have."""
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
def colour_patches(points, start, slack, colour):
    """Colour patches so that those of one colour meet in whole sides at the same heights, or not at all.

    In their order, each takes the least colour that none before it has which it overlaps in plan or clashes
    with along a side.

    Parameters
    ----------
    points, start
        ``(p, 3)`` and ``(n + 1,)``: corners of the patches, counter-clockwise seen from above.
    slack
        mm; sides this far apart count as collinear, and shorter contacts are none.
    colour
        ``(n,)`` int64, written in place.
    """
    count = len(start) - 1
    box = np.empty((count, 4))
    _plan_box(points, start, box)
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
            if _overlap(points, i0, i1, points, j0, j1, 1e-6) or _clash(points, i0, i1, j0, j1, slack):
                taken[colour[j]] = i
        colour[i] = 0
        while taken[colour[i]] == i:
            colour[i] += 1


@njit(cache=True)
def _height_in(points, first, last, x, y):
    """Height of a patch over a point in plan; infinite where the point is outside."""
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
    # slivers have no sure slope
    return min(max(points[first, 2] - slope, low), high)


@njit(cache=True)
def _seen(points, first, last, rise, x, y, others, start, box, other_rise):
    """Whether a patch, raised by `rise`, is the lowest over a point in plan; not where the point is outside."""
    height = _height_in(points, first, last, x, y) + rise
    if height == np.inf:
        return False
    for k in range(len(start) - 1):
        if x < box[k, 0] or x > box[k, 2] or y < box[k, 1] or y > box[k, 3]:
            continue
        if _height_in(others, start[k], start[k + 1], x, y) + other_rise[k] < height - 1e-6:
            return False
    return True


@njit(cache=True)
def find_visible(points, start, rise, others, other_start, other_rise, spacing, seen):
    """Find patches that are the lowest somewhere: near a corner, in the middle or at a point of a lattice.

    Parameters
    ----------
    points, start, rise
        Patches as compressed rows, and by how much each is raised, mm.
    others, other_start, other_rise
        Those that may lie below them.
    spacing
        mm of the lattice in plan.
    seen
        ``(n,)`` bool, written in place.
    """
    box = np.empty((len(other_start) - 1, 4))
    _plan_box(others, other_start, box)
    own = np.empty((len(start) - 1, 4))
    _plan_box(points, start, own)
    for i in range(len(start) - 1):
        first, last = start[i], start[i + 1]
        x, y = np.mean(points[first:last, 0]), np.mean(points[first:last, 1])
        seen[i] = _seen(points, first, last, rise[i], x, y, others, other_start, box, other_rise)
        for k in range(first, last):
            if not seen[i]:
                a, b = 0.99 * points[k, 0] + 0.01 * x, 0.99 * points[k, 1] + 0.01 * y
                seen[i] = _seen(points, first, last, rise[i], a, b, others, other_start, box, other_rise)
        for row in range(int(np.ceil(own[i, 1] / spacing)), int(np.floor(own[i, 3] / spacing)) + 1):
            for column in range(int(np.ceil(own[i, 0] / spacing)), int(np.floor(own[i, 2] / spacing)) + 1):
                if not seen[i]:
                    a, b = column * spacing, row * spacing
                    seen[i] = _seen(points, first, last, rise[i], a, b, others, other_start, box, other_rise)
