"""How far points are from walls sideways: in the horizontal plane through each point."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s


@njit(cache=True)
def nearest_walls(
    points: Floats,
    first: Int64s,
    side: float,
    shape: tuple[int, int],
    corners: Floats,
    outward: Floats,
    reach: float,
    slack: float,
    away: Floats,
    foot: Floats,
) -> None:
    """Find for each point the nearest wall within `reach` on whose outer side it lies, in its horizontal plane.

    Points less than `slack` out of a wall's plane are on neither side, within `slack` of its ends above or below it.

    Points ``(n, 3)`` are sorted by square ``y * nx + x`` of a grid of `side` mm from 0; `first` says where those
    of each square begin. `away` ``(n,)`` comes in as infinity and holds the distance afterwards, `foot` ``(n, 2)``
    the nearest place on the wall. Walls are triangles ``(m, 3, 3)`` with an outward direction ``(m, 2)`` each.
    """
    ny, nx = shape
    for t in range(corners.shape[0]):
        x_low, x_high = corners[t, :, 0].min() - reach, corners[t, :, 0].max() + reach
        y_low, y_high = corners[t, :, 1].min() - reach, corners[t, :, 1].max() + reach
        z_low, z_high = corners[t, :, 2].min() + slack, corners[t, :, 2].max() - slack
        for iy in range(max(int(np.floor(y_low / side)), 0), min(int(np.floor(y_high / side)), ny - 1) + 1):
            for ix in range(
                max(int(np.floor(x_low / side)), 0), min(int(np.floor(x_high / side)), nx - 1) + 1
            ):
                for p in range(first[iy * nx + ix], first[iy * nx + ix + 1]):
                    x, y, z = points[p]
                    if z < z_low or z > z_high or x < x_low or x > x_high or y < y_low or y > y_high:
                        continue
                    found, ax, ay, bx, by = 0, 0.0, 0.0, 0.0, 0.0
                    for i in range(3):
                        j = (i + 1) % 3
                        low, high = corners[t, i, 2], corners[t, j, 2]
                        if (low <= z < high) or (high <= z < low):
                            share = (z - low) / (high - low)
                            bx, by = ax, ay
                            ax = corners[t, i, 0] + share * (corners[t, j, 0] - corners[t, i, 0])
                            ay = corners[t, i, 1] + share * (corners[t, j, 1] - corners[t, i, 1])
                            found += 1
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
