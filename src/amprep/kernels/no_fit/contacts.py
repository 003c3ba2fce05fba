"""Contacts of a layout: for each pair of near convex pieces the plane that separates them most."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import EVERYWHERE, NoFitPieces, ShapeLayout


@njit(cache=True, nogil=True, _nrt=False)
def find_contacts(
    pieces: NoFitPieces, layout: ShapeLayout, items: int, reach: float, pairs: Int64s, planes: Floats
) -> tuple[int, float]:
    """Write a plane for each pair of near pieces; return their number and the least separation (mm).

    Items i and j are apart if ``normal @ (position i - position j) >= offset`` for every contact of the two. The
    arrays may be too short: then the number says how many rows are needed.

    Parameters
    ----------
    items
        Number of items; obstacles follow.
    reach
        Pieces that are farther apart than this (mm) are left out.
    pairs, planes
        ``(k, 2)`` items i and j, and ``(k, 4)`` normal and offset; written.
    """
    count, worst = 0, np.inf
    for i in range(items):
        for j in range(layout.shape.size):
            if (i <= j < items) or (layout.build[i] != layout.build[j] and layout.build[j] != EVERYWHERE):
                continue
            a, b, sign = layout.shape[i], layout.shape[j], 1.0
            if pieces.first[a, b] == pieces.end[a, b]:
                a, b, sign = b, a, -1.0
            x = sign * (layout.position[i, 0] - layout.position[j, 0])
            y = sign * (layout.position[i, 1] - layout.position[j, 1])
            z = sign * (layout.position[i, 2] - layout.position[j, 2])
            for k in range(pieces.first[a, b], pieces.end[a, b]):
                box = pieces.box[k]
                if (
                    x < box[0] - reach
                    or y < box[1] - reach
                    or z < box[2] - reach
                    or x > box[3] + reach
                    or y > box[4] + reach
                    or z > box[5] + reach
                ):
                    continue
                apart, best = -np.inf, 0
                for q in range(pieces.first_plane[k], pieces.first_plane[k + 1]):
                    plane = pieces.planes[q]
                    distance = plane[0] * x + plane[1] * y + plane[2] * z - plane[3]
                    if distance > apart:
                        apart, best = distance, q
                        if apart > reach:
                            break
                if apart > reach:
                    continue
                worst = min(worst, apart)
                if count < planes.shape[0]:
                    pairs[count, 0], pairs[count, 1] = i, j
                    for axis in range(3):
                        planes[count, axis] = sign * pieces.planes[best, axis]
                    planes[count, 3] = pieces.planes[best, 3]
                count += 1
    return count, worst
