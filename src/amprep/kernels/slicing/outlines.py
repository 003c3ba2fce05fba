"""Leave out the points of contours that are on straight lines, and find the borders around holes."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import kernel, uncounted

_LONGEST = 64
"""Largest number of points that one line replaces; the time for each point grows with it."""


@uncounted
def _is_near(points: Floats, i: int, a: int, b: int, tolerance: float) -> bool:
    """Tell whether point i is within a tolerance of the segment from point a to point b."""
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[i, 0] - points[a, 0], points[i, 1] - points[a, 1]
    square = ux * ux + uy * uy
    along = min(max((vx * ux + vy * uy) / square, 0.0), 1.0) if square > 0.0 else 0.0
    dx, dy = vx - along * ux, vy - along * uy
    return dx * dx + dy * dy <= tolerance * tolerance


@kernel
def straighten(points: Floats, first: Int64s, tolerance: float, kept: Floats, kept_first: Int64s) -> None:
    """Leave out points within a tolerance of the segment between those that stay, its ends included.

    Each contour begins at its leftmost point, slightly turned, which is a corner.

    Parameters
    ----------
    points, first
        ``(n, 2)`` and ``(c + 1,)``, points of contour c from ``first[c]`` up to ``first[c + 1]``.
    tolerance
        mm.
    kept, kept_first
        ``(n, 2)`` and ``(c + 1,)``, the same of what stays; filled. Contours that are lines keep two points.
    """
    size = 0
    for contour in range(len(first) - 1):
        kept_first[contour] = size
        begin, count = first[contour], first[contour + 1] - first[contour]
        head, least = begin, np.inf
        for i in range(begin, begin + count):
            leftmost = points[i, 0] + 0.37 * points[i, 1]
            if leftmost < least:
                head, least = i, leftmost
        last = 0
        for step in range(count):
            stays = step == 0 or step - last >= _LONGEST
            if not stays:
                a, b = begin + (head - begin + last) % count, begin + (head - begin + step + 1) % count
                for between in range(last + 1, step + 1):
                    i = begin + (head - begin + between) % count
                    if not _is_near(points, i, a, b, tolerance):
                        stays = True
                        break
            if stays:
                i = begin + (head - begin + step) % count
                kept[size, 0], kept[size, 1] = points[i, 0], points[i, 1]
                size += 1
                last = step
    kept_first[len(first) - 1] = size


@uncounted
def _is_inside(points: Floats, begin: int, end: int, x: float, y: float) -> bool:
    """Tell whether a point is inside the polygon of the points from `begin` up to `end`."""
    inside = False
    j = end - 1
    for i in range(begin, end):
        if (points[i, 1] > y) != (points[j, 1] > y):
            fraction = (y - points[j, 1]) / (points[i, 1] - points[j, 1])
            if x < points[j, 0] + fraction * (points[i, 0] - points[j, 0]):
                inside = not inside
        j = i
    return inside


@kernel
def find_borders(
    points: Floats, first: Int64s, plane: Int64s, area: Floats, boxes: Floats, border: Int64s
) -> None:
    """Find for each hole the smallest outer contour of its plane that contains the hole.

    Parameters
    ----------
    points, first
        See `straighten`.
    plane, area
        ``(c,)`` plane of each contour, ascending, and its area, negative for holes.
    boxes
        ``(c, 4)`` least and greatest x and y of each contour: x, y, x, y.
    border
        ``(c,)`` that contour; itself for outer contours, -1 where there is none. Filled.
    """
    begin = 0
    for contour in range(len(plane)):
        if plane[contour] != plane[begin]:
            begin = contour
        border[contour] = contour
        if area[contour] > 0.0:
            continue
        border[contour] = -1
        x, y = points[first[contour], 0], points[first[contour], 1]
        other = begin
        while other < len(plane) and plane[other] == plane[begin]:
            if (
                area[other] > 0.0
                and boxes[other, 0] <= boxes[contour, 0]
                and boxes[other, 1] <= boxes[contour, 1]
                and boxes[other, 2] >= boxes[contour, 2]
                and boxes[other, 3] >= boxes[contour, 3]
                and (border[contour] < 0 or area[other] < area[border[contour]])
                and _is_inside(points, first[other], first[other + 1], x, y)
            ):
                border[contour] = other
            other += 1
