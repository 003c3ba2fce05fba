"""Clip triangles to the cells of a rectilinear grid, and tell which corners of the cells are in the solid."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int16s, Int32s, Int64s
from amprep.kernels.bounding.boxes.polygons import normal_component
from amprep.kernels.bounding.grid_cuts.records import ClippedSurface, GridPlanes
from amprep.kernels.helper import helper
from amprep.kernels.meshes.half_space import clip_to_half_space

# Strategy. The coordinates of the vertices are compared exactly with the planes of the grid; vertices that should be
# in a plane have been moved into it. A triangle in a plane belongs to the cell on the side of the material, any other
# one only to cells whose interior it meets. So a cell next to a face of the solid sees nothing of it. Most triangles
# of a fine mesh are in one cell as a whole; the others are clipped plane by plane, and what is below a plane waits on a
# stack until it is clipped along the next axis.

_CORNERS = 16
"""Greatest number of corners of a triangle that was clipped by six planes."""

_STACK = 256
"""Polygons that wait: at most one for each plane of the grid."""


@helper
def _find(planes: Floats, value: float) -> int:
    """Return the last plane that is not above a value; -1 if all are."""
    low, high = -1, len(planes)
    while high - low > 1:
        middle = (low + high) >> 1
        if planes[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@helper
def _span(planes: Floats, low: float, high: float, normal: float) -> tuple[int, int]:
    """Return the first and the last cell between two coordinates; both are on the side of the material if equal."""
    most = len(planes) - 2
    first = _find(planes, low)
    last = _find(planes, high)
    if last >= 0 and planes[last] == high:
        last -= 1
    if last < first:
        if normal > 0.0:
            first = last
        else:
            last = first
    return max(min(first, most), 0), max(min(last, most), 0)


@helper
def _add(surface: ClippedSurface, polygon: Floats, count: int, cell: int, floor: float) -> None:
    """Add a polygon to the prisms over the floor of its cell."""
    for i in range(2, count):
        ux, uy = polygon[i - 1, 0] - polygon[0, 0], polygon[i - 1, 1] - polygon[0, 1]
        vx, vy = polygon[i, 0] - polygon[0, 0], polygon[i, 1] - polygon[0, 1]
        area = 0.5 * (ux * vy - uy * vx)
        middle = (polygon[0, 2] + polygon[i - 1, 2] + polygon[i, 2]) / 3.0
        surface.area[cell] += area
        surface.volume[cell] += area * (middle - floor)


@njit(cache=True, nogil=True)
def clip_to_cells(points: Floats, triangles: Int64s, planes: GridPlanes, surface: ClippedSurface) -> int:
    """Write the corners of what the triangles have in each cell, and the volume below it in the cell.

    Parameters
    ----------
    points
        ``(n, 3)``.
    triangles
        ``(m, 3)``, counter-clockwise seen from outside.
    planes
        The grid.
    surface
        Receives the corners.

    Returns
    -------
    int
        Number of corners; -1 if there is no room for them.
    """
    stack = np.empty((_STACK, _CORNERS, 3))
    counts, axes = np.empty(_STACK, np.int64), np.empty(_STACK, np.int64)
    cell = np.empty((_STACK, 3), np.int64)
    polygon, rest, normal = np.empty((_CORNERS, 3)), np.empty((_CORNERS, 3)), np.empty(3)
    seen = np.full(len(points), -1, np.int64)
    ny, nz = len(planes[1]) - 1, len(planes[2]) - 1
    out, cells = surface.points, surface.cells
    used = 0
    for t in range(len(triangles)):
        for i in range(3):
            for c in range(3):
                stack[0, i, c] = points[triangles[t, i], c]
        for c in range(3):
            normal[c] = normal_component(stack[0], c)
        counts[0], axes[0], top, whole = 3, 0, 1, True
        while top > 0:
            top -= 1
            count, axis = counts[top], axes[top]
            for i in range(count):
                for c in range(3):
                    polygon[i, c] = stack[top, i, c]
            x, y, z = cell[top, 0], cell[top, 1], cell[top, 2]
            while axis < 3:
                low, high = polygon[0, axis], polygon[0, axis]
                for i in range(1, count):
                    low, high = min(low, polygon[i, axis]), max(high, polygon[i, axis])
                first, last = _span(planes[axis], low, high, normal[axis])
                if last > first:
                    whole = False
                for at in range(first, last):
                    below = clip_to_half_space(polygon, count, axis, planes[axis][at + 1], -1.0, stack[top])
                    count = clip_to_half_space(polygon, count, axis, planes[axis][at + 1], 1.0, rest)
                    for i in range(count):
                        for c in range(3):
                            polygon[i, c] = rest[i, c]
                    if below > 2:
                        cell[top, 0], cell[top, 1], cell[top, 2] = x, y, z
                        cell[top, axis] = at
                        counts[top], axes[top] = below, axis + 1
                        top += 1
                if axis == 0:
                    x = last
                elif axis == 1:
                    y = last
                else:
                    z = last
                axis += 1
                if count < 3:
                    break
            if count < 3:
                continue
            if used + count > len(out):
                return -1
            number = (x * ny + y) * nz + z
            for i in range(count):
                if whole:
                    if seen[triangles[t, i]] == number:
                        continue
                    seen[triangles[t, i]] = number
                cells[used] = number
                for c in range(3):
                    out[used, c] = polygon[i, c]
                used += 1
            _add(surface, polygon, count, number, planes[2][z])
    return used


@njit(cache=True, nogil=True)
def count_at_corners(points: Floats, triangles: Int64s, planes: GridPlanes, change: Int16s) -> None:
    """Count how the winding number changes along the vertical lines of the corners of the cells.

    A corner may be in the surface. So it is moved by less than any length in each of the eight diagonal directions.

    Parameters
    ----------
    points, triangles
        The mesh.
    planes
        The grid.
    change
        ``(2, 2, 2, nx + 1, ny + 1, nz + 1)``, zeros; the first indices tell whether a corner is moved down along x, y
        and z. The sum up to a corner along the last axis becomes its winding number.
    """
    px, py, pz = planes
    turns = np.zeros((2, 2), np.int64)
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = points[a, 0], points[a, 1], points[a, 2]
        ux, uy, uz = points[b, 0] - ax, points[b, 1] - ay, points[b, 2] - az
        vx, vy, vz = points[c, 0] - ax, points[c, 1] - ay, points[c, 2] - az
        normal = ux * vy - uy * vx
        if normal == 0.0:
            continue
        x_low, x_high = min(ax, points[b, 0], points[c, 0]), max(ax, points[b, 0], points[c, 0])
        x0, x1 = _find(px, x_low), _find(px, x_high)
        if x0 < 0 or px[x0] < x_low:
            x0 += 1
        if x0 > x1:
            continue
        y_low, y_high = min(ay, points[b, 1], points[c, 1]), max(ay, points[b, 1], points[c, 1])
        y0, y1 = _find(py, y_low), _find(py, y_high)
        if y0 < 0 or py[y0] < y_low:
            y0 += 1
        slope_x, slope_y = (uz * vy - uy * vz) / normal, (ux * vz - uz * vx) / normal
        low, high = min(az, points[b, 2], points[c, 2]), max(az, points[b, 2], points[c, 2])
        for iy in range(y0, y1 + 1):
            y = py[iy]
            for ix in range(x0, x1 + 1):
                x = px[ix]
                turns[:] = 0
                for j in range(3):
                    p, q = triangles[t, j], triangles[t, (j + 1) % 3]
                    sign = 1
                    if points[p, 1] > points[q, 1]:
                        p, q, sign = q, p, -1
                    p_y, q_y = points[p, 1], points[q, 1]
                    if p_y == q_y or y < p_y or y > q_y:
                        continue
                    crossing = points[p, 0] + (y - p_y) * (points[q, 0] - points[p, 0]) / (q_y - p_y)
                    if y < q_y:
                        turns[0, 0] += sign if x < crossing else 0
                        turns[1, 0] += sign if x <= crossing else 0
                    if p_y < y:
                        turns[0, 1] += sign if x < crossing else 0
                        turns[1, 1] += sign if x <= crossing else 0
                height = min(max(az + slope_x * (x - ax) + slope_y * (y - ay), low), high)
                k = _find(pz, height)
                at = k if k >= 0 and pz[k] == height else k + 1
                for i in range(2):
                    for j in range(2):
                        if turns[i, j] != 0:
                            if at < len(pz):
                                change[i, j, 0, ix, iy, at] -= turns[i, j]
                            if k + 1 < len(pz):
                                change[i, j, 1, ix, iy, k + 1] -= turns[i, j]


@njit(cache=True, nogil=True)
def extremes_of_cells(points: Floats, owner: Int32s, low: Floats, size: Floats, index: Int32s) -> None:
    """Find the extreme points of the surface in each cell, in the directions to the corners, edges and faces of a cube.

    Parameters
    ----------
    points, owner
        ``(k, 3)`` and ``(k,)``, points and their cells.
    low, size
        ``(n, 3)`` least corner and sides of each cell.
    index
        ``(n, 26)``, receives the points; -1 where there is none.
    """
    index[:] = -1
    value = np.full(index.shape, -np.inf)
    products = np.empty(13)
    for i in range(len(owner)):
        cell = owner[i]
        x = (points[i, 0] - low[cell, 0]) / size[cell, 0]
        y = (points[i, 1] - low[cell, 1]) / size[cell, 1]
        z = (points[i, 2] - low[cell, 2]) / size[cell, 2]
        products[0], products[1], products[2] = x, y, z
        products[3], products[4], products[5] = x + y, x + z, y + z
        products[6], products[7], products[8] = x - y, x - z, y - z
        products[9], products[10] = x + y + z, x + y - z
        products[11], products[12] = x - y + z, x - y - z
        for d in range(13):
            if products[d] > value[cell, d]:
                value[cell, d] = products[d]
                index[cell, d] = i
            if -products[d] > value[cell, d + 13]:
                value[cell, d + 13] = -products[d]
                index[cell, d + 13] = i
