"""Welds rows of integers and clips triangles to the columns above red squares."""

import numpy as np
from numba import njit

MOST_CORNERS = 16
"""A triangle clipped by six planes has at most nine corners."""


@njit(cache=True)
def label_rows(rows, table, label):
    """Number equal rows in order of first appearance, in time linear in their number.

    Parameters
    ----------
    rows
        ``(n, 3)`` int64.
    table
        Work array of -1, int64; its length is a power of two above 2 n.
    label
        ``(n,)`` int64, written in place.

    Returns
    -------
    count
        How many different rows there are.
    """
    mask = np.int64(len(table) - 1)
    count = 0
    for i in range(len(rows)):
        a, b, c = rows[i, 0], rows[i, 1], rows[i, 2]
        # folded to 32 bits each, so that no product overflows
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


@njit(cache=True)
def _clip(points, count, axis, bound, above, out):
    """Keep the part of a polygon where its coordinate on `axis` is at least (or at most) `bound`.

    The point on an edge is computed from its ends in a fixed order, so that both triangles of an edge get
    the same one, bit for bit.
    """
    kept = 0
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        a, b = points[i, axis], points[j, axis]
        a_in = a >= bound if above else a <= bound
        b_in = b >= bound if above else b <= bound
        if a_in:
            out[kept, 0], out[kept, 1], out[kept, 2] = points[i, 0], points[i, 1], points[i, 2]
            kept += 1
        if a_in != b_in:
            low, high = (i, j) if a < b else (j, i)
            share = (bound - points[low, axis]) / (points[high, axis] - points[low, axis])
            for k in range(3):
                out[kept, k] = points[low, k] + share * (points[high, k] - points[low, k])
            out[kept, axis] = bound
            kept += 1
    return kept


@njit(cache=True)
def clip_to_columns(corners, grid, shape, square_start, square_column, lo, hi, slack, points, start, owner):
    """Cut triangles that look down into the convex patches that lie in columns.

    Parameters
    ----------
    corners
        ``(t, 3, 3)`` float64 mm; triangles that do not look down are skipped.
    grid
        origin x, origin y, pitch.
    shape
        Numbers of squares (ny, nx).
    square_start, square_column
        Columns over each square, as compressed rows: square ``y * nx + x``.
    lo, hi
        ``(m, 3)`` corners of the columns.
    slack
        mm by which columns reach further up and down.
    points, start, owner
        ``(p, 3)``, ``(n + 1,)`` and ``(n, 2)``: corners of the patches, counter-clockwise seen from above; where
        each patch's corners start; its column and its triangle. Written in place.

    Returns
    -------
    count
        Number of patches, or -1 when the arrays are too short.
    """
    a, b = np.empty((MOST_CORNERS, 3)), np.empty((MOST_CORNERS, 3))
    ny, nx = shape
    count, used = 0, 0
    start[0] = 0
    for t in range(len(corners)):
        triangle = corners[t]
        turn = (triangle[1, 0] - triangle[0, 0]) * (triangle[2, 1] - triangle[0, 1]) - (
            triangle[1, 1] - triangle[0, 1]
        ) * (triangle[2, 0] - triangle[0, 0])
        if turn >= 0.0:
            continue
        left, right = np.min(triangle[:, 0]) - grid[0], np.max(triangle[:, 0]) - grid[0]
        front, back = np.min(triangle[:, 1]) - grid[1], np.max(triangle[:, 1]) - grid[1]
        bottom, top = np.min(triangle[:, 2]), np.max(triangle[:, 2])
        # one square more on each side, for what rounding puts on the other side of a line
        for y in range(max(0, int(front / grid[2]) - 1), min(ny - 1, int(back / grid[2]) + 1) + 1):
            for x in range(max(0, int(left / grid[2]) - 1), min(nx - 1, int(right / grid[2]) + 1) + 1):
                for entry in range(square_start[y * nx + x], square_start[y * nx + x + 1]):
                    column = square_column[entry]
                    low, high = lo[column, 2] - slack, hi[column, 2] + slack
                    if bottom > high or top < low:
                        continue
                    n = _clip(triangle, 3, 0, lo[column, 0], True, a)
                    n = _clip(a, n, 0, hi[column, 0], False, b)
                    n = _clip(b, n, 1, lo[column, 1], True, a)
                    n = _clip(a, n, 1, hi[column, 1], False, b)
                    n = _clip(b, n, 2, low, True, a)
                    n = _clip(a, n, 2, high, False, b)
                    area = 0.0
                    for i in range(1, n - 1):
                        area += (b[i, 0] - b[0, 0]) * (b[i + 1, 1] - b[0, 1])
                        area -= (b[i, 1] - b[0, 1]) * (b[i + 1, 0] - b[0, 0])
                    if n < 3 or area > -1e-10:
                        continue
                    if used + n > len(points) or count >= len(owner):
                        return -1
                    for i in range(n):
                        for k in range(3):
                            points[used + n - 1 - i, k] = b[i, k]
                    used += n
                    owner[count, 0], owner[count, 1] = column, t
                    count += 1
                    start[count] = used
    return count
