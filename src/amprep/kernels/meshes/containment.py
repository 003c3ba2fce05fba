"""Winding numbers of points: how often the surface is crossed on the way down from each."""

from numba import njit

from amprep.arrays import Floats, Int32s, Int64s


@njit(cache=True)
def count_below(
    points: Floats,
    first: Int64s,
    vertices: Floats,
    triangles: Int64s,
    side: float,
    nx: int,
    ny: int,
    winding: Int32s,
) -> None:
    """Add to `winding` (int32, modified in place) the signed crossings below each point.

    `points` are sorted by the square of a horizontal grid that holds them (`side` mm, ``nx * ny`` squares);
    those of square s are ``first[s] : first[s + 1]``. On which side of an edge a point lies is computed from
    the edge's lower end on, so that triangles which share it agree to the last bit.
    """
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = vertices[a, 0], vertices[a, 1], vertices[a, 2]
        ux, uy, uz = vertices[b, 0] - ax, vertices[b, 1] - ay, vertices[b, 2] - az
        vx, vy, vz = vertices[c, 0] - ax, vertices[c, 1] - ay, vertices[c, 2] - az
        normal = ux * vy - uy * vx
        if normal == 0.0:
            continue
        slope_x, slope_y = (uz * vy - uy * vz) / normal, (ux * vz - uz * vx) / normal
        low, high = min(az, vertices[b, 2], vertices[c, 2]), max(az, vertices[b, 2], vertices[c, 2])
        x_low, x_high = min(ax, vertices[b, 0], vertices[c, 0]), max(ax, vertices[b, 0], vertices[c, 0])
        y_low, y_high = min(ay, vertices[b, 1], vertices[c, 1]), max(ay, vertices[b, 1], vertices[c, 1])
        columns = range(max(int(x_low // side), 0), min(int(x_high // side), nx - 1) + 1)
        for iy in range(max(int(y_low // side), 0), min(int(y_high // side), ny - 1) + 1):
            for ix in columns:
                for i in range(first[iy * nx + ix], first[iy * nx + ix + 1]):
                    x, y, z = points[i, 0], points[i, 1], points[i, 2]
                    turns = 0
                    for j in range(3):
                        p, q = triangles[t, j], triangles[t, (j + 1) % 3]
                        rising = vertices[p, 1] <= y < vertices[q, 1]
                        if not rising and not vertices[q, 1] <= y < vertices[p, 1]:
                            continue
                        if not rising:
                            p, q = q, p
                        crossing = vertices[p, 0] + (y - vertices[p, 1]) * (
                            vertices[q, 0] - vertices[p, 0]
                        ) / (vertices[q, 1] - vertices[p, 1])
                        if x < crossing:
                            turns += 1 if rising else -1
                    if turns != 0:
                        height = az + slope_x * (x - ax) + slope_y * (y - ay)
                        if min(max(height, low), high) < z:
                            winding[i] -= turns
