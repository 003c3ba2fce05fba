"""Distance and directional distance of two convex pieces by the algorithm of Gilbert, Johnson and Keerthi (GJK).

Sources: Gilbert, Johnson, Keerthi 1988 (10.1109/56.2083); van den Bergen 2004, "Ray casting against general convex
objects with application to continuous collision detection".
"""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper

# Strategy. Pieces a and b intersect if and only if the set D = b - a of all differences contains the origin, and
# their distance is that of the origin to D. D is never built: its farthest point in a direction is the difference of
# the farthest points of b and a. A simplex of at most four points of D approaches the origin x. The vector v from the
# nearest point of the simplex to x gives an upper bound |v| of the distance, because the simplex is inside D. The
# plane normal to v through the farthest point of D gives a lower bound, because D is behind it. Both bounds are valid
# in every step, whatever rounding did before, so no answer "apart" is wrong; a search that stalls ends with the lower
# bound.
#
# For the directional distance, x moves along a ray: a shifted by x touches b when x reaches D. While the plane proves
# that the distance exceeds the margin, x may advance until the distance to the plane is the margin. If x moves away
# from the plane, a never meets b. The simplex is kept as x moves, so a step costs one search for farthest points.

STEPS = 64
"""Largest number of steps; in practice 5 to 20 are taken."""

CLOSE = 1e-12
"""Relative difference of the bounds at which a distance is known."""

TOUCHING = 1e-11
"""Distance (mm) below which pieces intersect, and advance (mm) below which a ray has arrived."""

TOLERANCE = 1e-9
"""Length (mm) by which pieces may be closer than the margin without colliding, or when they move apart."""


class PieceArrays(NamedTuple):
    """Convex pieces in flat arrays, with their boxes; mm in the coordinates of the set.

    Attributes
    ----------
    vertices
        ``(n, 3)`` vertices of all pieces, piece by piece.
    first
        ``(p + 1,)`` index of the first vertex of each piece, and n.
    centre, half
        ``(p + 1, 3)`` centres and half sizes of the boxes of the pieces; the last row is the box of the set.
    """

    vertices: Floats
    first: Int64s
    centre: Floats
    half: Floats


@helper
def _difference(a, i, b, j, pose, x, y, z):
    """Return the farthest point of piece j of b minus piece i of a in the direction (x, y, z)."""
    most, which = -np.inf, 0
    u = pose[0, 0] * x + pose[1, 0] * y + pose[2, 0] * z
    v = pose[0, 1] * x + pose[1, 1] * y + pose[2, 1] * z
    w = pose[0, 2] * x + pose[1, 2] * y + pose[2, 2] * z
    for k in range(b.first[j], b.first[j + 1]):
        reach = u * b.vertices[k, 0] + v * b.vertices[k, 1] + w * b.vertices[k, 2]
        if reach > most:
            most, which = reach, k
    least, other = np.inf, 0
    for k in range(a.first[i], a.first[i + 1]):
        reach = x * a.vertices[k, 0] + y * a.vertices[k, 1] + z * a.vertices[k, 2]
        if reach < least:
            least, other = reach, k
    p, q, r = b.vertices[which, 0], b.vertices[which, 1], b.vertices[which, 2]
    return (
        pose[0, 0] * p + pose[0, 1] * q + pose[0, 2] * r + pose[0, 3] - a.vertices[other, 0],
        pose[1, 0] * p + pose[1, 1] * q + pose[1, 2] * r + pose[1, 3] - a.vertices[other, 1],
        pose[2, 0] * p + pose[2, 1] * q + pose[2, 2] * r + pose[2, 3] - a.vertices[other, 2],
    )


@helper
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@helper
def _minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@helper
def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@helper
def _point(simplex, k, x, y, z):
    return (simplex[k, 0] - x, simplex[k, 1] - y, simplex[k, 2] - z)


@helper
def _weight_on_segment(a, b):
    """Return the weight of b in the point of the segment ab that is nearest to the origin."""
    ab = _minus(b, a)
    along, length = -_dot(a, ab), _dot(ab, ab)
    if along <= 0.0 or length == 0.0:
        return 0.0
    return min(1.0, along / length)


@helper
def _square(wa, a, wb, b, wc, c):
    x, y, z = (
        wa * a[0] + wb * b[0] + wc * c[0],
        wa * a[1] + wb * b[1] + wc * c[1],
        wa * a[2] + wb * b[2] + wc * c[2],
    )
    return x * x + y * y + z * z


