"""Leave out points of contours at which they are nearly straight."""

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel

_MOST = 64
"""Largest number of points that are left out in a row, which bounds the time."""


@kernel
def keep_bends(points: Floats, first: Int64s, tolerance: float, kept: Bools) -> None:
    """Tell which points of closed contours stay, so that what is left is within a tolerance of each contour.

    Strategy. From a point that stays, the chord is extended from point to point as long as all between are near it. So
    each contour is walked once, and the first point after which a chord can begin is the one farthest from its first.

    Parameters
    ----------
    points, first
        ``(n, 2)`` mm, points of all contours, those of contour c from ``first[c]`` up to ``first[c + 1]``.
    tolerance
        Largest distance (mm) of a point that is left out from the chord that replaces it.
    kept
        ``(n,)`` in: False for all points; out: which points stay.
    """
    for c in range(len(first) - 1):
        begin, count = first[c], first[c + 1] - first[c]
        farthest, start = -1.0, begin
        for i in range(begin, begin + count):
            dx, dy = points[i, 0] - points[begin, 0], points[i, 1] - points[begin, 1]
            if dx * dx + dy * dy > farthest:
                farthest, start = dx * dx + dy * dy, i
        kept[start] = True
        anchor = 0
        for step in range(2, count + 1):
            a, e = begin + (start - begin + anchor) % count, begin + (start - begin + step) % count
            dx, dy = points[e, 0] - points[a, 0], points[e, 1] - points[a, 1]
            length = dx * dx + dy * dy
            is_near = step - anchor <= _MOST
            for middle in range(anchor + 1, step):
                if not is_near:
                    break
                m = begin + (start - begin + middle) % count
                mx, my = points[m, 0] - points[a, 0], points[m, 1] - points[a, 1]
                along = min(max((mx * dx + my * dy) / length, 0.0), 1.0) if length > 0.0 else 0.0
                ox, oy = mx - along * dx, my - along * dy
                is_near = ox * ox + oy * oy <= tolerance * tolerance
            if not is_near:
                anchor = step - 1
                kept[begin + (start - begin + anchor) % count] = True
