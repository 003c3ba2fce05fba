"""Voxelisation kernels: find the voxels that triangles, edges and points meet, and the voxel centres inside a solid.

Coordinates are mm relative to the smallest corner of a block of voxels; arrays over the block are indexed [k, y, x].
"""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int16s, Int32s, Int64s
from amprep.kernels.meshes.half_space import clip_to_half_space
from amprep.kernels.meshes.rows import ends_in_row, slopes_of


@njit(cache=True)
def _mark_column(
    polygon: Floats,
    count: int,
    label: int,
    step: float,
    tolerance: float,
    holds: bool,
    iy: int,
    ix: int,
    marks: Int32s,
) -> None:
    """Lower the labels of the voxels of one column that the height interval of ``polygon[:count]`` meets."""
    low = polygon[0, 2]
    high = low
    for i in range(1, count):
        low = min(low, polygon[i, 2])
        high = max(high, polygon[i, 2])
    first = int(np.floor((low + tolerance) / step))
    last = int(np.ceil((high - tolerance) / step)) - 1
    if holds and last < first:
        last = first
    for k in range(max(first, 0), min(last, marks.shape[0] - 1) + 1):
        marks[k, iy, ix] = min(marks[k, iy, ix], label)


# Strategy. A voxel is a square of the grid times a height interval. The elements (triangles, edges, points) are convex,
# so an element clipped to the vertical prism over a square is convex and connected: it meets just the voxels of the
# column between its lowest and its highest corner. An element is first clipped to a row of squares (a band in y), then
# the band to each square; elements inside a band or square are not clipped. Clipping a triangle by four planes
# leaves at most seven corners. The work is proportional to the number of columns that the elements meet.
@njit(cache=True)
def mark_elements(
    points: Floats,
    elements: Int64s,
    labels: Int32s,
    pitch: float,
    step: float,
    grow: float,
    tolerance: float,
    holds: bool,
    marks: Int32s,
) -> None:
    """Lower `marks` to the smallest label of the elements that meet each voxel.

    Parameters
    ----------
    points
        ``(n, 3)`` mm.
    elements
        ``(m, 3)`` triangles, edges ``(a, b, b)`` or points ``(a, a, a)``.
    labels
        ``(m,)`` label of each element.
    pitch, step
        Horizontal and vertical voxel size, mm.
    grow
        Squares are widened by it on each side, mm; negative values shrink them.
    tolerance
        Heights within it (mm) of a plane of the grid do not reach the voxel beyond the plane.
    holds
        Whether an element on a plane of the grid belongs to the voxel above.
    marks
        ``(nz, ny, nx)`` labels of the voxels; modified in place.
    """
    ny, nx = marks.shape[1], marks.shape[2]
    whole = np.empty((3, 3))
    band = np.empty((12, 3))
    piece = np.empty((12, 3))
    spare = np.empty((12, 3))
    for e in range(elements.shape[0]):
        for i in range(3):
            for c in range(3):
                whole[i, c] = points[elements[e, i], c]
        y_low = min(whole[0, 1], whole[1, 1], whole[2, 1])
        y_high = max(whole[0, 1], whole[1, 1], whole[2, 1])
        for iy in range(
            max(int(np.floor((y_low - grow) / pitch)), 0),
            min(int(np.floor((y_high + grow) / pitch)), ny - 1) + 1,
        ):
            bottom, top = iy * pitch - grow, (iy + 1) * pitch + grow
            if y_low >= bottom and y_high <= top:
                count = 3
                for i in range(3):
                    for c in range(3):
                        band[i, c] = whole[i, c]
            else:
                count = clip_to_half_space(whole, len(whole), 1, bottom, 1.0, spare)
                count = clip_to_half_space(spare, count, 1, top, -1.0, band)
            if count == 0:
                continue
            x_low, x_high = band[0, 0], band[0, 0]
            for i in range(1, count):
                x_low = min(x_low, band[i, 0])
                x_high = max(x_high, band[i, 0])
            for ix in range(
                max(int(np.floor((x_low - grow) / pitch)), 0),
                min(int(np.floor((x_high + grow) / pitch)), nx - 1) + 1,
            ):
                left, right = ix * pitch - grow, (ix + 1) * pitch + grow
                if x_low >= left and x_high <= right:
                    _mark_column(band, count, labels[e], step, tolerance, holds, iy, ix, marks)
                    continue
                corners = clip_to_half_space(band, count, 0, left, 1.0, spare)
                corners = clip_to_half_space(spare, corners, 0, right, -1.0, piece)
                if corners > 0:
                    _mark_column(piece, corners, labels[e], step, tolerance, holds, iy, ix, marks)


@njit(cache=True)
def count_crossings(points: Floats, triangles: Int64s, pitch: float, step: float, change: Int16s) -> None:
    """Count how the winding number changes along each vertical line of voxel centres.

    Parameters
    ----------
    points
        ``(n, 3)`` mm.
    triangles
        ``(m, 3)``.
    pitch, step
        Horizontal and vertical voxel size, mm.
    change
        ``(nz, ny, nx)``; the change between the centres k - 1 and k is added to ``change[k]``.
    """
    nz, ny, nx = change.shape
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = points[a, 0], points[a, 1], points[a, 2]
        slope_x, slope_y = slopes_of(points, a, b, c)
        low, high = min(az, points[b, 2], points[c, 2]), max(az, points[b, 2], points[c, 2])
        y_low, y_high = min(ay, points[b, 1], points[c, 1]), max(ay, points[b, 1], points[c, 1])
        for iy in range(
            max(int(np.ceil(y_low / pitch - 0.5)), 0), min(int(np.floor(y_high / pitch - 0.5)), ny - 1) + 1
        ):
            y = (iy + 0.5) * pitch
            up, down = ends_in_row(points, triangles, t, y)
            if np.isinf(up) or np.isinf(down):
                continue
            sign = (
                1 if up < down else -1
            )  # clockwise seen from above: a downward face, where the solid begins
            first = int(np.ceil(min(up, down) / pitch - 0.5))
            last = int(np.ceil(max(up, down) / pitch - 0.5)) - 1
            for ix in range(max(first, 0), min(last, nx - 1) + 1):
                z = az + slope_x * ((ix + 0.5) * pitch - ax) + slope_y * (y - ay)
                k = int(np.floor(min(max(z, low), high) / step - 0.5)) + 1
                if k < nz:
                    change[max(k, 0), iy, ix] += sign


@njit(cache=True)
def mark_interior(change: Int16s, marks: Int32s) -> None:
    """Set `marks` to 0 where the winding number of the voxel centre is positive; `change` is summed up in place."""
    nz, ny, nx = change.shape
    for iy in range(ny):
        for k in range(nz):
            for ix in range(nx):
                if k > 0:
                    change[k, iy, ix] += change[k - 1, iy, ix]
                if change[k, iy, ix] > 0:
                    marks[k, iy, ix] = 0
