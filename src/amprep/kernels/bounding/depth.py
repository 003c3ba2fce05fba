"""Depth of points below the surface of a convex polyhedron."""

import numpy as np
from numba import njit

from amprep.arrays import Floats


@njit(cache=True)
def greatest_depth(points: Floats, planes: Floats) -> float:
    """Return the greatest distance of a point to the nearest plane of a convex polyhedron, at least 0, mm.

    A point is given up at the first plane that is nearer than the greatest depth so far, usually after a few planes.

    Parameters
    ----------
    points
        ``(n, 3)`` mm, in the polyhedron.
    planes
        ``(k, 4)``, outward unit normals and offsets.
    """
    deepest = 0.0
    for i in range(points.shape[0]):
        depth = np.inf
        for k in range(planes.shape[0]):
            below = planes[k, 3] - (
                planes[k, 0] * points[i, 0] + planes[k, 1] * points[i, 1] + planes[k, 2] * points[i, 2]
            )
            depth = min(depth, below)
            if depth <= deepest:
                break
        deepest = max(deepest, depth)
    return deepest
