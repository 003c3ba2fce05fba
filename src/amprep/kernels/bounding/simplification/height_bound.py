"""Heights of the new triangles of a contraction above the old ones, in one direction.

If the normals of all old and new triangles have a positive component along one direction, both surfaces have the same
projection in this direction, so the line through a point of the new fan meets an old triangle. The height of a new
triangle above an old one is linear, so it is greatest at a corner of the polygon in which their projections overlap.
"""

from amprep.arrays import Floats
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface, following, start_of
from amprep.kernels.bounding.simplification.patches import EdgePatch
from amprep.kernels.bounding.simplification.points import (
    Point,
    along,
    cross,
    dot,
    inlined,
    minus,
    normal_of,
    part,
)

UNKNOWN = 1e300
"""No bound, or no limit."""


@part
def direction_of(surface: HalfEdgeSurface, patch: EdgePatch, count: int) -> tuple[bool, Point]:
    """Return the mean normal of a patch, and whether all old and new normals have a positive component along it."""
    up, w = (0.0, 0.0, 0.0), (patch.place[0], patch.place[1], patch.place[2])
    for i in range(count):
        first = 3 * patch.triangles[i]
        n = normal_of(start_of(surface, first), start_of(surface, first + 1), start_of(surface, first + 2))
        up = along(up, n, 1.0)
    size = dot(up, up) ** 0.5
    if size == 0.0:
        return False, up
    up = up[0] / size, up[1] / size, up[2] / size
    for i in range(count):
        first = 3 * patch.triangles[i]
        n = normal_of(start_of(surface, first), start_of(surface, first + 1), start_of(surface, first + 2))
        if dot(n, up) <= 0.0:
            return False, up
        if i < count - 2:
            h = patch.ring[i]
            if dot(normal_of(w, start_of(surface, h), start_of(surface, following(h))), up) <= 0.0:
                return False, up
    return True, up


@inlined
def _local(p: Point, origin: Point, one: Point, two: Point, up: Point) -> Point:
    away = minus(p, origin)
    return dot(away, one), dot(away, two), dot(away, up)


@part
def _clip(polygon: Floats, source: int, count: int, p: Point, q: Point) -> int:
    """Write the part of a polygon on the left of the line from p to q to the other half of the array."""
    target, kept = 1 - source, 0
    for i in range(count):
        j = (i + 1) % count
        one = (q[0] - p[0]) * (polygon[source, i, 1] - p[1]) - (q[1] - p[1]) * (polygon[source, i, 0] - p[0])
        two = (q[0] - p[0]) * (polygon[source, j, 1] - p[1]) - (q[1] - p[1]) * (polygon[source, j, 0] - p[0])
        if one >= 0.0:
            for axis in range(3):
                polygon[target, kept, axis] = polygon[source, i, axis]
            kept += 1
        if (one > 0.0 and two < 0.0) or (one < 0.0 and two > 0.0):
            for axis in range(3):
                here, there = polygon[source, i, axis], polygon[source, j, axis]
                polygon[target, kept, axis] = here + one / (one - two) * (there - here)
            kept += 1
    return kept


@part
def _height(polygon: Floats, a: Point, b: Point, c: Point) -> float:
    """Return the greatest height of a triangle above or below the triangle a, b, c; -1 if they do not overlap.

    The triangle is in the first half of the array; the third coordinate points up.
    """
    count = _clip(polygon, 0, 3, a, b)
    count = _clip(polygon, 1, count, b, c)
    count = _clip(polygon, 0, count, c, a)
    n, greatest = cross(minus(b, a), minus(c, a)), -1.0
    for i in range(count):
        p = polygon[1, i, 0], polygon[1, i, 1], polygon[1, i, 2]
        greatest = max(greatest, abs(dot(n, minus(p, a))) / n[2])
    return greatest


@part
def height_bound(
    surface: HalfEdgeSurface, patch: EdgePatch, count: int, i: int, up: Point, bound: Floats, polygon: Floats
) -> float:
    """Return a bound on the distance of new triangle i: over the old ones below it, their bound and its height.

    If rounding finds no old triangle below it, the value is `UNKNOWN`.

    Parameters
    ----------
    up
        Direction along which all normals have a positive component.
    bound
        ``(m,)`` bound of each old triangle.
    polygon
        ``(2, 8, 3)`` work array.
    """
    across = (1.0, 0.0, 0.0) if abs(up[0]) < 0.6 else (0.0, 1.0, 0.0)
    one = cross(up, across)
    length = dot(one, one) ** 0.5
    one = one[0] / length, one[1] / length, one[2] / length
    two, w, h = cross(up, one), (patch.place[0], patch.place[1], patch.place[2]), patch.ring[i]
    b = _local(start_of(surface, h), w, one, two, up)
    c = _local(start_of(surface, following(h)), w, one, two, up)
    greatest = -1.0
    for j in range(count):
        for axis in range(3):
            polygon[0, 0, axis], polygon[0, 1, axis], polygon[0, 2, axis] = 0.0, b[axis], c[axis]
        first = 3 * patch.triangles[j]
        p = _local(start_of(surface, first), w, one, two, up)
        q = _local(start_of(surface, first + 1), w, one, two, up)
        r = _local(start_of(surface, first + 2), w, one, two, up)
        height = _height(polygon, p, q, r)
        if height >= 0.0:
            greatest = max(greatest, bound[patch.triangles[j]] + height)
    return greatest if greatest >= 0.0 else UNKNOWN
