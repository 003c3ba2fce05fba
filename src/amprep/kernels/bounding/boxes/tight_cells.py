"""Enclose what polygons have in each cell of a grid."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.bounding.boxes.polygons import MOST_CORNERS, measure, normal_component
from amprep.kernels.helper import helper
from amprep.kernels.meshes.half_space import clip_to_half_space

_ROUNDING = 1e-9
"""Fraction of a cell by which a polygon may reach into the next one without being cut."""


@helper
def _span(low: float, high: float, size: float, count: int, outwards: float) -> tuple[int, int]:
    """Return the first and last cell between two coordinates; a polygon in a face is in the cell behind it."""
    first = int(np.floor(low / size + _ROUNDING))
    last = int(np.ceil(high / size - _ROUNDING)) - 1
    if last < first:
        if outwards > 0.0:
            first = last
        else:
            last = first
    first, last = max(min(first, count - 1), 0), max(min(last, count - 1), 0)
    return first, last


@helper
def _copy(source: Floats, count: int, target: Floats) -> None:
    for i in range(count):
        for c in range(3):
            target[i, c] = source[i, c]


@helper
def _cut_off(
    polygon: Floats, count: int, axis: int, plane: float, lower: Floats, rest: Floats
) -> tuple[int, int]:
    """Write what is below a plane to `lower`, keep what is above; return both numbers of corners.

    The plane is inf for the last cell, which gets all; the polygon is then left as it is.
    """
    if plane == np.inf:
        _copy(polygon, count, lower)
        return count, count
    below = clip_to_half_space(polygon, count, axis, plane, -1.0, lower)
    above = clip_to_half_space(polygon, count, axis, plane, 1.0, rest)
    _copy(rest, above, polygon)
    return below, above


@njit(cache=True)
def tight_cells(
    points: Floats, triangles: Int64s, origin: Floats, size: Floats, shape: Int64s, tight: Floats
) -> None:
    """Enclose what triangles have in each cell, exactly: triangles are cut at the planes between cells.

    Parameters
    ----------
    points
        ``(n, 3)`` mm.
    triangles
        ``(m, 3)``, counter-clockwise seen from outside: a triangle in a plane of the grid is in the cell on the
        side of the material.
    origin, size, shape
        ``(3,)`` mm least corner of the grid, sides of a cell, and number of cells along each axis.
    tight
        ``(nx, ny, nz, 6)``, receives the enclosing box in each cell; inf and -inf in cells that no triangle meets.
    """
    tight[:, :, :, :3] = np.inf
    tight[:, :, :, 3:] = -np.inf
    work = np.empty((7, MOST_CORNERS, 3))
    bounds = np.empty(6)
    normal = np.empty(3)
    whole, slab, row, cell, rest = work[0], work[1], work[2], work[3], work[4]
    for t in range(len(triangles)):
        for i in range(3):
            for c in range(3):
                whole[i, c] = points[triangles[t, i], c]
        for c in range(3):
            normal[c] = normal_component(whole, c)
        measure(whole, 3, bounds)
        x0, x1 = _span(bounds[0] - origin[0], bounds[3] - origin[0], size[0], shape[0], normal[0])
        n_whole = 3
        for x in range(x0, x1 + 1):
            plane = origin[0] + (x + 1) * size[0] if x < x1 else np.inf
            n_slab, n_whole = _cut_off(whole, n_whole, 0, plane, slab, rest)
            if n_slab == 0:
                continue
            measure(slab, n_slab, bounds)
            y0, y1 = _span(bounds[1] - origin[1], bounds[4] - origin[1], size[1], shape[1], normal[1])
            for y in range(y0, y1 + 1):
                plane = origin[1] + (y + 1) * size[1] if y < y1 else np.inf
                n_row, n_slab = _cut_off(slab, n_slab, 1, plane, row, rest)
                if n_row == 0:
                    continue
                measure(row, n_row, bounds)
                z0, z1 = _span(bounds[2] - origin[2], bounds[5] - origin[2], size[2], shape[2], normal[2])
                for z in range(z0, z1 + 1):
                    plane = origin[2] + (z + 1) * size[2] if z < z1 else np.inf
                    n_cell, n_row = _cut_off(row, n_row, 2, plane, cell, rest)
                    for i in range(n_cell):
                        for c in range(3):
                            tight[x, y, z, c] = min(tight[x, y, z, c], cell[i, c])
                            tight[x, y, z, c + 3] = max(tight[x, y, z, c + 3], cell[i, c])
