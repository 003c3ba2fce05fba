"""Flood fill kernels for trapped powder: vertical lines through solids, their free intervals, and pockets.

Strategy: lines are on a square grid, numbered row by row: line (y, x) is ``y * nx + x``. Each solid is cut by all
lines exactly; where a line is free of solids, it has an interval of heights in mm. A ball fits where such an interval,
shortened by the radius, meets the intervals of the four neighbouring lines. Intervals of neighbouring lines that
overlap belong to the same pocket (union-find); a pocket that touches the border or has no top is the outside.
All kernels but the sorting of crossings walk through sorted lists once, so they are linear in their number.
"""

import numpy as np
from numba import njit

from amprep.arrays import Bools, Float32s, Floats, Int8s, Int32s, Int64s
from amprep.kernels.meshes.rows import ends_in_row, slopes_of


@njit(cache=True, nogil=True)
def cross_lines(
    points: Floats,
    triangles: Int64s,
    spacing: float,
    shape: tuple[int, int],
    place: Int64s,
    heights: Float32s,
    signs: Int8s,
) -> None:
    """Find where the lines ``((x + 0.5) * spacing, (y + 0.5) * spacing)`` cross triangles.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``, a closed mesh.
    spacing, shape
        Distance of lines in mm, and their numbers (ny, nx).
    place
        ``(ny * nx,)`` counts the crossings of each line. If `heights` and `signs` are not empty, it is where the
        next crossing of each line is written.
    heights, signs
        ``(k,)`` mm, and 1 where a line enters the solid from below, -1 where it leaves it; or empty arrays.
    """
    ny, nx = shape
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = points[a, 0], points[a, 1], points[a, 2]
        slope_x, slope_y = slopes_of(points, a, b, c)
        low, high = min(az, points[b, 2], points[c, 2]), max(az, points[b, 2], points[c, 2])
        y_low, y_high = min(ay, points[b, 1], points[c, 1]), max(ay, points[b, 1], points[c, 1])
        y_first, y_last = int(np.ceil(y_low / spacing - 0.5)), int(np.floor(y_high / spacing - 0.5))
        for iy in range(max(y_first, 0), min(y_last, ny - 1) + 1):
            y = (iy + 0.5) * spacing
            up, down = ends_in_row(points, triangles, t, y)
            if np.isinf(up) or np.isinf(down):
                continue
            sign = 1 if up < down else -1  # clockwise seen from above: the face looks down, the solid begins
            first = int(np.ceil(min(up, down) / spacing - 0.5))
            last = int(np.ceil(max(up, down) / spacing - 0.5)) - 1
            for ix in range(max(first, 0), min(last, nx - 1) + 1):
                line = iy * nx + ix
                if heights.size:
                    z = az + slope_x * ((ix + 0.5) * spacing - ax) + slope_y * (y - ay)
                    heights[place[line]] = min(max(z, low), high)
                    signs[place[line]] = sign
                place[line] += 1


@njit(cache=True, nogil=True)
def free_intervals(
    first: Int64s, heights: Float32s, signs: Int8s, top: float, start: Int64s, low: Float32s, high: Float32s
) -> int:
    """Write the free intervals of each line between height 0 and `top`, lowest first; return their number.

    Parameters
    ----------
    first
        ``(lines + 1,)`` where the crossings of each line begin, from `cross_lines`.
    heights, signs
        ``(k,)`` crossings; sorted in place for each line.
    start
        ``(lines + 1,)``, written: where the intervals of each line begin.
    low, high
        Written; ``k + lines`` entries are enough.
    """
    count = 0
    for line in range(first.size - 1):
        begin, end = first[line], first[line + 1]
        start[line] = count
        for i in range(begin + 1, end):
            z, sign, j = heights[i], signs[i], i
            # at equal heights the entering crossing comes first: solids that touch leave no interval between them
            while j > begin and (heights[j - 1] > z or (heights[j - 1] == z and signs[j - 1] < sign)):
                heights[j], signs[j] = heights[j - 1], signs[j - 1]
                j -= 1
            heights[j], signs[j] = z, sign
        winding, floor = 0, np.float32(0.0)
        for i in range(begin, end):
            before = winding
            winding += signs[i]
            if before <= 0 and winding > 0 and heights[i] > floor:
                low[count], high[count] = floor, heights[i]
                count += 1
            elif before > 0 and winding <= 0:
                floor = max(heights[i], floor)
        if winding <= 0:
            low[count], high[count] = floor, top
            count += 1
    start[first.size - 1] = count
    return count


@njit(cache=True)
def _intersect(
    work: Float32s, now: int, held: int, low: Float32s, high: Float32s, begin: int, end: int
) -> int:
    """Write the intersection of the first `held` intervals of ``work[now]`` with others to ``work[1 - now]``."""
    kept, i, j = 0, 0, begin
    while i < held and j < end:
        bottom, top = max(work[now, 0, i], low[j]), min(work[now, 1, i], high[j])
        if bottom < top:
            work[1 - now, 0, kept], work[1 - now, 1, kept] = bottom, top
            kept += 1
        if work[now, 1, i] < high[j]:
            i += 1
        else:
            j += 1
    return kept


