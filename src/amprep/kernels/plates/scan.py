"""Scan of a plate: the weighted overlap of one item at all points of a grid, as a sum of moved and turned fields."""

import numpy as np
from numba import njit

from amprep.arrays import Floats
from amprep.kernels.helper import helper
from amprep.kernels.plates.fields import field_of, field_size, oriented
from amprep.kernels.plates.records import (
    EVERY_PLATE,
    NONE,
    READ,
    UNITS,
    FieldCache,
    PlateLayout,
    PlateRules,
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
def add_overlaps(outlines, cache, shapes, layout, weight, item, shape, plate, x, y, gx, gy, state):
    """Write the weighted overlap of an item with all others of a plate into `state.sums`, ``(gx, gy)`` row by row.

    Parameters
    ----------
    weight
        ``(n,)`` weights of the overlaps.
    x, y
        Position at the first cell, mm.
    """
    sums, turned = state.sums[: gx * gy], state.turned[: gx * gy]
    sums[:] = np.float32(0.0)
    columns = False
    for other in range(layout.shape.size):
        if other == item or (layout.plate[other] != plate and layout.plate[other] != EVERY_PLATE):
            continue
        a, b, quarter, turns = oriented(shapes, shape, layout.shape[other])
        if cache.first[a, b, quarter] == NONE:
            continue
        dx, dy = x - layout.position[other, 0], y - layout.position[other, 1]
        cx, cy = field_size(outlines, a, b, quarter)
        if turns & 1:
            if not columns:
                turned[:] = np.float32(0.0)
                columns = True
            u, v = (-dy, dx) if turns == 1 else (dy, -dx)
            sign_u, sign_v = (-1, 1) if turns == 1 else (1, -1)
            _add_field(
                outlines,
                cache,
                a,
                b,
                quarter,
                cx,
                cy,
                u,
                v,
                sign_u,
                sign_v,
                weight[other],
                gy,
                gx,
                turned,
                state,
            )
        else:
            sign = 1 if turns == 0 else -1
            _add_field(
                outlines,
                cache,
                a,
                b,
                quarter,
                cx,
                cy,
                sign * dx,
                sign * dy,
                sign,
                sign,
                weight[other],
                gx,
                gy,
                sums,
                state,
            )
    if columns:
        for i in range(gx):
            for j in range(gy):
                sums[i * gy + j] += turned[j * gx + i]


@helper
def _add_field(
    outlines, cache, a, b, quarter, cx, cy, u, v, sign_u, sign_v, weight, rows, columns, sums, state
):
    """Add the depths at offsets (u + sign_u * step * row, v + sign_v * step * column), between samples."""
    u, v = u / outlines.step + cx, v / outlines.step + cy
    fu, fv = int(np.floor(u)), int(np.floor(v))
    s, t = u - fu, v - fv
    # rows r with 0 <= fu + sign_u * r < 2 * cx
    r0 = max(0, -fu) if sign_u > 0 else max(0, fu - 2 * cx + 1)
    r1 = min(rows, 2 * cx - fu) if sign_u > 0 else min(rows, fu + 1)
    k0 = max(0, -fv) if sign_v > 0 else max(0, fv - 2 * cy + 1)
    k1 = min(columns, 2 * cy - fv) if sign_v > 0 else min(columns, fv + 1)
    if r0 >= r1 or k0 >= k1:
        return
    first, high, n = field_of(outlines, cache, a, b, quarter, state.spent), 2 * cy + 1, k1 - k0
    state.spent[READ] += (r1 - r0) * n
    scale = weight * outlines.step / UNITS
    w00, w01 = np.float32((1.0 - s) * (1.0 - t) * scale), np.float32((1.0 - s) * t * scale)
    w10, w11 = np.float32(s * (1.0 - t) * scale), np.float32(s * t * scale)
    for r in range(r0, r1):
        to = r * columns + k0
        at = first + (fu + sign_u * r) * high + fv + (k0 if sign_v > 0 else -(k1 - 1))
        lower, upper = cache.values[at : at + n + 1], cache.values[at + high : at + high + n + 1]
        if sign_v > 0:
            _add_line(sums[to : to + n], lower, upper, w00, w01, w10, w11)
        else:
            _add_line_backwards(sums[to : to + n], lower, upper, w00, w01, w10, w11)


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
def best_cells(sums, gx, gy, cell, value):
    """Write the best cell of each block of cells, for the best blocks, best first; return their number."""
    count = 0
    for bx in range(0, gx, BLOCK):
        for by in range(0, gy, BLOCK):
            least, where = np.float32(np.inf), -1
            for x in range(bx, min(bx + BLOCK, gx)):
                for y in range(by, min(by + BLOCK, gy)):
                    if sums[x * gy + y] < least:
                        least, where = sums[x * gy + y], x * gy + y
            if count < cell.size:
                k = count
                count += 1
            elif least < value[count - 1]:
                k = count - 1
            else:
                continue
            while k > 0 and value[k - 1] > least:
                value[k], cell[k] = value[k - 1], cell[k - 1]
                k -= 1
            value[k], cell[k] = least, where
    return count


@njit(cache=True, nogil=True, _nrt=False)
def first_free(
    outlines: SampledOutlines,
    cache: FieldCache,
    shapes: PlateShapes,
    layout: PlateLayout,
    state: PlateState,
    rules: PlateRules,
    item: int,
    plate: int,
    direction: Floats,
    free: float,
    found: Floats,
) -> int:
    """Find the position of an item, in any of its shapes, that is free and first in a direction.

    Parameters
    ----------
    state
        Its weights must be 1.
    direction
        ``(2,)`` the least product with it of the far corner of the enclosing box is first.
    free
        Overlap (mm) that counts as none.
    found
        ``(2,)`` written, mm.

    Returns
    -------
    The shape, or -1.
    """
    best, chosen = np.inf, -1
    for shape in range(rules.first[item], rules.end[item]):
        gx, gy = scan_size(outlines, shapes, shape)
        if gx == 0:
            continue
        x, y = shapes.lo[shape, 0], shapes.lo[shape, 1]
        add_overlaps(
            outlines, cache, shapes, layout, state.weight[item], item, shape, plate, x, y, gx, gy, state
        )
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
                        found[0], found[1] = px, py
    return chosen