@helper
def _weights_on_triangle(a, b, c):
    """Return the weights of the point of a triangle that is nearest to the origin, and its squared distance."""
    normal = _cross(_minus(b, a), _minus(c, a))
    wa, wb, wc = _dot(_cross(b, c), normal), _dot(_cross(c, a), normal), _dot(_cross(a, b), normal)
    total = wa + wb + wc
    if wa > 0.0 and wb > 0.0 and wc > 0.0 and total > 0.0:
        wa, wb, wc = wa / total, wb / total, wc / total
        return wa, wb, wc, _square(wa, a, wb, b, wc, c)
    t = _weight_on_segment(a, b)
    wa, wb, wc = 1.0 - t, t, 0.0
    least = _square(wa, a, wb, b, wc, c)
    t = _weight_on_segment(b, c)
    square = _square(0.0, a, 1.0 - t, b, t, c)
    if square < least:
        wa, wb, wc, least = 0.0, 1.0 - t, t, square
    t = _weight_on_segment(c, a)
    square = _square(t, a, 0.0, b, 1.0 - t, c)
    if square < least:
        wa, wb, wc, least = t, 0.0, 1.0 - t, square
    return wa, wb, wc, least


@helper
def _nearest_face(a, b, c, d):
    """Return the weights of the point of a tetrahedron that is nearest to the origin; all -1 if it is inside.

    The nearest point is on a face whose plane separates the origin from the fourth corner. In a flat tetrahedron
    every face may hold it.
    """
    volume = _dot(_minus(b, a), _cross(_minus(c, a), _minus(d, a)))
    size = max(
        _dot(_minus(b, a), _minus(b, a)), _dot(_minus(c, a), _minus(c, a)), _dot(_minus(d, a), _minus(d, a))
    )
    flat = abs(volume) <= 1e-14 * size * np.sqrt(size)
    least = np.inf
    wa, wb, wc, wd = -1.0, -1.0, -1.0, -1.0
    if flat or _dot(a, _cross(b, c)) * volume >= 0.0:
        p, q, r, square = _weights_on_triangle(a, b, c)
        if square < least:
            wa, wb, wc, wd, least = p, q, r, 0.0, square
    if flat or _dot(a, _cross(d, b)) * volume >= 0.0:
        p, q, r, square = _weights_on_triangle(a, d, b)
        if square < least:
            wa, wb, wc, wd, least = p, r, 0.0, q, square
    if flat or _dot(a, _cross(c, d)) * volume >= 0.0:
        p, q, r, square = _weights_on_triangle(a, c, d)
        if square < least:
            wa, wb, wc, wd, least = p, 0.0, q, r, square
    if flat or _dot(b, _cross(d, c)) * volume >= 0.0:
        p, q, r, square = _weights_on_triangle(b, d, c)
        if square < least:
            wa, wb, wc, wd, least = 0.0, p, r, q, square
    return wa, wb, wc, wd


@helper
def _reduce(simplex, count, x, y, z):
    """Keep of a simplex the corners around its point nearest to x; return their number and the vector to x."""
    wa, wb, wc, wd = 1.0, 0.0, 0.0, 0.0
    a = _point(simplex, 0, x, y, z)
    if count == 2:
        wb = _weight_on_segment(a, _point(simplex, 1, x, y, z))
        wa = 1.0 - wb
    elif count == 3:
        wa, wb, wc, _ = _weights_on_triangle(a, _point(simplex, 1, x, y, z), _point(simplex, 2, x, y, z))
    elif count == 4:
        b, c, d = _point(simplex, 1, x, y, z), _point(simplex, 2, x, y, z), _point(simplex, 3, x, y, z)
        wa, wb, wc, wd = _nearest_face(a, b, c, d)
        if wa < 0.0:
            return 4, 0.0, 0.0, 0.0
    kept = 0
    vx, vy, vz = 0.0, 0.0, 0.0
    for k in range(count):
        weight = wa if k == 0 else wb if k == 1 else wc if k == 2 else wd
        if weight > 0.0:
            p = _point(simplex, k, x, y, z)
            vx, vy, vz = vx - weight * p[0], vy - weight * p[1], vz - weight * p[2]
            simplex[kept, 0], simplex[kept, 1], simplex[kept, 2] = simplex[k, 0], simplex[k, 1], simplex[k, 2]
            kept += 1
    return kept, vx, vy, vz


@helper
def _is_corner(simplex, count, p):
    for k in range(count):  # noqa: SIM110 - numba compiles no generators
        if simplex[k, 0] == p[0] and simplex[k, 1] == p[1] and simplex[k, 2] == p[2]:
            return True
    return False


