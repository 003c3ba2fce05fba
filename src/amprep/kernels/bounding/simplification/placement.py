"""The best position of the vertex that replaces an edge."""

from typing import NamedTuple

from amprep.kernels.bounding.simplification.half_edges import (
    HalfEdgeSurface,
    following,
    point_of,
    preceding,
    start_of,
)
from amprep.kernels.bounding.simplification.nearest_point import nearest_point
from amprep.kernels.bounding.simplification.patches import EdgePatch, measure
from amprep.kernels.bounding.simplification.points import Point, along, cross, dot, minus, normal_of, part

REFUSED = 1e300
"""Cost of a contraction that is not possible."""

_SQUARES = 1e-3
"""Weight of the squared distance from the middle of the edge beside the squared distances to the planes."""


class ContractionRules(NamedTuple):
    """Rules of contractions.

    Attributes
    ----------
    by_volume
        Whether the cost is the volume that a contraction adds, instead of the squared distances to the planes.
    margin
        Distance (mm) that a new vertex keeps from the planes, so that rounding never cuts into the solid.
    stiffness
        Weight of the distance from the middle of the edge, relative to the volume.
    least_cosine
        Least cosine of the angle by which a triangle may turn.
    least_height
        Least height of a new triangle relative to its longest edge.
    """

    by_volume: bool
    margin: float
    stiffness: float
    least_cosine: float
    least_height: float


@part
def _least_volume(patch: EdgePatch, planes: int, stiff: float) -> tuple[bool, Point]:
    """Return the position that adds the least volume: the point of the half-spaces nearest to one far inside."""
    q = 0.0, 0.0, 0.0
    for i in range(planes):
        n = patch.normals[i, 0], patch.normals[i, 1], patch.normals[i, 2]
        q = along(q, n, -patch.weights[i] / stiff)
    return nearest_point(patch.normals, patch.offsets, planes, q)


@part
def _least_squares(patch: EdgePatch, planes: int) -> tuple[bool, Point]:
    """Return the position with the least squared distances to the planes.

    The matrix of the squares is factorised (Cholesky); in coordinates multiplied by the factor the cost is a
    distance. A small multiple of the identity makes it regular where the planes do not fix a point.
    """
    n, rows = patch.normals, patch.rows
    xx = yy = zz = _SQUARES * planes
    xy = xz = yz = bx = by = bz = 0.0
    for i in range(planes):
        side = patch.offsets[i] - patch.margins[i]
        xx, xy, xz = xx + n[i, 0] * n[i, 0], xy + n[i, 0] * n[i, 1], xz + n[i, 0] * n[i, 2]
        yy, yz, zz = yy + n[i, 1] * n[i, 1], yz + n[i, 1] * n[i, 2], zz + n[i, 2] * n[i, 2]
        bx, by, bz = bx + side * n[i, 0], by + side * n[i, 1], bz + side * n[i, 2]
    a = xx**0.5
    b, c = xy / a, xz / a
    d = (yy - b * b) ** 0.5
    e = (yz - b * c) / d
    f = (zz - c * c - e * e) ** 0.5
    for i in range(planes):
        x = n[i, 0] / a
        y = (n[i, 1] - b * x) / d
        z = (n[i, 2] - c * x - e * y) / f
        length = (x * x + y * y + z * z) ** 0.5
        rows[i, 0], rows[i, 1], rows[i, 2] = x / length, y / length, z / length
        patch.sides[i] = patch.offsets[i] / length
    x = bx / a
    y = (by - b * x) / d
    found, p = nearest_point(rows, patch.sides, planes, (x, y, (bz - c * x - e * y) / f))
    z = p[2] / f
    y = (p[1] - e * z) / d
    return found, ((p[0] - b * y - c * z) / a, y, z)


