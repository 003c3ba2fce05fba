"""Containment of points in closed meshes, by the winding number along vertical lines."""

import numpy as np

from amprep.arrays import Bools, Floats, Int32s


def inside(points: Floats, vertices: Floats, triangles: Int32s) -> Bools:
    """Tell which points have a positive winding number with respect to a closed mesh, ``(n,)``.

    Points on the surface may count either way. The time is proportional to the number of pairs of a point and a
    triangle that share a square of a grid in plan.

    Parameters
    ----------
    points
        ``(n, 3)`` mm.
    vertices, triangles
        The mesh, ``(v, 3)`` mm and ``(m, 3)``.
    """
    from amprep.kernels.meshes.containment import add_crossings_below
    from amprep.kernels.meshes.walls import PointGrid

    winding = np.zeros(len(points), np.int32)
    if len(points) and len(triangles):
        lo, hi = _bounds(vertices)
        near = np.flatnonzero(_within(points, lo, hi))
        low, high = lo[:2], hi[:2]
        side = max(
            float((high - low).max()) / 512, float(np.sqrt(np.prod(high - low) / (len(near) + 1))), 1e-6
        )
        nx, ny = (int(n) for n in (high - low) // side + 1)
        column = ((points[near, :2] - low) // side).astype(np.int64)
        square = column[:, 1] * nx + column[:, 0]
        order = np.argsort(square, kind="stable")
        first = np.searchsorted(square[order], np.arange(nx * ny + 1))
        counts = np.zeros(len(near), np.int32)
        corner = np.append(low, 0.0)
        grid = PointGrid(np.ascontiguousarray(points[near][order] - corner), first, side, (ny, nx))
        add_crossings_below(
            grid,
            np.ascontiguousarray(vertices - corner),
            np.ascontiguousarray(triangles, np.int64),
            counts,
        )
        winding[near[order]] = counts
    return np.asarray(winding > 0)


def _bounds(vertices: Floats) -> tuple[Floats, Floats]:
    columns = vertices.T
    return np.array([column.min() for column in columns]), np.array([column.max() for column in columns])


def _within(points: Floats, low: Floats, high: Floats) -> Bools:
    """Tell which points are in the box; one axis at a time, which is far faster than rows of three."""
    within = np.ones(len(points), np.bool_)
    for axis in range(3):
        within &= (points[:, axis] >= low[axis]) & (points[:, axis] <= high[axis])
    return within
