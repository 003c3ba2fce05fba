"""Signed distances to polygons at the points of a grid."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int16s
from amprep.kernels.plates.records import PHASES, UNITS

LIMIT = 20000
"""Greatest sampled length, in units."""


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"nnan", "nsz"})
def sample_distances(sides: Floats, step: float, squares: Floats, signs: Floats, out: Int16s) -> None:
    """Write the signed distance to the nearest side of polygons at fine grid points, negative inside.

    Parameters
    ----------
    sides
        ``(k, 4)`` mm, start and end of each side; the inside is where a ray crosses an odd number of sides.
    step
        Step of the fields, mm.
    squares, signs
        ``(PHASES * ny,)`` work arrays.
    out
        ``(PHASES, PHASES, nx, ny)`` units, modified; the grid point (0, 0, nx // 2, ny // 2) is the origin.
    """
    nx, ny = out.shape[2], out.shape[3]
    fine = step / PHASES
    for i in range(nx * PHASES):
        x = (i - (nx // 2) * PHASES) * fine
        squares[:] = np.inf
        signs[:] = 1.0
        for k in range(sides.shape[0]):
            ax, ay, bx, by = sides[k, 0], sides[k, 1], sides[k, 2], sides[k, 3]
            dx, dy = bx - ax, by - ay
            scale = 1.0 / max(dx * dx + dy * dy, 1e-30)
            start = (x - ax) * dx
            crosses = (ax > x) != (bx > x)
            height = ay + (x - ax) / dx * dy if crosses else np.inf
            for j in range(squares.size):
                y = (j - (ny // 2) * PHASES) * fine
                t = min(max((start + (y - ay) * dy) * scale, 0.0), 1.0)
                u, v = x - ax - t * dx, y - ay - t * dy
                squares[j] = min(squares[j], u * u + v * v)
                signs[j] = -signs[j] if y > height else signs[j]
        for j in range(squares.size):
            value = signs[j] * np.sqrt(squares[j]) / step * UNITS
            value = min(max(value, -1.0 * LIMIT), 1.0 * LIMIT)
            out[i % PHASES, j % PHASES, i // PHASES, j // PHASES] = np.int16(np.floor(value + 0.5))
