"""Whether the fan of a new vertex meets other triangles of the surface, or itself."""

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.bounding.simplification.box_tree import MovingBoxTree, find_boxes
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface, following, point_of, start_of
from amprep.kernels.bounding.simplification.patches import EdgePatch
from amprep.kernels.bounding.simplification.points import Point, dot, minus, normal_of, part

_TOUCH = 1e-10
"""Distance (mm) below which a point is in a plane."""

_FOLDED = -0.9999
"""Cosine of the angle between the normals of neighbours that are folded upon one another."""


@part
def _volume(a: Point, b: Point, c: Point, d: Point) -> float:
    """Return six times the volume of a tetrahedron, positive if d is on the outer side of a, b, c."""
    return dot(normal_of(a, b, c), minus(d, a))


@part
def _turn(px: float, py: float, qx: float, qy: float, rx: float, ry: float) -> float:
    """Return twice the signed area of a triangle in the plane."""
    return (qx - px) * (ry - py) - (qy - py) * (rx - px)


@part
def _meet_in_plane(p: Point, q: Point, a: Point, b: Point, c: Point, n: Point) -> bool:
    """Tell whether a segment and a triangle of one plane meet, in the projection along the normal's greatest axis."""
    x, y = 0, 1
    if abs(n[0]) >= abs(n[1]) and abs(n[0]) >= abs(n[2]):
        x, y = 1, 2
    elif abs(n[1]) >= abs(n[2]):
        x, y = 2, 0
    sign = 1.0 if _turn(a[x], a[y], b[x], b[y], c[x], c[y]) > 0.0 else -1.0
    inside = True
    for i in range(3):
        s, t = (a, b) if i == 0 else (b, c) if i == 1 else (c, a)
        one = sign * _turn(s[x], s[y], t[x], t[y], p[x], p[y])
        two = sign * _turn(s[x], s[y], t[x], t[y], q[x], q[y])
        if one <= 0.0 and two <= 0.0:
            return False
        inside &= one > 0.0
        if one * two < 0.0:
            three = _turn(p[x], p[y], q[x], q[y], s[x], s[y])
            four = _turn(p[x], p[y], q[x], q[y], t[x], t[y])
            if three * four < 0.0:
                return True
    return inside


@part
def _pierces(p: Point, q: Point, a: Point, b: Point, c: Point) -> bool:
    """Tell whether a segment meets a triangle; touching counts unless both are in one plane."""
    n = normal_of(a, b, c)
    near, one, two = _TOUCH * dot(n, n) ** 0.5, dot(n, minus(p, a)), dot(n, minus(q, a))
    if (one > near and two > near) or (one < -near and two < -near):
        return False
    if abs(one) <= near and abs(two) <= near:
        return _meet_in_plane(p, q, a, b, c, n)
    first = _volume(p, q, a, b)
    second = _volume(p, q, b, c)
    third = _volume(p, q, c, a)
    return (first >= 0.0 and second >= 0.0 and third >= 0.0) or (
        first <= 0.0 and second <= 0.0 and third <= 0.0
    )


@part
def _point(surface: HalfEdgeSurface, vertex: int) -> Point:
    return surface.points[vertex, 0], surface.points[vertex, 1], surface.points[vertex, 2]


@part
def _folded(w: Point, a: Point, b: Point, c: Point) -> bool:
    """Tell whether the triangles w, a, b and w, b, c are folded upon one another at their edge."""
    n, o = normal_of(w, a, b), normal_of(w, b, c)
    cosine = dot(n, o)
    return bool(cosine < 0.0 and cosine < _FOLDED * (dot(n, n) * dot(o, o)) ** 0.5)


@part
def _meets_itself(surface: HalfEdgeSurface, patch: EdgePatch, ring: int, w: Point) -> bool:
    """Tell whether triangles of the fan meet outside their common vertex or edge."""
    for i in range(ring):
        h, g = patch.ring[i], patch.ring[(i + 1) % ring]
        a, b = start_of(surface, h), start_of(surface, following(h))
        c = start_of(surface, following(g))
        if _folded(w, a, b, c):
            return True
        outer = surface.opposite[h]
        tip = start_of(surface, following(following(outer)))
        if _folded(a, tip, b, w):
            return True
        for j in range(i + 2, ring):
            if i == 0 and j == ring - 1:
                continue
            k = patch.ring[j]
            c, d = start_of(surface, k), start_of(surface, following(k))
            if _pierces(a, b, w, c, d) or _pierces(c, d, w, a, b):
                return True
    return False


@part
def _meets_triangle(w: Point, a: int, b: int, surface: HalfEdgeSurface, triangle: int) -> bool:
    """Tell whether the triangle w, a, b meets another one outside their common vertex; neighbours do not."""
    first = 3 * triangle
    shared, turned = 0, 0
    for k in range(3):
        corner = surface.start[first + k]
        if corner in (a, b):
            shared += 1
            turned = k
    if shared == 2:
        return False
    pa, pb = point_of(surface, a), point_of(surface, b)
    p = start_of(surface, first + turned)
    q = start_of(surface, first + (turned + 1) % 3)
    r = start_of(surface, first + (turned + 2) % 3)
    fan, other = (pa, pb, w), (p, q, r)
    opposite = 1 if surface.start[first + turned] == a else 2
    for k in range(3):  # edges that end in a common vertex are left out
        if (shared == 0 or k == opposite) and _pierces(fan[k], fan[(k + 1) % 3], p, q, r):
            return True
        if (shared == 0 or k == 1) and _pierces(other[k], other[(k + 1) % 3], w, pa, pb):
            return True
    return False


@part
def collides(
    surface: HalfEdgeSurface,
    patch: EdgePatch,
    tree: MovingBoxTree,
    found: Int32s,
    stamp: Int64s,
    box: Floats,
    count: int,
) -> bool:
    """Tell whether the fan of ``patch.place`` over the ring meets itself or a triangle outside the patch.

    Parameters
    ----------
    found, stamp, box
        Work arrays: ``(c,)``; ``(m,)`` number of the last patch that contained each triangle; ``(2, 3)``.
    count
        Number of triangles of the patch.
    """
    w = patch.place[0], patch.place[1], patch.place[2]
    ring = count - 2
    if _meets_itself(surface, patch, ring, w):
        return True
    for axis in range(3):
        box[0, axis] = box[1, axis] = w[axis]
        for i in range(ring):
            value = surface.points[surface.start[patch.ring[i]], axis]
            box[0, axis], box[1, axis] = min(box[0, axis], value), max(box[1, axis], value)
    for i in range(count):
        stamp[patch.triangles[i]] = patch.clock[0]
    number = find_boxes(tree, box[0], box[1], found)
    if number < 0:
        return True
    for k in range(number):
        triangle = found[k]
        if stamp[triangle] == patch.clock[0]:
            continue
        leaf = tree.leaf[triangle]
        for i in range(ring):
            a, b = surface.start[patch.ring[i]], surface.start[following(patch.ring[i])]
            apart = False
            for axis in range(3):
                one, two = surface.points[a, axis], surface.points[b, axis]
                apart |= max(one, two, w[axis]) < tree.lo[leaf, axis]
                apart |= min(one, two, w[axis]) > tree.hi[leaf, axis]
            if not apart and _meets_triangle(w, a, b, surface, triangle):
                return True
    return False
