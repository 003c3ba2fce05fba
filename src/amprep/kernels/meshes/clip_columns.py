"""Clip triangles that face down to the columns above red squares."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import inlined

MOST_CORNERS = 16
"""Size of the work arrays; a triangle clipped by six planes has at most nine corners."""

# Strategy. Each triangle is clipped to each column below whose square it may be (Sutherland and Hodgman 1974,
# doi 10.1145/360767.360802): against the four sides, the bottom and the top of the column. A point on an edge is
# computed from the ends of the edge in a fixed order, so two triangles that share the edge get the same point to the
# last bit, and the patches of a closed surface fit together without gaps. The time is proportional to the number of
# squares that the boxes of the triangles cover.


class ColumnIndex(NamedTuple):
    """Columns and where they are.

    Attributes
    ----------
    grid
        ``(3,)`` origin x, origin y and pitch, mm.
    shape
        Numbers of squares (ny, nx).
    square_start, columns
        Compressed rows: the columns above square ``y * nx + x`` are ``columns[square_start[s] : square_start[s + 1]]``.
    lo, hi
        ``(m, 3)`` corners of the columns, mm.
    """

    grid: Floats
    shape: tuple[int, int]
    square_start: Int64s
    columns: Int64s
    lo: Floats
    hi: Floats


class PatchBuffers(NamedTuple):
    """Output arrays: `points` ``(p, 3)``, `start` ``(n + 1,)`` and `owner` ``(n, 2)`` as in `Patches`."""

    points: Floats
    start: Int64s
    owner: Int64s


@inlined
def _clip(points: Floats, count: int, axis: int, bound: float, above: bool, out: Floats) -> int:
    """Write the part of a polygon on one side of the plane ``axis = bound`` to `out`; return its number of corners."""
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
            fraction = (bound - points[low, axis]) / (points[high, axis] - points[low, axis])
            for k in range(3):
                out[kept, k] = points[low, k] + fraction * (points[high, k] - points[low, k])
            out[kept, axis] = bound
            kept += 1
    return kept


@inlined
def _twice_area(points: Floats, count: int) -> float:
    """Return twice the signed area of a polygon in plan."""
    area = 0.0
    for i in range(1, count - 1):
        area += (points[i, 0] - points[0, 0]) * (points[i + 1, 1] - points[0, 1])
        area -= (points[i, 1] - points[0, 1]) * (points[i + 1, 0] - points[0, 0])
    return area


@njit(cache=True)
def clip_to_columns(corners: Floats, index: ColumnIndex, slack: float, out: PatchBuffers) -> int:
    """Clip triangles that face down to the columns of an index.

    Parameters
    ----------
    corners
        ``(t, 3, 3)`` mm; triangles that do not face down are skipped.
    index
        The columns.
    slack
        Length (mm) by which columns are extended upwards and downwards.
    out
        Patches, written in place; patches without area are left out.

    Returns
    -------
    count
        Number of patches, or -1 when the arrays are too short.
    """
    work, least, most = np.empty((2, MOST_CORNERS, 3)), np.empty(3), np.empty(3)
    grid, lo, hi = index.grid, index.lo, index.hi
    ny, nx = index.shape
    count, used = 0, 0
    out.start[0] = 0
    for t in range(len(corners)):
        triangle = corners[t]
        turn = (triangle[1, 0] - triangle[0, 0]) * (triangle[2, 1] - triangle[0, 1]) - (
            triangle[1, 1] - triangle[0, 1]
        ) * (triangle[2, 0] - triangle[0, 0])
        if turn >= 0.0:
            continue
        for k in range(3):
            least[k] = min(triangle[0, k], triangle[1, k], triangle[2, k])
            most[k] = max(triangle[0, k], triangle[1, k], triangle[2, k])
        left, right = least[0] - grid[0], most[0] - grid[0]
        front, back = least[1] - grid[1], most[1] - grid[1]
        bottom, top = least[2], most[2]
        # one more square on each side, because rounding may move a corner across a grid line
        for y in range(max(0, int(front / grid[2]) - 1), min(ny - 1, int(back / grid[2]) + 1) + 1):
            for x in range(max(0, int(left / grid[2]) - 1), min(nx - 1, int(right / grid[2]) + 1) + 1):
                for entry in range(index.square_start[y * nx + x], index.square_start[y * nx + x + 1]):
                    column = index.columns[entry]
                    low, high = lo[column, 2] - slack, hi[column, 2] + slack
                    if bottom > high or top < low:
                        continue
                    n, now = len(triangle), 0  # a number here would compile what it is handed to twice
                    for i in range(3):
                        for k in range(3):
                            work[0, i, k] = triangle[i, k]
                    for side in range(6):
                        axis, above = side // 2, side % 2 == 0
                        bound = lo[column, axis] if above else hi[column, axis]
                        if axis == 2:
                            bound = low if above else high
                        # a plane that does not cut the triangle leaves the polygon as it is
                        if (least[axis] < bound) if above else (most[axis] > bound):
                            n = _clip(work[now], n, axis, bound, above, work[1 - now])
                            now = 1 - now
                    b = work[now]
                    if n < 3 or _twice_area(b, n) > -1e-10:
                        continue
                    if used + n > len(out.points) or count >= len(out.owner):
                        return -1
                    for i in range(n):
                        for k in range(3):
                            out.points[used + n - 1 - i, k] = b[i, k]
                    used += n
                    out.owner[count, 0], out.owner[count, 1] = column, t
                    count += 1
                    out.start[count] = used
    return count
