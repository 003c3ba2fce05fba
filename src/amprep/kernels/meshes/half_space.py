"""Clip convex polygons to half-spaces that coordinate planes bound."""

from amprep.arrays import Floats
from amprep.kernels.helper import helper


@helper
def clip_to_half_space(
    source: Floats, count: int, axis: int, bound: float, sign: float, target: Floats
) -> int:
    """Clip the polygon ``source[:count]`` to ``sign * (p[axis] - bound) >= 0``; return the number of corners kept.

    The result is written to `target`, which has room for one corner more than the polygon.
    """
    kept = 0
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        a = sign * (source[i, axis] - bound)
        b = sign * (source[j, axis] - bound)
        if a >= 0.0:
            for c in range(3):
                target[kept, c] = source[i, c]
            kept += 1
        if (a > 0.0 and b < 0.0) or (a < 0.0 and b > 0.0):
            fraction = a / (a - b)
            for c in range(3):
                target[kept, c] = source[i, c] + fraction * (source[j, c] - source[i, c])
            target[kept, axis] = bound
            kept += 1
    return kept
