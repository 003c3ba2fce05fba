"""Which points lie inside a closed mesh, by winding number along vertical lines."""

import numpy as np

from amprep.geometry.overhangs import Bools, Floats, Ints


def inside(points: Floats, vertices: Floats, triangles: Ints) -> Bools:
    """Tell which of `points` ``(n, 3)`` have a winding number above 0 with respect to the mesh.

    Points on the surface may count either way. Time grows with points and triangles that share a square of
    a horizontal grid, not with their product.
    """
    from amprep.kernels.inside import count_below

    winding = np.zeros(len(points), np.int32)
    if len(points) and len(triangles):
        near = np.flatnonzero(_within(points, vertices))
        low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
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
        count_below(
            np.ascontiguousarray(points[near][order] - corner),
            first,
            np.ascontiguousarray(vertices - corner),
            np.ascontiguousarray(triangles, np.int64),
            side,
            nx,
            ny,
            counts,
        )
        winding[near[order]] = counts
    return np.asarray(winding > 0)


def _within(points: Floats, vertices: Floats) -> Bools:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))
