"""Scan of a plate: the weighted overlap of one item at all points of a grid, as a sum of moved and turned fields."""

import numpy as np
from numba import njit

from amprep.arrays import Floats
from amprep.kernels.guided_search import EVERYWHERE, READ, MoveRules, keep_best
from amprep.kernels.helper import helper
from amprep.kernels.plates.fields import field_of, field_size, oriented
from amprep.kernels.plates.records import (
    NONE,
    UNITS,
    FieldCache,
    PlateLayout,
    PlateShapes,
    PlateState,
    SampledOutlines,
)

BLOCK = 6
"""Side of the blocks of cells of which a scan proposes the best cell."""


@helper
def scan_size(outlines, shapes, shape):
    """Return the number of grid points of a scan along x and y, 0 if the shape fits no plate."""
    lo, hi = shapes.lo[shape], shapes.hi[shape]
    if hi[0] < lo[0] or hi[1] < lo[1]:
        return 0, 0
    return int((hi[0] - lo[0]) / outlines.step + 1e-6) + 1, int((hi[1] - lo[1]) / outlines.step + 1e-6) + 1


@helper
def add_overlaps(outlines, cache, shapes, layout, item, start, size, state):
    """Write the weighted overlap of an item with all others of its plate into `state.sums`, row by row.

    Parameters
    ----------
    start
        Position at the first cell, mm.
    size
        Number of cells along x and y.
    """
    gx, gy = size
    sums, turned = state.sums[: gx * gy], state.turned[: gx * gy]
    sums[:] = np.float32(0.0)
    columns, plate = False, layout.plate[item]
    for other in range(layout.shape.size):
        if other == item or (layout.plate[other] != plate and layout.plate[other] != EVERYWHERE):
            continue
        a, b, quarter, turns = oriented(shapes, layout.shape[item], layout.shape[other])
        if cache.first[a, b, quarter] == NONE:
            continue
        pair, weight = (a, b, quarter), state.weight[item, other]
        dx, dy = start[0] - layout.position[other, 0], start[1] - layout.position[other, 1]
        if turns & 1:
            if not columns:
                turned[:] = np.float32(0.0)
                columns = True
            offset, sign = ((-dy, dx), (-1, 1)) if turns == 1 else ((dy, -dx), (1, -1))
            _add_field(outlines, cache, pair, offset, sign, weight, (gy, gx), turned, state)
        else:
            offset, sign = ((dx, dy), (1, 1)) if turns == 0 else ((-dx, -dy), (-1, -1))
            _add_field(outlines, cache, pair, offset, sign, weight, size, sums, state)
    if columns:
        for i in range(gx):
            for j in range(gy):
                sums[i * gy + j] += turned[j * gx + i]


@helper
def _add_field(outlines, cache, pair, offset, sign, weight, size, sums, state):
    """Add the weighted depths of a pair at the offsets of a grid, between samples.

    Along each axis the offset of a cell is the first one plus or minus, by the sign, so many steps.
    """
    a, b, quarter = pair
    rows, columns = size
    cx, cy = field_size(outlines, a, b, quarter)
    u, v = offset[0] / outlines.step + cx, offset[1] / outlines.step + cy
    fu, fv = int(np.floor(u)), int(np.floor(v))
    s, t = u - fu, v - fv
    r0, r1 = _cells_in_field(fu, sign[0], 2 * cx, rows)
    k0, k1 = _cells_in_field(fv, sign[1], 2 * cy, columns)
    if r0 >= r1 or k0 >= k1:
        return
    first, high, n = field_of(outlines, cache, a, b, quarter, state.spent), 2 * cy + 1, k1 - k0
    state.spent[READ] += (r1 - r0) * n
    scale = weight * outlines.step / UNITS
    w00, w01 = np.float32((1.0 - s) * (1.0 - t) * scale), np.float32((1.0 - s) * t * scale)
    w10, w11 = np.float32(s * (1.0 - t) * scale), np.float32(s * t * scale)
    for r in range(r0, r1):
        to = r * columns + k0
        at = first + (fu + sign[0] * r) * high + fv + (k0 if sign[1] > 0 else -(k1 - 1))
        lower, upper = cache.values[at : at + n + 1], cache.values[at + high : at + high + n + 1]
        if sign[1] > 0:
            _add_line(sums[to : to + n], lower, upper, w00, w01, w10, w11)
        else:
            _add_line_backwards(sums[to : to + n], lower, upper, w00, w01, w10, w11)


