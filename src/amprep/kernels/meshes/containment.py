"""Winding numbers of points: signed crossings of the surface below each point."""

from numba import njit

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.meshes.walls import PointGrid

# Strategy. A vertical line through a point crosses the triangles above whose projection the point is. Whether it is
# above a triangle is decided by crossing numbers: for each edge that spans the y of the point, on which side of the
# edge is its x? The crossing of an edge is computed from its end with the lower y, so the two triangles that share the
# edge agree to the last bit, and no line slips through between them. Triangles visit only the points in the squares
# under their box. The inner loop is written out, because as a function of its own it takes half as long again.


@njit(cache=True)
def add_crossings_below(grid: PointGrid, vertices: Floats, triangles: Int64s, winding: Int32s) -> None:
    """Add the signed crossings below each point to its winding number.

    Parameters
    ----------
    grid
        The points; their coordinates and those of the vertices are relative to the corner of the grid.
    vertices, triangles
        The mesh, ``(v, 3)`` mm and ``(m, 3)``.
    winding
        ``(n,)``, modified in place.
    """
    points, first, side = grid.points, grid.first, grid.side
    ny, nx = grid.shape
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
