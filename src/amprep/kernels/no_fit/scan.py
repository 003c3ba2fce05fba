"""Scan of the build volume: the weighted overlap of one item at all cells of a grid, as a sum of shifted fields."""

import numpy as np
from numba import njit

from amprep.arrays import Float32s, Floats, Int64s
from amprep.kernels.guided_search import EVERYWHERE, keep_best
from amprep.kernels.helper import helper, inlined
from amprep.kernels.no_fit.depth import depth_at, outside_circle
from amprep.kernels.no_fit.records import NoFitFields, PositionRange, ShapeLayout

FREE = 1e-4
"""Total overlap (mm) that counts as none; rounding of samples causes less."""

BLOCK = 4
"""Side of the blocks of cells of which a scan proposes the best cell."""


@helper
def add_overlaps(fields, within, layout, weights, item, since, start, grid, sums):
    """Add the weighted overlap of an item with others of its build at the cells of a grid; return values read.

    Parameters
    ----------
    weights
        ``(n, n)`` weights of the overlaps, and the weight of the length outside the circle.
    since
        The others are the rows of the layout from this one on. From row 0 on, the sums are set to 0 before, and lengths
        outside the circle are added.
    start
        Three floats, mm: position at the first cell. Cells are two steps of the fields apart.
    grid
        Three ints, number of cells along each axis.
    sums
        ``(g,)``, modified.
    """
    gx, gy, gz = grid
    weight, outside_weight = weights
    shape, build, step = layout.shape[item], layout.build[item], fields.step
    if since == 0:
        sums[: gx * gy * gz] = np.float32(0.0)
    read = 0
    for other in range(since, layout.shape.size):
        if other == item or (layout.build[other] != build and layout.build[other] != EVERYWHERE):
            continue
        b = layout.shape[other]
        if fields.first[shape, b] < 0:
            continue
        nx, ny, nz = fields.cells[shape, b, 0], fields.cells[shape, b, 1], fields.cells[shape, b, 2]
        origin, position = fields.origin[shape, b], layout.position[other]
        kx = int(np.floor((start[0] - position[0] - origin[0]) / step + 0.5))
        ky = int(np.floor((start[1] - position[1] - origin[1]) / step + 0.5))
        kz = int(np.floor((start[2] - position[2] - origin[2]) / step + 0.5))
        base, stride = ((kx & 1) * 4 + (ky & 1) * 2 + (kz & 1)) * nx * ny * nz, fields.stride[shape, b]
        sx, sy, sz = kx >> 1, ky >> 1, kz >> 1
        x0, x1 = max(0, -sx), min(gx, nx - sx)
        y0, y1 = max(0, -sy), min(gy, ny - sy)
        z0, z1 = max(0, -sz), min(gz, nz - sz)
        if x0 >= x1 or y0 >= y1 or z0 >= z1:
            continue
        length, factor = z1 - z0, np.float32(weight[item, other] * fields.scale)
        read += (x1 - x0) * (y1 - y0) * length
        for x in range(x0, x1):
            for y in range(y0, y1):
                to = (x * gy + y) * gz + z0
                at = fields.first[shape, b] + stride * (base + ((x + sx) * ny + y + sy) * nz + z0 + sz)
                if stride > 0:
                    _add_line(sums, to, fields.values, at, length, factor)
                else:
                    _add_backwards(sums, to, fields.values, at, length, factor)
    if within.radius > 0.0 and since == 0:
        _add_outside(within, shape, outside_weight, start, grid, 2.0 * step, sums)
    return read


@inlined
def _add_line(sums, to, values, at, length, factor):
    """Add the positive values of a line; with unsigned indices, so that the loop is vectorised without a call."""
    first, other = np.uint64(to), np.uint64(at)
    for k in range(np.uint64(length)):
        value = np.float32(values[other + k])
        sums[first + k] += factor * (value if value > np.float32(0.0) else np.float32(0.0))


@inlined
def _add_backwards(sums, to, values, at, length, factor):
    """Add the positive values of a line that is read backwards from an index."""
    first, other = np.uint64(to), np.uint64(at)
    for k in range(np.uint64(length)):
        value = np.float32(values[other - k])
        sums[first + k] += factor * (value if value > np.float32(0.0) else np.float32(0.0))


