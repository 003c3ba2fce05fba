"""Intersections of rows of vertical lines with triangles, for kernels that count crossings.

The crossing of an edge is computed from the edge alone, beginning at its lower end, so that triangles which share the
edge agree to the last bit and no line slips through between them.
"""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s


@njit(cache=True)
def slopes_of(points: Floats, a: int, b: int, c: int) -> tuple[float, float]:
    """Return the slopes of the plane of a triangle along x and y; 0 for a vertical triangle."""
    ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
    normal = ux * vy - uy * vx
    if normal == 0.0:
        return 0.0, 0.0
    return (uz * vy - uy * vz) / normal, (ux * vz - uz * vx) / normal


@njit(cache=True)
def ends_in_row(points: Floats, triangles: Int64s, t: int, y: float) -> tuple[float, float]:
    """Return the x at which the row of lines at `y` crosses the ascending and the descending edge, or infinity."""
    up = down = np.inf
    for i in range(3):
        p, q = triangles[t, i], triangles[t, (i + 1) % 3]
        if points[p, 1] <= y < points[q, 1]:
            fraction = (y - points[p, 1]) / (points[q, 1] - points[p, 1])
            up = points[p, 0] + fraction * (points[q, 0] - points[p, 0])
        elif points[q, 1] <= y < points[p, 1]:
            fraction = (y - points[q, 1]) / (points[p, 1] - points[q, 1])
            down = points[q, 0] + fraction * (points[p, 0] - points[q, 0])
    return up, down
