"""Depth of overlaps: sampled from convex polyhedra, and read between samples."""

import numpy as np
from numba import njit

from amprep.arrays import Float32s, Floats
from amprep.kernels.helper import helper
from amprep.kernels.no_fit.records import NoFitFields, NoFitSolid, PositionRange


@njit(cache=True, nogil=True, _nrt=False, fastmath={"nnan", "nsz"})
def sample_depth(solid: NoFitSolid, origin: Floats, step: float, line: Float32s, out: Float32s) -> None:
    """Write the greatest depth in the convex polyhedra of a solid at the points of a grid.

    The depth in a polyhedron is the least distance to the planes of its faces. It is written up to two steps from the
    box of the polyhedron, and at least ``-2 * step`` everywhere.

    Parameters
    ----------
    origin
        ``(3,)`` mm, the first grid point.
    line
        ``(nz,)`` work array.
    out
        ``(nx, ny, nz)`` mm, modified.
    """
    out[:] = np.float32(-2.0 * step)
    nx, ny, nz = out.shape
    for k in range(solid.box.shape[0]):
        x0 = max(0, int(np.floor((solid.box[k, 0] - origin[0]) / step)) - 1)
        y0 = max(0, int(np.floor((solid.box[k, 1] - origin[1]) / step)) - 1)
        z0 = max(0, int(np.floor((solid.box[k, 2] - origin[2]) / step)) - 1)
        x1 = min(nx, int(np.ceil((solid.box[k, 3] - origin[0]) / step)) + 2)
        y1 = min(ny, int(np.ceil((solid.box[k, 4] - origin[1]) / step)) + 2)
        z1 = min(nz, int(np.ceil((solid.box[k, 5] - origin[2]) / step)) + 2)
        for x in range(x0, x1):
            for y in range(y0, y1):
                _depth_on_line(solid, k, origin, step, x, y, z0, z1, line)
                row = out[x, y]
                for z in range(z0, z1):
                    row[z] = line[z] if line[z] > row[z] else row[z]


@helper
def _depth_on_line(solid, k, origin, step, x, y, z0, z1, line):
    """Write the depth in polyhedron k at the grid points (x, y, z) with z0 <= z < z1."""
    px, py = origin[0] + x * step, origin[1] + y * step
    for z in range(z0, z1):
        line[z] = np.float32(np.inf)
    for q in range(solid.first_plane[k], solid.first_plane[k + 1]):
        a, b, c = solid.planes[q, 0], solid.planes[q, 1], solid.planes[q, 2]
        start = solid.planes[q, 3] - a * px - b * py - c * origin[2]
        slope = -c * step
        for z in range(z0, z1):
            depth = np.float32(start + slope * z)
            line[z] = depth if depth < line[z] else line[z]


@helper
def depth_at(fields: NoFitFields, a: int, b: int, x: float, y: float, z: float) -> float:
    """Return the depth (mm) at an offset of shape a from shape b, between samples; 0 outside or without a field."""
    if fields.first[a, b] < 0:
        return 0.0
    cells = fields.cells[a, b]
    field = (fields.first[a, b], fields.stride[a, b], cells[0], cells[1], cells[2])
    u = (x - fields.origin[a, b, 0]) / fields.step
    v = (y - fields.origin[a, b, 1]) / fields.step
    w = (z - fields.origin[a, b, 2]) / fields.step
    return depth_between(fields.values, field, u, v, w) * fields.scale


@helper
def depth_between(values, field, u, v, w):
    """Return the depth between the samples of a field, at (u, v, w) steps from the first one; 0 outside.

    Parameters
    ----------
    field
        Five ints: index of the first sample, stride, and numbers of samples in one phase.
    """
    start, stride = field[0], field[1]
    nx, ny, nz = field[2], field[3], field[4]
    if not (0.0 <= u < 2 * nx - 1 and 0.0 <= v < 2 * ny - 1 and 0.0 <= w < 2 * nz - 1):
        return 0.0
    i, j, k = int(u), int(v), int(w)
    tx, ty, tz = u - i, v - j, w - k
    phase = nx * ny * nz
    lower, upper = (k & 1) * phase + (k >> 1), ((k + 1) & 1) * phase + ((k + 1) >> 1)
    depth = 0.0
    for dx in range(2):
        for dy in range(2):
            at = (((i + dx) & 1) * 4 + ((j + dy) & 1) * 2) * phase
            at += (((i + dx) >> 1) * ny + ((j + dy) >> 1)) * nz
            share = (tx if dx else 1.0 - tx) * (ty if dy else 1.0 - ty)
            # Unsigned indices are not checked for being negative.
            one, other = np.uint64(start + stride * (at + lower)), np.uint64(start + stride * (at + upper))
            depth += share * ((1.0 - tz) * values[one] + tz * values[other])
    return max(depth, 0.0)


@helper
def outside_circle(within: PositionRange, shape: int, x: float, y: float) -> float:
    """Return the length (mm) by which the outline of a shape at a position is outside the circle; 0 without one."""
    if within.radius == 0.0:
        return 0.0
    farthest = 0.0
    for k in range(within.first[shape], within.first[shape + 1]):
        dx = within.outline[k, 0] + x - within.centre[0]
        dy = within.outline[k, 1] + y - within.centre[1]
        farthest = max(farthest, dx * dx + dy * dy)
    return max(0.0, np.sqrt(farthest) - within.radius)
