"""Fields of depth of pairs of outlines, computed when they are first needed, and read between samples."""

import numpy as np
from numba import njit

from amprep.kernels.guided_search import READ
from amprep.kernels.helper import helper
from amprep.kernels.plates.records import NONE, PHASES, UNITS, UNKNOWN

# Strategy. The distance of outline a at an offset from outline b, of which a has the smaller area, is the least signed
# distance to b among the points of a; for separate outlines this is exact. It is written by rows: for each sampled
# point of a, the signed distances of b, moved by the point, enter the minimum, sixteen at a time. Points of a are on a
# grid four times as fine, and a small correction along the normal of a makes faces exact. The depth is the clearance
# less the distance. Where the outlines themselves overlap, it is the distance to the next offset at which they do not,
# by a chamfer transform (Borgefors 1986, doi:10.1016/S0734-189X(86)80047-0). A field of 100 x 100 samples takes some
# 0.2 ms.

FAR = 20000
"""Distance (units) of offsets that no point reaches."""

STRAIGHT, DIAGONAL = UNITS, 362
"""Distances (units) of neighbours in a chamfer transform."""

COST = 4
"""Field values read, in the time in which one is computed."""


@helper
def field_size(outlines, a, b, quarter):
    """Return the number of steps from the middle of a field to its last samples along x and y."""
    step = outlines.step
    if b == outlines.bed:
        cells = int(np.ceil(outlines.half[b, 0] / step)) + 1
        return cells, cells
    hx, hy = outlines.half[a, 0], outlines.half[a, 1]
    if quarter & 1:
        hx, hy = hy, hx
    reach = min(outlines.clearance[a], outlines.clearance[b])
    cx = int(np.ceil((hx + outlines.half[b, 0] + reach) / step)) + 1
    cy = int(np.ceil((hy + outlines.half[b, 1] + reach) / step)) + 1
    return cx, cy


@helper
def field_of(outlines, cache, a, b, quarter, spent):
    """Return the index of the first value of a field, computed if it is not known; `NONE` for a pair without one."""
    first = cache.first[a, b, quarter]
    if first != UNKNOWN:
        return first
    cx, cy = field_size(outlines, a, b, quarter)
    nx, ny = 2 * cx + 1, 2 * cy + 1
    if cache.used[0] + nx * ny > cache.values.size:
        for i in range(cache.first.shape[0]):
            for j in range(cache.first.shape[1]):
                for r in range(4):
                    if cache.first[i, j, r] != NONE:
                        cache.first[i, j, r] = UNKNOWN
        cache.used[0] = 0
        cache.used[1] += 1
    first = cache.used[0]
    cache.first[a, b, quarter] = first
    cache.used[0] += nx * ny
    spent[READ] += COST * nx * ny
    out = cache.values[first : first + nx * ny]
    if b == outlines.bed:
        _outside_bed(outlines, a, quarter, cx, out)
        return first
    _distances(outlines, a, b, quarter, cx, cy, out)
    clearance = np.int16(min(outlines.clearance[a], outlines.clearance[b]) / outlines.step * UNITS + 0.5)
    _depths(clearance, nx, ny, out)
    return first


@helper
def _turned(quarter, x, y):
    """Return a vector after quarter turns."""
    if quarter == 0:
        return x, y
    if quarter == 1:
        return -y, x
    if quarter == 2:
        return -x, -y
    return y, -x


@helper
def _distances(outlines, a, b, quarter, cx, cy, out):
    """Write the distance of outline a from outline b at each offset, in units, or `FAR`."""
    nx, ny = 2 * cx + 1, 2 * cy + 1
    out[:] = np.int16(FAR)
    bx, by = outlines.cells[b, 0], outlines.cells[b, 1]
    wide, high = 2 * bx + 1, 2 * by + 1
    for k in range(outlines.first_point[a], outlines.first_point[a + 1]):
        px, py = _turned(quarter, outlines.point[k, 0], outlines.point[k, 1])
        ox, oy = px // PHASES, py // PHASES
        phase = (px - ox * PHASES) * PHASES + py - oy * PHASES
        start = outlines.first_distance[b] + phase * wide * high
        shift = outlines.shift[k]
        # offset X has the sample at X + ox in steps: row u of the distances is row u - bx - ox + cx of the field
        down, left = cx - bx - ox, cy - by - oy
        v0, v1 = max(0, -left), min(high, ny - left)
        if v1 <= v0:
            continue
        u0, u1 = max(0, -down), min(wide, nx - down)
        if u1 > u0:
            to, at = (u0 + down) * ny + v0 + left, start + u0 * high + v0
            _least(out, to, ny, outlines.distance, at, high, u1 - u0, v1 - v0, shift)


@njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False, fastmath={"nnan", "nsz"})
def _least(out, to, width, distances, at, high, rows, columns, shift):
    """Replace values of a rectangle by those of another one, less by a shift, where these are less."""
    for _ in range(rows):
        line, values = out[to : to + columns], distances[at : at + columns]
        for k in range(columns):
            value = np.int16(values[k] + shift)
            line[k] = value if value < line[k] else line[k]
        to += width
        at += high


@helper
def _depths(clearance, nx, ny, out):
    """Turn distances into depths; inside, the distance to the samples around."""
    unknown = np.int16(32000)
    for k in range(out.size):
        out[k] = np.int16(clearance - out[k]) if out[k] > -UNITS // 4 else unknown
    for x in range(nx):
        for y in range(ny):
            if out[x * ny + y] == unknown and x > 0 and 0 < y < ny - 1:
                near = min(out[(x - 1) * ny + y], out[x * ny + y - 1]) + STRAIGHT
                near = min(near, min(out[(x - 1) * ny + y - 1], out[(x - 1) * ny + y + 1]) + DIAGONAL)
                out[x * ny + y] = np.int16(min(near, 31999))
    for x in range(nx - 2, 0, -1):
        for y in range(ny - 2, 0, -1):
            if out[x * ny + y] > clearance + UNITS // 4:
                near = min(out[(x + 1) * ny + y], out[x * ny + y + 1]) + STRAIGHT
                near = min(near, min(out[(x + 1) * ny + y - 1], out[(x + 1) * ny + y + 1]) + DIAGONAL)
                out[x * ny + y] = np.int16(min(near, out[x * ny + y]))


@helper
def _outside_bed(outlines, a, quarter, cells, out):
    """Write the length by which an outline is outside the circle, at each offset from its centre."""
    step, n = outlines.step, 2 * cells + 1
    for i in range(n):
        for j in range(n):
            x, y = (i - cells) * step, (j - cells) * step
            most = 0.0
            for k in range(outlines.first_corner[a], outlines.first_corner[a + 1]):
                u, v = _turned(quarter, outlines.corner[k, 0], outlines.corner[k, 1])
                most = max(most, (u + x) ** 2 + (v + y) ** 2)
            depth = (np.sqrt(most) - outlines.radius) / step * UNITS
            out[i * n + j] = np.int16(min(max(depth, -1.0 * FAR), 1.0 * FAR))


@helper
def oriented(shapes, one, other):
    """Return outlines a <= b and quarter turns of their field, and the turns of an offset of `one` from `other`."""
    a, b = shapes.outline[one], shapes.outline[other]
    if a <= b:
        return a, b, (shapes.quarter[one] - shapes.quarter[other]) & 3, (-shapes.quarter[other]) & 3
    return b, a, (shapes.quarter[other] - shapes.quarter[one]) & 3, (2 - shapes.quarter[one]) & 3


@helper
def depth_at(outlines, cache, shapes, one, other, x, y, spent):
    """Return the depth (mm) of the overlap of two shapes at an offset of the first from the second; at least 0."""
    a, b, quarter, turns = oriented(shapes, one, other)
    cx, cy = field_size(outlines, a, b, quarter)
    x, y = _turned(turns, x, y)
    u, v = x / outlines.step + cx, y / outlines.step + cy
    if not (0.0 <= u < 2 * cx and 0.0 <= v < 2 * cy):
        return 0.0
    first = field_of(outlines, cache, a, b, quarter, spent)
    if first == NONE:
        return 0.0
    i, j = int(u), int(v)
    s, t = u - i, v - j
    at = first + i * (2 * cy + 1) + j
    values = cache.values
    lower = (1.0 - t) * values[at] + t * values[at + 1]
    upper = (1.0 - t) * values[at + 2 * cy + 1] + t * values[at + 2 * cy + 2]
    return max(0.0, (1.0 - s) * lower + s * upper) * (outlines.step / UNITS)