@njit(cache=True, nogil=True)
def find_wide(
    shape: tuple[int, int],
    start: Int64s,
    low: Float32s,
    high: Float32s,
    line: Int64s,
    bottom: Float32s,
    top: Float32s,
    work: Float32s,
    wide: Bools,
) -> None:
    """Find the intervals that have room on the four diagonal lines too.

    Parameters
    ----------
    shape
        Numbers of lines (ny, nx).
    start, low, high
        Free intervals of all lines, as `free_intervals` writes them.
    line, bottom, top
        ``(n,)`` intervals to check: line, and heights in mm.
    work
        Work array as for `centre_intervals`.
    wide
        ``(n,)`` bool, written.
    """
    ny, nx = shape
    for n in range(line.size):
        iy, ix = line[n] // nx, line[n] % nx
        work[0, 0, 0], work[0, 1, 0] = bottom[n], top[n]
        now, held = 0, 1
        for side in range(4):
            jy, jx = iy + 2 * (side // 2) - 1, ix + 2 * (side % 2) - 1
            if 0 <= jy < ny and 0 <= jx < nx:
                other = jy * nx + jx
                held = _intersect(work, now, held, low, high, start[other], start[other + 1])
                now = 1 - now
        wide[n] = held > 0


@njit(cache=True, nogil=True)
def centre_intervals(
    shape: tuple[int, int],
    radius: float,
    start: Int64s,
    low: Float32s,
    high: Float32s,
    centre_start: Int64s,
    centre_low: Float32s,
    centre_high: Float32s,
    work: Float32s,
) -> int:
    """Write the intervals where the centre of a ball can be; return their number.

    A centre is `radius` away from the ends of its interval, and the four neighbouring lines are free beside it. All
    lines beyond the border are free.

    Parameters
    ----------
    shape
        Numbers of lines (ny, nx).
    start, low, high
        Free intervals of all lines, as `free_intervals` writes them.
    centre_start, centre_low, centre_high
        Written in the same way; five times as many entries as there are free intervals are enough.
    work
        ``(2, 2, most)`` float32, work array; `most` is the greatest number of intervals on five neighbouring lines.
    """
    ny, nx = shape
    count = 0
    for line in range(ny * nx):
        centre_start[line] = count
        iy, ix = line // nx, line % nx
        held = 0
        for i in range(start[line], start[line + 1]):
            if high[i] - low[i] > 2.0 * radius:
                work[0, 0, held], work[0, 1, held] = low[i] + radius, high[i] - radius
                held += 1
        now = 0
        for side in range(4):
            other = line
            if side == 0 and ix > 0:
                other = line - 1
            elif side == 1 and ix + 1 < nx:
                other = line + 1
            elif side == 2 and iy > 0:
                other = line - nx
            elif side == 3 and iy + 1 < ny:
                other = line + nx
            if other == line:
                continue
            held = _intersect(work, now, held, low, high, start[other], start[other + 1])
            now = 1 - now
        for i in range(held):
            centre_low[count], centre_high[count] = work[now, 0, i], work[now, 1, i]
            count += 1
    centre_start[ny * nx] = count
    return count


@njit(cache=True)
def _root(parent: Int32s, node: int) -> int:
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@njit(cache=True, nogil=True)
def connect_intervals(
    shape: tuple[int, int], start: Int64s, low: Float32s, high: Float32s, top: float, parent: Int32s
) -> None:
    """Connect the intervals of neighbouring lines that overlap, and open intervals with the outside.

    Parameters
    ----------
    shape
        Numbers of lines (ny, nx).
    start, low, high
        Intervals of all lines, as `free_intervals` writes them.
    top
        Intervals that reach this height (mm), or are on a line at the border, are open.
    parent
        ``(intervals + 1,)``, written: the smallest number in the pocket of each interval. Interval i has the number
        i + 1; 0 is the outside.
    """
    ny, nx = shape
    for i in range(parent.size):
        parent[i] = i
    for line in range(ny * nx):
        iy, ix = line // nx, line % nx
        border = iy == 0 or ix == 0 or iy == ny - 1 or ix == nx - 1
        for i in range(start[line], start[line + 1]):
            if border or high[i] >= top:
                parent[_root(parent, i + 1)] = 0
        for side in range(2):
            if (side == 0 and ix + 1 == nx) or (side == 1 and iy + 1 == ny):
                continue
            other = line + 1 if side == 0 else line + nx
            i, j = start[line], start[other]
            while i < start[line + 1] and j < start[other + 1]:
                if max(low[i], low[j]) < min(high[i], high[j]):
                    one, two = _root(parent, i + 1), _root(parent, j + 1)
                    parent[max(one, two)] = min(one, two)
                if high[i] < high[j]:
                    i += 1
                else:
                    j += 1
    for i in range(parent.size):
        parent[i] = _root(parent, i)
