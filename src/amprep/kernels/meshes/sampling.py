"""Lattice points on triangles: intersections with the vertical lines through a square lattice."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s


@njit(cache=True)
def lattice_points(vertices: Floats, triangles: Int64s, spacing: float, points: Floats, owner: Int64s) -> int:
    """Write the lattice points on triangles, as many as fit into the arrays, and return their number.

    A call with empty arrays only counts them. A line through a shared edge meets exactly one of its two triangles.

    Parameters
    ----------
    vertices, triangles
        ``(v, 3)`` mm and ``(m, 3)``.
    spacing
        Pitch of the lattice, mm.
    points, owner
        ``(n, 3)`` and ``(n,)``, points and their triangles; written in place.
    """
    count = 0
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = vertices[a, 0], vertices[a, 1], vertices[a, 2]
        ux, uy, uz = vertices[b, 0] - ax, vertices[b, 1] - ay, vertices[b, 2] - az
        vx, vy, vz = vertices[c, 0] - ax, vertices[c, 1] - ay, vertices[c, 2] - az
        normal = ux * vy - uy * vx
        if normal == 0.0:
            continue
        slope_x, slope_y = (uz * vy - uy * vz) / normal, (ux * vz - uz * vx) / normal
        y_low, y_high = min(ay, vertices[b, 1], vertices[c, 1]), max(ay, vertices[b, 1], vertices[c, 1])
        for iy in range(int(np.ceil(y_low / spacing)), int(np.floor(y_high / spacing)) + 1):
            y = iy * spacing
            left, right = np.inf, -np.inf
            for i in range(3):
                p, q = triangles[t, i], triangles[t, (i + 1) % 3]
                if vertices[q, 1] < vertices[p, 1]:
                    p, q = q, p
                if vertices[p, 1] <= y < vertices[q, 1]:
                    x = vertices[p, 0] + (y - vertices[p, 1]) * (vertices[q, 0] - vertices[p, 0]) / (
                        vertices[q, 1] - vertices[p, 1]
                    )
                    left, right = min(left, x), max(right, x)
            if left >= right:
                continue
            for ix in range(int(np.ceil(left / spacing)), int(np.ceil(right / spacing))):
                if count < points.shape[0]:
                    points[count, 0] = ix * spacing
                    points[count, 1] = y
                    points[count, 2] = az + slope_x * (ix * spacing - ax) + slope_y * (y - ay)
                    owner[count] = t
                count += 1
    return count