@helper
def _away(a, i, b, j, pose):
    """Return the vector from the centre of the box of piece j of b to that of piece i of a; not zero."""
    p, q, r = b.centre[j, 0], b.centre[j, 1], b.centre[j, 2]
    x = a.centre[i, 0] - (pose[0, 0] * p + pose[0, 1] * q + pose[0, 2] * r + pose[0, 3])
    y = a.centre[i, 1] - (pose[1, 0] * p + pose[1, 1] * q + pose[1, 2] * r + pose[1, 3])
    z = a.centre[i, 2] - (pose[2, 0] * p + pose[2, 1] * q + pose[2, 2] * r + pose[2, 3])
    if x * x + y * y + z * z == 0.0:
        return 1.0, 0.0, 0.0
    return x, y, z


@helper
def pair_distance(a, i, b, j, pose, least, most, simplex):
    """Return the distance of piece i of a and piece j of b, 0 if they intersect, and the vector from b to a.

    Parameters
    ----------
    a, i, b, j
        `PieceArrays` and the numbers of the pieces.
    pose
        ``(4, 4)`` or ``(3, 4)``, maps the coordinates of b to those of a; a rigid motion.
    least, most
        The search ends when the distance is known to be at most `least`, or at least `most`. Then the value returned is
        an upper bound, or a lower bound.
    simplex
        ``(4, 3)`` or more rows and columns, modified in place.
    """
    vx, vy, vz = _away(a, i, b, j, pose)
    length = np.sqrt(vx * vx + vy * vy + vz * vz)
    count, lower, upper = 0, 0.0, np.inf
    for _ in range(STEPS):
        p = _difference(a, i, b, j, pose, vx, vy, vz)
        lower = max(lower, -(vx * p[0] + vy * p[1] + vz * p[2]) / length)
        if lower >= most or upper * (1.0 - CLOSE) <= lower or _is_corner(simplex, count, p):
            return lower, vx, vy, vz
        simplex[count, 0], simplex[count, 1], simplex[count, 2] = p[0], p[1], p[2]
        count, vx, vy, vz = _reduce(simplex, count + 1, 0.0, 0.0, 0.0)
        length = np.sqrt(vx * vx + vy * vy + vz * vz)
        if count == 4 or length <= TOUCHING:
            return 0.0, 0.0, 0.0, 0.0
        if length <= least:
            return length, vx, vy, vz
        if length >= upper * (1.0 - 1e-15):
            return lower, vx, vy, vz
        upper = length
    return lower, vx, vy, vz


@helper
def pair_travel(a, i, b, j, pose, ray, margin, upto, simplex):
    """Return how far piece i of a may move along `ray` before its distance to piece j of b is the margin.

    The value never exceeds the exact one by more than rounding. It is 0 if the pieces are closer than the margin now,
    and at least `upto` if the way is that long or endless.

    Parameters
    ----------
    a, i, b, j, pose, simplex
        See `pair_distance`.
    ray
        ``(3,)`` unit vector in the coordinates of a.
    margin, upto
        mm.
    """
    vx, vy, vz = _away(a, i, b, j, pose)
    x, y, z, travel = 0.0, 0.0, 0.0, 0.0
    count, stalled = 0, 0
    for _ in range(STEPS):
        length = np.sqrt(vx * vx + vy * vy + vz * vz)
        p = _difference(a, i, b, j, pose, vx, vy, vz)
        gap = (vx * (x - p[0]) + vy * (y - p[1]) + vz * (z - p[2])) / length
        advance = 0.0
        approach = -(vx * ray[0] + vy * ray[1] + vz * ray[2]) / length
        if gap > margin - TOLERANCE and approach <= 0.0:
            return upto
        if gap > margin:
            advance = (gap - margin) / approach
            travel += advance
            if travel >= upto:
                return upto
            x, y, z = travel * ray[0], travel * ray[1], travel * ray[2]
        known = _is_corner(simplex, count, p)
        stalled = stalled + 1 if known and advance <= TOUCHING else 0
        if stalled > 1:
            return travel
        if not known:
            simplex[count, 0], simplex[count, 1], simplex[count, 2] = p[0], p[1], p[2]
            count += 1
        count, vx, vy, vz = _reduce(simplex, count, x, y, z)
        square = vx * vx + vy * vy + vz * vz
        if count == 4 or square <= TOUCHING * TOUCHING or square < margin * margin:
            return travel
    return travel
