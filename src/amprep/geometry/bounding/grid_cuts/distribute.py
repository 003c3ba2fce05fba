"""Distribute a number of pieces over solids, so that the hulls of all pieces have little volume."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats, Int64s

# Strategy. The total volume of the hulls of a solid falls with the number of its pieces, but sometimes only after two
# or three more. So the lower convex hull of this function is taken: its segments become flatter and flatter, and the
# steepest segments of all solids, taken first, give the least volume for the number of pieces that they need.


def distribute_pieces(
    hulls: Sequence[Floats], copies: Sequence[int], total: int, least_gains: Sequence[float]
) -> Int64s:
    """Return the number of pieces of each solid, at least 1.

    Parameters
    ----------
    hulls
        For each solid the total volume of the hulls of 1, 2, ... pieces.
    copies
        How often each solid is needed.
    total
        Number of pieces of all solids together.
    least_gains
        For each solid the volume that another piece must save.
    """
    segments = []
    for k, (curve, weight, least) in enumerate(zip(hulls, copies, least_gains, strict=True)):
        corners = _lower_corners(curve)
        for a, b in zip(corners[:-1], corners[1:], strict=True):
            gain = float(curve[a] - curve[b]) / (b - a)
            if gain > least:
                segments.append((-gain * weight, k, a, b))
    counts = np.ones(len(hulls), np.int64)
    left = total - len(hulls)
    for _, k, a, b in sorted(segments):
        taken = min(b - a, left)
        if taken > 0:
            counts[k] += taken
            left -= taken
    return counts


def _lower_corners(curve: Floats) -> list[int]:
    """Return the indices of the corners of the lower convex hull of a function, up to its least value."""
    corners: list[int] = []
    for k in range(int(np.argmin(curve)) + 1):
        while len(corners) > 1 and _is_above(curve, corners[-2], corners[-1], k):
            corners.pop()
        corners.append(k)
    return corners


def _is_above(curve: Floats, a: int, b: int, c: int) -> bool:
    """Tell whether the value at b is not below the line from a to c."""
    return bool((curve[b] - curve[a]) * (c - a) >= (curve[c] - curve[a]) * (b - a))
