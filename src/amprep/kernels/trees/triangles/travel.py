"""Pairs of triangles: how far one may travel along a direction before it meets the other."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import inlined
from amprep.kernels.trees.records import TOUCH, Triangle

# Strategy. A solid that travels meets another first where a line along the direction leaves the first solid and enters
# the second: at a leading triangle of the first (normal along the direction) and a facing triangle of the second
# (normal against it). In coordinates (x, y) across and z along the direction, each triangle is a function z(x, y) on
# its shadow. The travel is the least difference of the two functions on the intersection of the shadows. The
# difference is affine, so the least is at a corner of the intersection: a corner of one shadow in the other, or a
# crossing of two edges. All of these follow from 18 numbers: on which side of each edge is each corner of the other
# shadow?
#
# Contact: shadows that overlap by at most `TOUCH` graze, and one solid slides past the other. The difference has one
# sign unless the triangles cross; the sign of the larger end decides which of the two is before the other, and rounding
# at a point of contact does not matter. A leading triangle beyond a facing one has passed it. If all of the difference
# is within `TOUCH`, normal to the triangles, they are flush and in contact. Solids in contact that move apart or slide
# are free: then no leading triangle is before a facing one.

EDGE_ON = 1e-10
"""Least cosine between a normal and the direction; triangles below it have no shadow."""


@inlined
def _write_sides(a: Triangle, b: Triangle, turn: float, first: int, sides: Floats) -> bool:
    """Write on which side of the edges of `a` the corners of `b` are, times the edge; return whether one separates.

    Parameters
    ----------
    turn
        1 if `a` is counter-clockwise, -1 if it is clockwise.
    first
        Where in `sides` to write: corner j at edge i goes to ``first + 3 i + j``.
    """
    double_area = turn * ((a[3] - a[0]) * (a[7] - a[1]) - (a[4] - a[1]) * (a[6] - a[0]))
    for i in range(3):
        x, y = a[3 * i], a[3 * i + 1]
        k = 3 * ((i + 1) % 3)
        ex, ey = turn * (a[k] - x), turn * (a[k + 1] - y)
        s0 = ex * (b[1] - y) - ey * (b[0] - x)
        s1 = ex * (b[4] - y) - ey * (b[3] - x)
        s2 = ex * (b[7] - y) - ey * (b[6] - x)
        most = max(s0, s1, s2)
        if most <= 0.0:
            return True
        extent = min(double_area, most - min(s0, s1, s2))
        if most <= min(TOUCH * (abs(ex) + abs(ey)), 0.25 * extent):
            return True
        sides[first + 3 * i], sides[first + 3 * i + 1], sides[first + 3 * i + 2] = s0, s1, s2
    return False


@inlined
def _height_inside(triangle: Triangle, sides: Floats, first: int, corner: int) -> float:
    """Return z of a triangle at a corner of the other shadow; not a number where the corner is outside."""
    s0, s1, s2 = sides[first + corner], sides[first + 3 + corner], sides[first + 6 + corner]
    if min(s0, s1, s2) < 0.0:
        return np.nan
    return (s0 * triangle[8] + s1 * triangle[2] + s2 * triangle[5]) / (s0 + s1 + s2)


@inlined
def _gap_at_crossing(
    a: Triangle, i: int, i_next: int, b: Triangle, k: int, k_next: int, along: float
) -> float:
    """Return the difference in z where an edge of `b` crosses an edge of `a`; not a number beyond the edge of `a`.

    Both heights are taken at the same point, at the fraction `along` of the edge of `b`. This matters where both
    shadows have an edge on one line: the signs of the sides and the fraction are then rounding alone, but every common
    point of both edges will do.
    """
    x = b[3 * k] + along * (b[3 * k_next] - b[3 * k]) - a[3 * i]
    y = b[3 * k + 1] + along * (b[3 * k_next + 1] - b[3 * k + 1]) - a[3 * i + 1]
    ex, ey = a[3 * i_next] - a[3 * i], a[3 * i_next + 1] - a[3 * i + 1]
    at = (x * ex + y * ey) / (ex * ex + ey * ey)
    if at < -1e-9 or at > 1.0 + 1e-9:
        return np.nan
    above = b[3 * k + 2] + along * (b[3 * k_next + 2] - b[3 * k + 2])
    return above - a[3 * i + 2] - at * (a[3 * i_next + 2] - a[3 * i + 2])


@inlined
def shadow_travel(a: Triangle, b: Triangle, slope: float, sides: Floats) -> float:
    """Return how far a leading triangle may travel along z before it meets a facing one; infinity if it does not.

    Parameters
    ----------
    a, b
        The leading triangle, counter-clockwise in (x, y), and the facing one, clockwise.
    slope
        The lesser cosine between their normals and the direction.
    sides
        ``(18,)``, work array.
    """
    if _write_sides(a, b, 1.0, 0, sides) or _write_sides(b, a, -1.0, 9, sides):
        return np.inf
    least, most = np.inf, -np.inf
    for i in range(3):
        gap = b[3 * i + 2] - _height_inside(a, sides, 0, i)
        if not np.isnan(gap):
            least, most = min(least, gap), max(most, gap)
        gap = _height_inside(b, sides, 9, i) - a[3 * i + 2]
        if not np.isnan(gap):
            least, most = min(least, gap), max(most, gap)
    for i in range(3):
        i_next = (i + 1) % 3
        for k in range(3):
            k_next = (k + 1) % 3
            r, r_next = sides[3 * i + k], sides[3 * i + k_next]
            s, s_next = sides[9 + 3 * k + i], sides[9 + 3 * k + i_next]
            if r * r_next < 0.0 and s * s_next < 0.0:
                gap = _gap_at_crossing(a, i, i_next, b, k, k_next, r / (r - r_next))
                if not np.isnan(gap):
                    least, most = min(least, gap), max(most, gap)
    if least + most < 0.0 and least * slope < -TOUCH:
        return np.inf
    return max(least, 0.0)