@part
def _cost(patch: EdgePatch, planes: int, by_volume: bool, p: Point) -> float:
    """Return the volume or the squared distances of a position, `REFUSED` if it keeps less than half a margin."""
    cost, n = 0.0, patch.normals
    for i in range(planes):
        distance = n[i, 0] * p[0] + n[i, 1] * p[1] + n[i, 2] * p[2] - patch.offsets[i] + patch.margins[i]
        if distance < 0.5 * patch.margins[i]:
            return REFUSED
        cost += patch.weights[i] * distance if by_volume else distance * distance
    return cost


@part
def _end_cost(surface: HalfEdgeSurface, patch: EdgePatch, count: int, by_volume: bool, vertex: int) -> float:
    """Return the cost of moving the edge to one of its ends, `REFUSED` if it is on the inner side of a plane."""
    cost, start, p = 0.0, surface.start, point_of(surface, vertex)
    for i in range(count):
        first = 3 * patch.triangles[i]
        if start[first] == vertex or start[first + 1] == vertex or start[first + 2] == vertex:
            continue
        a = start_of(surface, first)
        n = normal_of(a, start_of(surface, first + 1), start_of(surface, first + 2))
        six = dot(n, minus(p, a))
        if six < 0.0:
            return REFUSED
        if by_volume:
            cost += six / 6.0
        elif six > 0.0:
            cost += six * six / dot(n, n)
    return cost


@part
def _fits(surface: HalfEdgeSurface, patch: EdgePatch, ring: int, rules: ContractionRules, p: Point) -> bool:
    """Tell whether no triangle of the new fan is turned over or degenerate."""
    for i in range(ring):
        h = patch.ring[i]
        b, c = start_of(surface, h), start_of(surface, following(h))
        u, v, w = minus(b, p), minus(c, p), minus(c, b)
        n, old = cross(u, v), normal_of(start_of(surface, preceding(h)), b, c)
        square = dot(n, n)
        if square <= (rules.least_height * max(dot(u, u), dot(v, v), dot(w, w))) ** 2:
            return False
        if dot(n, old) < rules.least_cosine * (square * dot(old, old)) ** 0.5:
            return False
    return True


@part
def place_vertex(
    surface: HalfEdgeSurface, patch: EdgePatch, count: int, rules: ContractionRules, h: int
) -> float:
    """Find the position that replaces an edge, write it to ``patch.place`` and return its cost.

    The candidates are the solution of the quadratic program and both ends of the edge. An end keeps flat faces
    exactly flat, so it is preferred unless it costs more than the margin.
    """
    u, v = surface.start[h], surface.start[surface.opposite[h]]
    start, edge = point_of(surface, u), minus(point_of(surface, v), point_of(surface, u))
    middle = along(start, edge, 0.5)
    planes = measure(surface, patch, count, rules.margin, middle)
    area = 1e-300
    for i in range(planes):
        area += patch.weights[i]
    stiff = rules.stiffness * area / (6.0 * area) ** 0.5
    slack = rules.margin * area if rules.by_volume else planes * rules.margin * rules.margin
    best, away, place = REFUSED, 0.0, middle
    for k in range(2):
        vertex = u if k == 0 else v
        cost, p = _end_cost(surface, patch, count, rules.by_volume, vertex), point_of(surface, vertex)
        if cost < best and _fits(surface, patch, count - 2, rules, p):
            best, away, place = cost, 0.25 * dot(edge, edge), p
    if best > slack:
        found, p = _least_volume(patch, planes, stiff) if rules.by_volume else _least_squares(patch, planes)
        cost = _cost(patch, planes, rules.by_volume, p) if found else REFUSED
        if cost + slack < best and _fits(surface, patch, count - 2, rules, along(middle, p, 1.0)):
            best, away, place = cost, dot(p, p), along(middle, p, 1.0)
    if best >= REFUSED:
        return REFUSED
    patch.place[0], patch.place[1], patch.place[2] = place
    return best + (0.5 * stiff if rules.by_volume else _SQUARES * planes) * away
