"""Tell from which points of overhang regions the nearest anchor is visible inside the region."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.helper import kernel, uncounted

# Strategy. The edges of a region are ordered by their least x. Those that may come within reach of a point begin where
# the running maximum of the greatest x passes the point less the reach, and end where the least x passes the point plus
# the reach. All of them are compared.


class RegionSegments(NamedTuple):
    """Some edges of overhang regions, one region after the other, ordered by their least x in each.

    Attributes
    ----------
    start, end
        ``(e, 3)`` mm.
    first
        ``(r + 1,)`` the edges of region r are those from ``first[r]`` up to ``first[r + 1]``.
    low, high
        ``(e,)`` mm, least x of each edge, and greatest x of it and of those before it in its region.
    """

    start: Floats
    end: Floats
    first: Int64s
    low: Floats
    high: Floats


@uncounted
def _first_within(segments: RegionSegments, region: int, x: float) -> int:
    """Return the first edge of a region of which it or one before it extends to `x`."""
    begin, end = segments.first[region], segments.first[region + 1]
    while begin < end:
        middle = (begin + end) // 2
        if segments.high[middle] < x:
            begin = middle + 1
        else:
            end = middle
    return begin


@kernel
def see_anchors(
    points: Floats,
    region: Int64s,
    climb: Floats,
    anchors: RegionSegments,
    borders: RegionSegments,
    limits: tuple[float, float, float],
    seen: Bools,
) -> None:
    """Tell from which points the nearest anchor is within reach and no border is between them in plan.

    Parameters
    ----------
    points, region
        ``(n, 3)`` mm, and the region of each.
    climb
        ``(n,)`` greatest height (mm) of an anchor above each point.
    anchors, borders
        Edges at which the part carries the region, and all edges at its border.
    limits
        Reach in plan, the slope of the overhang angle, and the error of heights: an anchor belongs to the same turn of
        the region if its height differs by no more than slope times distance, plus the error.
    seen
        ``(n,)``, filled.
    """
    reach, slope, slack = limits
    for p in range(len(points)):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        seen[p] = False
        nearest, foot_x, foot_y, foot_z = np.inf, 0.0, 0.0, 0.0
        for e in range(_first_within(anchors, region[p], x - reach), anchors.first[region[p] + 1]):
            if anchors.low[e] > x + reach:
                break
            ux, uy = anchors.end[e, 0] - anchors.start[e, 0], anchors.end[e, 1] - anchors.start[e, 1]
            along = (x - anchors.start[e, 0]) * ux + (y - anchors.start[e, 1]) * uy
            along = min(max(along / max(ux * ux + uy * uy, 1e-18), 0.0), 1.0)
            dx = anchors.start[e, 0] + along * ux - x
            dy = anchors.start[e, 1] + along * uy - y
            distance = np.sqrt(dx * dx + dy * dy)
            rise = anchors.start[e, 2] + along * (anchors.end[e, 2] - anchors.start[e, 2]) - z
            if (
                distance <= reach
                and distance < nearest
                and abs(rise) <= distance * slope + slack
                and rise <= climb[p]
            ):
                nearest, foot_x, foot_y, foot_z = distance, dx, dy, rise
        if nearest == np.inf:
            continue
        length = max(nearest, 1e-12)
        seen[p] = True
        for e in range(_first_within(borders, region[p], x - reach), borders.first[region[p] + 1]):
            if borders.low[e] > x + reach:
                break
            ax, ay = borders.start[e, 0] - x, borders.start[e, 1] - y
            bx, by = borders.end[e, 0] - x, borders.end[e, 1] - y
            side_a, side_b = foot_x * ay - foot_y * ax, foot_x * by - foot_y * bx
            if (side_a > 0.0) == (side_b > 0.0):
                continue
            fraction = side_a / (side_a - side_b)
            at = ((ax + fraction * (bx - ax)) * foot_x + (ay + fraction * (by - ay)) * foot_y) / length
            height = borders.start[e, 2] + fraction * (borders.end[e, 2] - borders.start[e, 2]) - z
            if 0.0 < at < length - 0.01 and abs(height - foot_z * at / length) <= slack + at:
                seen[p] = False
                break
