"""Horizontal distance of points to the walls of parts."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s

# Strategy. Points are sorted by the squares of a grid in plan, so each wall visits only the points near its box. The
# horizontal plane through a point intersects a triangle in a segment, and the distance in that plane is the distance
# of the point to the segment.


class PointGrid(NamedTuple):
    """Points sorted by the squares of a grid in plan that begins at 0.

    Attributes
    ----------
    points
        ``(n, 3)`` mm.
    first
        ``(ny * nx + 1,)``: the points of square ``s = y * nx + x`` are ``points[first[s] : first[s + 1]]``.
    side
        Side of a square, mm.
    shape
        Numbers of squares (ny, nx).
    """

    points: Floats
    first: Int64s
    side: float
    shape: tuple[int, int]


@njit(cache=True)
def _section(triangle: Floats, z: float) -> tuple[int, float, float, float, float]:
    """Return the number of edges that cross the height `z`, and the ends of the section: ax, ay, bx, by."""
    found, ax, ay, bx, by = 0, 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        j = (i + 1) % 3
        low, high = triangle[i, 2], triangle[j, 2]
        if (low <= z < high) or (high <= z < low):
            fraction = (z - low) / (high - low)
            bx, by = ax, ay
            ax = triangle[i, 0] + fraction * (triangle[j, 0] - triangle[i, 0])
            ay = triangle[i, 1] + fraction * (triangle[j, 1] - triangle[i, 1])
            found += 1
    return found, ax, ay, bx, by


@njit(cache=True)
def nearest_walls(
    grid: PointGrid, corners: Floats, outward: Floats, reach: float, slack: float, away: Floats, foot: Floats
) -> None:
    """Find for each point the nearest wall on whose outer side it is, in the horizontal plane of the point.

    Points within `slack` of the plane of a wall are on neither side of it; points above or below a wall, or within
    `slack` of its lowest or highest corner in height, do not see it.

    Parameters
    ----------
    grid
        The points.
    corners, outward
        ``(m, 3, 3)`` mm and ``(m, 2)`` unit vectors, triangles of the walls and their horizontal direction outwards.
    reach
        Largest distance that is searched, mm.
    slack
        Tolerance, mm.
    away, foot
        ``(n,)`` distance, infinity on entry, and ``(n, 2)`` nearest point on the wall; written in place.
    """
    ny, nx = grid.shape
    side = grid.side
    for t in range(corners.shape[0]):
        x_low, x_high = corners[t, :, 0].min() - reach, corners[t, :, 0].max() + reach
        y_low, y_high = corners[t, :, 1].min() - reach, corners[t, :, 1].max() + reach
        z_low, z_high = corners[t, :, 2].min() + slack, corners[t, :, 2].max() - slack
        for iy in range(max(int(np.floor(y_low / side)), 0), min(int(np.floor(y_high / side)), ny - 1) + 1):
            for ix in range(
                max(int(np.floor(x_low / side)), 0), min(int(np.floor(x_high / side)), nx - 1) + 1
            ):
                for p in range(grid.first[iy * nx + ix], grid.first[iy * nx + ix + 1]):
                    x, y, z = grid.points[p]
                    if z < z_low or z > z_high or x < x_low or x > x_high or y < y_low or y > y_high:
                        continue
                    found, ax, ay, bx, by = _section(corners[t], z)
                    if found < 2:
                        continue
                    ux, uy = bx - ax, by - ay
                    square = ux * ux + uy * uy
                    along = 0.0
                    if square > 0.0:
                        along = min(max(((x - ax) * ux + (y - ay) * uy) / square, 0.0), 1.0)
                    dx, dy = x - ax - along * ux, y - ay - along * uy
                    distance = np.sqrt(dx * dx + dy * dy)
                    if distance < min(away[p], reach) and dx * outward[t, 0] + dy * outward[t, 1] > slack:
                        away[p] = distance
                        foot[p, 0], foot[p, 1] = x - dx, y - dy