@helper
def _cells_in_field(first, sign, end, cells):
    """Return the range of cells k among some for which ``0 <= first + sign * k < end``."""
    if sign > 0:
        return max(0, -first), min(cells, end - first)
    return max(0, first - end + 1), min(cells, first + 1)


@njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False, fastmath={"nnan", "nsz", "contract"})
def _add_line(sums, lower, upper, w00, w01, w10, w11):
    for k in range(sums.size):
        value = w00 * np.float32(lower[k]) + w01 * np.float32(lower[k + 1])
        value += w10 * np.float32(upper[k]) + w11 * np.float32(upper[k + 1])
        sums[k] += value if value > np.float32(0.0) else np.float32(0.0)


@njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False, fastmath={"nnan", "nsz", "contract"})
def _add_line_backwards(sums, lower, upper, w00, w01, w10, w11):
    last = sums.size - 1
    for k in range(sums.size):
        value = w00 * np.float32(lower[last - k]) + w01 * np.float32(lower[last - k + 1])
        value += w10 * np.float32(upper[last - k]) + w11 * np.float32(upper[last - k + 1])
        sums[k] += value if value > np.float32(0.0) else np.float32(0.0)


@helper
def best_cells(sums, size, cell, value):
    """Write the best cell of each block of cells, for the best blocks, best first; return their number."""
    gx, gy = size
    count = 0
    for bx in range(0, gx, BLOCK):
        for by in range(0, gy, BLOCK):
            least, where = np.float32(np.inf), -1
            for x in range(bx, min(bx + BLOCK, gx)):
                for y in range(by, min(by + BLOCK, gy)):
                    if sums[x * gy + y] < least:
                        least, where = sums[x * gy + y], x * gy + y
            count = keep_best(cell, value, count, where, least)
    return count


@njit(cache=True, nogil=True, _nrt=False)
def first_free(
    outlines: SampledOutlines,
    cache: FieldCache,
    shapes: PlateShapes,
    layout: PlateLayout,
    state: PlateState,
    rules: MoveRules,
    item: int,
    direction: Floats,
    free: float,
) -> int:
    """Move an item to the position on its plate, in any of its shapes, that is free and first in a direction.

    Parameters
    ----------
    layout
        The shape and the position of the item are written; they have no meaning if no position is free.
    state
        Its weights must be 1.
    direction
        ``(2,)`` the least product with it of the far corner of the enclosing box is first.
    free
        Overlap (mm) that counts as none.

    Returns
    -------
    The shape, or -1 if no position is free.
    """
    best, chosen, u, v = np.inf, -1, 0.0, 0.0
    for shape in range(rules.first[item], rules.end[item]):
        size = scan_size(outlines, shapes, shape)
        gx, gy = size
        if gx == 0:
            continue
        x, y = shapes.lo[shape, 0], shapes.lo[shape, 1]
        layout.shape[item] = shape
        add_overlaps(outlines, cache, shapes, layout, item, (x, y), size, state)
        hx, hy = outlines.half[shapes.outline[shape], 0], outlines.half[shapes.outline[shape], 1]
        if shapes.quarter[shape] & 1:
            hx, hy = hy, hx
        corner = abs(direction[0]) * hx + abs(direction[1]) * hy
        for i in range(gx):
            for j in range(gy):
                if state.sums[i * gy + j] <= free:
                    px, py = x + i * outlines.step, y + j * outlines.step
                    key = direction[0] * px + direction[1] * py + corner
                    if key < best:
                        best, chosen = key, shape
                        u, v = px, py
    if chosen >= 0:
        layout.shape[item], layout.position[item, 0], layout.position[item, 1] = chosen, u, v
    return chosen
