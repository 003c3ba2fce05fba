"""Separating lines between the convex pieces of near outlines, for linear programs."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import helper
from amprep.kernels.plates.records import PlateLayout, PlateShapes


class PlatePieces(NamedTuple):
    """Convex pieces of all outlines, relative to the centres of their enclosing boxes.

    Attributes
    ----------
    point
        ``(k, 2)`` mm, corners of all pieces, counter-clockwise.
    first_point, first_piece
        ``(p + 1,)`` index of the first corner of each piece, ``(m + 1,)`` of the first piece of each outline.
    box
        ``(p, 4)`` mm, least and greatest corner of each piece.
    half, clearance
        ``(m, 2)`` mm, half the sides of the enclosing boxes, and ``(m,)`` mm, least distance of other outlines.
    """

    point: Floats
    first_point: Int64s
    first_piece: Int64s
    box: Floats
    half: Floats
    clearance: Floats


@helper
def _turn(pieces, shapes, shape, k, points):
    """Write the turned corners of piece k; return their number."""
    start, end = pieces.first_point[k], pieces.first_point[k + 1]
    quarter = shapes.quarter[shape]
    for n in range(start, end):
        x, y = pieces.point[n, 0], pieces.point[n, 1]
        if quarter == 1:
            x, y = -y, x
        elif quarter == 2:
            x, y = -x, -y
        elif quarter == 3:
            x, y = y, -x
        points[n - start, 0], points[n - start, 1] = x, y
    return end - start


@helper
def _box(pieces, shapes, shape, k):
    """Return the least and greatest corner of the turned piece k."""
    x0, y0, x1, y1 = pieces.box[k, 0], pieces.box[k, 1], pieces.box[k, 2], pieces.box[k, 3]
    quarter = shapes.quarter[shape]
    if quarter == 1:
        return -y1, x0, -y0, x1
    if quarter == 2:
        return -x1, -y1, -x0, -y0
    if quarter == 3:
        return y0, -x1, y1, -x0
    return x0, y0, x1, y1


@helper
def _half(pieces, shapes, shape):
    """Return half the sides of the enclosing box of a shape."""
    x, y = pieces.half[shapes.outline[shape], 0], pieces.half[shapes.outline[shape], 1]
    return (y, x) if shapes.quarter[shape] & 1 else (x, y)


@helper
def _by_sides(one, n, other, m, dx, dy, sign, best):
    """Return the best of a separation ``(distance, x, y)`` and of those along the normals of the sides of `one`.

    `other` is at (dx, dy) from `one`; the normal is multiplied by `sign`.
    """
    distance, x, y = best
    for k in range(n):
        ax, ay = one[k, 0], one[k, 1]
        bx, by = one[(k + 1) % n, 0], one[(k + 1) % n, 1]
        length = np.hypot(bx - ax, by - ay)
        if length < 1e-9:
            continue
        nx, ny = (by - ay) / length, (ax - bx) / length
        least = np.inf
        for j in range(m):
            least = min(least, nx * (other[j, 0] + dx - ax) + ny * (other[j, 1] + dy - ay))
        if least > distance:
            distance, x, y = least, sign * nx, sign * ny
    return distance, x, y


@helper
def _separation(one, n, other, m, dx, dy):
    """Return the greatest separation of two convex polygons and the unit normal from the first to the second.

    `other` is at (dx, dy) from `one`. The separation is negative where they overlap, else it is their distance.
    """
    best = _by_sides(one, n, other, m, dx, dy, 1.0, (-np.inf, 0.0, 0.0))
    best = _by_sides(other, m, one, n, -dx, -dy, -1.0, best)
    if best[0] <= 0.0:
        return best
    least, x, y = np.inf, 0.0, 0.0
    for k in range(n):
        for j in range(m):
            u, v = other[j, 0] + dx - one[k, 0], other[j, 1] + dy - one[k, 1]
            if u * u + v * v < least:
                least, x, y = u * u + v * v, u, v
    length = np.sqrt(least)
    if length <= best[0] * (1.0 + 1e-9):
        return best
    x, y = x / length, y / length
    near, far = np.inf, -np.inf
    for j in range(m):
        near = min(near, x * (other[j, 0] + dx) + y * (other[j, 1] + dy))
    for k in range(n):
        far = max(far, x * one[k, 0] + y * one[k, 1])
    return (near - far, x, y) if near - far > best[0] else best


@njit(cache=True, nogil=True, _nrt=False)
def find_line_contacts(
    pieces: PlatePieces,
    shapes: PlateShapes,
    layout: PlateLayout,
    conflict: Bools,
    rows: Int64s,
    items: int,
    reach: float,
    work: Floats,
    pairs: Int64s,
    lines: Floats,
) -> tuple[int, float]:
    """Find the lines that separate near pieces of some items and obstacles of one plate.

    Parameters
    ----------
    conflict
        ``(m, m)`` whether outlines exclude each other.
    rows, items
        ``(r,)`` rows of the layout: the items of a plate, then obstacles, and the number of these items.
    reach
        Distance beyond the clearance (mm) up to which pieces are near.
    work
        ``(2, c, 2)`` work array, c the largest number of corners of a piece.
    pairs, lines
        ``(k, 2)`` rows of the layout, ``(k, 3)`` unit normal from the first to the second and the least difference of
        their positions along it, mm; written.

    Returns
    -------
    The number of lines, which may exceed k, and the least distance beyond the clearance among all near pieces.
    """
    count, apart = 0, np.inf
    for first in range(items):
        i = rows[first]
        for second in range(first + 1, rows.size):
            j = rows[second]
            a, b = layout.shape[i], layout.shape[j]
            p, q = shapes.outline[a], shapes.outline[b]
            if not conflict[p, q]:
                continue
            near = min(pieces.clearance[p], pieces.clearance[q]) + reach
            dx = layout.position[j, 0] - layout.position[i, 0]
            dy = layout.position[j, 1] - layout.position[i, 1]
            hx, hy = _half(pieces, shapes, a)
            wx, wy = _half(pieces, shapes, b)
            if abs(dx) - hx - wx > near or abs(dy) - hy - wy > near:
                continue
            for s in range(pieces.first_piece[p], pieces.first_piece[p + 1]):
                x0, y0, x1, y1 = _box(pieces, shapes, a, s)
                if max(x0 - wx - dx, dx - wx - x1, y0 - wy - dy, dy - wy - y1) > near:
                    continue
                n = 0
                for t in range(pieces.first_piece[q], pieces.first_piece[q + 1]):
                    u0, v0, u1, v1 = _box(pieces, shapes, b, t)
                    if max(u0 + dx - x1, x0 - u1 - dx, v0 + dy - y1, y0 - v1 - dy) > near:
                        continue
                    if n == 0:
                        n = _turn(pieces, shapes, a, s, work[0])
                    m = _turn(pieces, shapes, b, t, work[1])
                    distance, nx, ny = _separation(work[0], n, work[1], m, dx, dy)
                    apart = min(apart, distance + reach - near)
                    if distance > near:
                        continue
                    if count < pairs.shape[0]:
                        pairs[count, 0], pairs[count, 1] = i, j
                        lines[count, 0], lines[count, 1] = nx, ny
                        lines[count, 2] = near - reach - distance + nx * dx + ny * dy
                    count += 1
    return count, apart