@helper
def _add_outside(within, shape, weight, start, grid, spacing, sums):
    gx, gy, gz = grid
    for x in range(gx):
        for y in range(gy):
            beyond = outside_circle(within, shape, start[0] + x * spacing, start[1] + y * spacing)
            if beyond > 0.0:
                row = (x * gy + y) * gz
                for z in range(gz):
                    sums[row + z] += np.float32(weight * beyond)


@helper
def best_cells(sums, grid, cell, value):
    """Write the best cell of each block of cells, for the best blocks, best first; return their number."""
    gx, gy, gz = grid
    count = 0
    for bx in range(0, gx, BLOCK):
        for by in range(0, gy, BLOCK):
            for bz in range(0, gz, BLOCK):
                least, where = np.inf, -1
                for x in range(bx, min(bx + BLOCK, gx)):
                    for y in range(by, min(by + BLOCK, gy)):
                        row = (x * gy + y) * gz
                        for z in range(bz, min(bz + BLOCK, gz)):
                            if sums[row + z] < least:
                                least, where = sums[row + z], row + z
                count = keep_best(cell, value, count, where, least)
    return count


@helper
def _is_free(fields, within, layout, item, x, y, z):
    """Tell whether an item overlaps nothing of its build at a position."""
    if outside_circle(within, layout.shape[item], x, y) > FREE:
        return False
    for other in range(layout.shape.size):
        if other != item and (layout.build[other] == layout.build[item] or layout.build[other] == EVERYWHERE):
            u, v, w = layout.position[other]
            if depth_at(fields, layout.shape[item], layout.shape[other], x - u, y - v, z - w) > FREE:
                return False
    return True


@njit(cache=True, nogil=True, _nrt=False)
def lowest_free(
    fields: NoFitFields,
    within: PositionRange,
    layout: ShapeLayout,
    weight: Floats,
    item: int,
    since: int,
    grid: Int64s,
    sums: Float32s,
) -> int:
    """Move an item to the lowest position of a grid at which it overlaps nothing of its build, then of least x + y.

    From there it goes further down and to the sides, by steps of the fields. All positions are multiples of the step
    from the least position of the item's shape, so that samples are exact.

    Parameters
    ----------
    layout
        The item's position is written if there is one.
    weight
        ``(n, n)`` ones.
    since
        Row of the layout from which on items are new since `sums` was written for the same shape, build and grid;
        0 if it was not.
    grid
        ``(3,)`` number of cells, two steps apart.
    sums
        Overlap (mm) at the cells, modified.

    Returns
    -------
    The number of field values read, negative if there is no free position.
    """
    shape = layout.shape[item]
    size = (grid[0], grid[1], grid[2])
    lo = within.lo[shape]
    start = (lo[0], lo[1], lo[2])
    read = add_overlaps(fields, within, layout, (weight, 1.0), item, since, start, size, sums)
    read += grid[0] * grid[1] * grid[2] + 1
    best, height, beside = -1, grid[2], 0
    for x in range(grid[0]):
        for y in range(grid[1]):
            row = (x * grid[1] + y) * grid[2]
            for z in range(min(grid[2], height + 1)):
                if sums[row + z] <= FREE:
                    if z < height or x + y < beside:
                        best, height, beside = row + z, z, x + y
                    break
    if best < 0:
        return -read
    u = lo[0] + 2.0 * fields.step * (best // (grid[1] * grid[2]))
    v = lo[1] + 2.0 * fields.step * (best // grid[2] % grid[1])
    w = lo[2] + 2.0 * fields.step * (best % grid[2])
    step, moved = fields.step, True
    while moved:
        moved = False
        for axis in (2, 0, 1):
            x, y, z = u - step * (axis == 0), v - step * (axis == 1), w - step * (axis == 2)
            inside = x > lo[0] - 1e-9 and y > lo[1] - 1e-9 and z > lo[2] - 1e-9
            if inside and _is_free(fields, within, layout, item, x, y, z):
                u, v, w, moved = x, y, z, True
                break
    layout.position[item, 0], layout.position[item, 1], layout.position[item, 2] = u, v, w
    return read
