"""Flood kernels for loose powder: upright lines through solids, the free runs on them, and what those join to.

Lines stand on a square grid in plan, numbered row by row: line (y, x) is ``y * nx + x``. Float32s are mm; a
run is an interval of a line without solid.
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

    `place` ``(ny * nx,)`` counts the crossings of each line; with room in `heights` and `signs`, it says
    where the next one goes. A sign of 1 enters the solid on the way up, -1 leaves it.
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
            sign = 1 if up < down else -1  # clockwise seen from above: it looks down, the solid begins
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
def free_runs(
    first: Int64s, heights: Float32s, signs: Int8s, top: float, start: Int64s, low: Float32s, high: Float32s
) -> int:
    """Write the runs between height 0 and `top` of each line, upwards; return how many there are.

    Parameters
    ----------
    first
        ``(lines + 1,)`` where the crossings of each line begin, from `cross_lines`; they get sorted here.
    start
        ``(lines + 1,)`` written: where the runs of each line begin.
    low, high
        Written: one more for each line than crossings is enough.
    """
    count = 0
    for line in range(first.size - 1):
        begin, end = first[line], first[line + 1]
        start[line] = count
        for i in range(begin + 1, end):
            z, sign, j = heights[i], signs[i], i
            # of equal heights the one that enters comes first: solids that touch leave nothing between them
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
def _meet(spare: Float32s, now: int, held: int, low: Float32s, high: Float32s, begin: int, end: int) -> int:
    """Write to ``spare[1 - now]`` what the `held` intervals of ``spare[now]`` share with runs; return how many."""
    kept, i, j = 0, 0, begin
    while i < held and j < end:
        bottom, lid = max(spare[now, 0, i], low[j]), min(spare[now, 1, i], high[j])
        if bottom < lid:
            spare[1 - now, 0, kept], spare[1 - now, 1, kept] = bottom, lid
            kept += 1
        if spare[now, 1, i] < high[j]:
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
    lid: Float32s,
    spare: Float32s,
    wide: Bools,
) -> None:
    """Tell which parts of runs, `bottom` to `lid` on a line each, have room across as well: on the diagonal lines.

    `spare` is as for `roomy_runs`.
    """
    ny, nx = shape
    for n in range(line.size):
        iy, ix = line[n] // nx, line[n] % nx
        spare[0, 0, 0], spare[0, 1, 0] = bottom[n], lid[n]
        now, held = 0, 1
        for side in range(4):
            jy, jx = iy + 2 * (side // 2) - 1, ix + 2 * (side % 2) - 1
            if 0 <= jy < ny and 0 <= jx < nx:
                other = jy * nx + jx
                held = _meet(spare, now, held, low, high, start[other], start[other + 1])
                now = 1 - now
        wide[n] = held > 0


@njit(cache=True, nogil=True)
def roomy_runs(
    shape: tuple[int, int],
    radius: float,
    start: Int64s,
    low: Float32s,
    high: Float32s,
    room: Int64s,
    room_low: Float32s,
    room_high: Float32s,
    spare: Float32s,
) -> int:
    """Write the parts of runs where a ball has room: `radius` up and down, and one line to each side.

    Beyond the border all is free. `room` is as `start`; five times as many runs as there are is enough
    room in `room_low` and `room_high`. `spare` ``(2, 2, most)`` is for work, `most` the greatest number
    of runs on five lines that meet. Returns how many runs there are.
    """
    ny, nx = shape
    count = 0
    for line in range(ny * nx):
        room[line] = count
        iy, ix = line // nx, line % nx
        held = 0
        for i in range(start[line], start[line + 1]):
            if high[i] - low[i] > 2.0 * radius:
                spare[0, 0, held], spare[0, 1, held] = low[i] + radius, high[i] - radius
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
            held = _meet(spare, now, held, low, high, start[other], start[other + 1])
            now = 1 - now
        for i in range(held):
            room_low[count], room_high[count] = spare[now, 0, i], spare[now, 1, i]
            count += 1
    room[ny * nx] = count
    return count


@njit(cache=True)
def _root(parent: Int32s, node: int) -> int:
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@njit(cache=True, nogil=True)
def join_runs(
    shape: tuple[int, int], start: Int64s, low: Float32s, high: Float32s, lid: float, parent: Int32s
) -> None:
    """Join runs of neighbouring lines that overlap, and what is open to the outside.

    `parent` ``(runs + 1,)`` is written: the least run of each run's pocket; 0 is the outside, and run i
    is number i + 1. Runs are open that reach up to `lid` or lie on a line at the border.
    """
    ny, nx = shape
    for i in range(parent.size):
        parent[i] = i
    for line in range(ny * nx):
        iy, ix = line // nx, line % nx
        border = iy == 0 or ix == 0 or iy == ny - 1 or ix == nx - 1
        for i in range(start[line], start[line + 1]):
            if border or high[i] >= lid:
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
