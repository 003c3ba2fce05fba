"""Whether triangles are within a distance of the original surface, decided on the safe side.

Strategy: the distance to one triangle is a convex function, so a triangle is within the limit of the
surface if its corners are within the limit of one triangle of it. The distance to the whole surface
changes by at most the way that a point moves (Lipschitz), so it is also within the limit if its centre
is nearer by the radius. A triangle for which neither is so is halved at its longest edge; one with a
point beyond the limit is refused, and so is one that is still undecided when its pieces are small or
many. Before that, a cheap bound is tried that adds up over the contractions.
"""

from typing import NamedTuple

from amprep.arrays import Floats
from amprep.kernels.bounding.simplification.box_tree import MovingBoxTree
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface, following, start_of
from amprep.kernels.bounding.simplification.height_bound import UNKNOWN, direction_of, height_bound
from amprep.kernels.bounding.simplification.patches import EdgePatch
from amprep.kernels.bounding.simplification.points import Point, along, cross, dot, minus, part

_MOST_PIECES = 190
"""Greatest number of pieces of a triangle that are examined."""

_NEAR_LIMIT = 0.95
"""Distance relative to the limit beyond which a centre is refused, because halving its piece seldom decides."""


class OriginalSurface(NamedTuple):
    """The surface before the simplification.

    Attributes
    ----------
    surface, tree
        Its triangles and their boxes.
    limit
        Greatest distance from it, mm; infinity for none.
    bound
        ``(m,)`` bound on the distance of each triangle that is left, mm.
    pieces, polygon
        ``(k, 9)`` and ``(2, 8, 3)`` work arrays.
    """

    surface: HalfEdgeSurface
    tree: MovingBoxTree
    limit: float
    bound: Floats
    pieces: Floats
    polygon: Floats


@part
def _box_distance(tree: MovingBoxTree, node: int, p: Point) -> float:
    """Return the squared distance of a point to the box of a node."""
    total = 0.0
    for axis in range(3):
        gap = max(tree.lo[node, axis] - p[axis], p[axis] - tree.hi[node, axis], 0.0)
        total += gap * gap
    return total


@part
def _segment_distance(p: Point, a: Point, b: Point) -> float:
    """Return the squared distance of a point to a segment."""
    u, w = minus(b, a), minus(p, a)
    square = dot(u, u)
    t = min(max(dot(u, w) / square, 0.0), 1.0) if square > 0.0 else 0.0
    away = along(w, u, -t)
    return dot(away, away)


@part
def _triangle_distance(surface: HalfEdgeSurface, triangle: int, p: Point) -> float:
    """Return the squared distance of a point to a triangle."""
    first = 3 * triangle
    a, b, c = start_of(surface, first), start_of(surface, first + 1), start_of(surface, first + 2)
    u, v, w = minus(b, a), minus(c, a), minus(p, a)
    n = cross(u, v)
    square = dot(n, n)
    if square > 0.0:
        s, t = dot(n, cross(w, v)), dot(n, cross(u, w))
        if s >= 0.0 and t >= 0.0 and s + t <= square:
            return dot(n, w) ** 2 / square
    return min(_segment_distance(p, a, b), _segment_distance(p, b, c), _segment_distance(p, c, a))


@part
def _nearest(original: OriginalSurface, p: Point) -> tuple[int, float]:
    """Return the nearest triangle within the limit and its squared distance; -1 for none."""
    tree = original.tree
    best, least = -1, original.limit * original.limit
    top, leaves = 1, tree.triangle.size
    tree.stack[0] = 1
    while top > 0:
        top -= 1
        node = tree.stack[top]
        if _box_distance(tree, node, p) > least:
            continue
        if node >= leaves:
            triangle = int(tree.triangle[node - leaves])
            distance = _triangle_distance(original.surface, triangle, p)
            if distance <= least:
                best, least = triangle, distance
            continue
        near, far = 2 * node, 2 * node + 1
        if _box_distance(tree, far, p) < _box_distance(tree, near, p):
            near, far = far, near
        tree.stack[top], tree.stack[top + 1] = far, near
        top += 2
    return best, least


@part
def _farthest(original: OriginalSurface, a: Point, b: Point, c: Point) -> float:
    """Return a bound on the distance of a triangle within the limit, -1 if it is beyond, `UNKNOWN` if undecided."""
    m = (a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0
    middle, least = UNKNOWN, UNKNOWN
    for i in range(4):
        p = m if i == 0 else a if i == 1 else b if i == 2 else c
        triangle, distance = _nearest(original, p)
        if triangle < 0 or (i == 0 and distance > (_NEAR_LIMIT * original.limit) ** 2):
            return -1.0
        if i == 0:
            middle = distance**0.5
        farthest = max(
            _triangle_distance(original.surface, triangle, a),
            _triangle_distance(original.surface, triangle, b),
            _triangle_distance(original.surface, triangle, c),
        )
        least = min(least, farthest**0.5)
        if least <= original.limit:
            return least
    u, v, w = minus(a, m), minus(b, m), minus(c, m)
    radius = max(dot(u, u), dot(v, v), dot(w, w)) ** 0.5
    return middle + radius if middle + radius <= original.limit else UNKNOWN


@part
def _halve(pieces: Floats, top: int, a: Point, b: Point, c: Point) -> None:
    """Write the two halves of a triangle, cut at its longest edge, to places `top` and `top + 1`."""
    u, v, w = minus(b, a), minus(c, b), minus(a, c)
    one, two, three = dot(u, u), dot(v, v), dot(w, w)
    if two >= one and two >= three:
        a, b, c = b, c, a
    elif three >= one:
        a, b, c = c, a, b
    for axis in range(3):
        middle = 0.5 * (a[axis] + b[axis])
        pieces[top, axis], pieces[top, 3 + axis], pieces[top, 6 + axis] = a[axis], middle, c[axis]
        pieces[top + 1, axis], pieces[top + 1, 3 + axis], pieces[top + 1, 6 + axis] = middle, b[axis], c[axis]


@part
def _distance_bound(original: OriginalSurface, a: Point, b: Point, c: Point) -> float:
    """Return a bound on the distance of all points of a triangle, `UNKNOWN` if it may exceed the limit."""
    pieces, greatest = original.pieces, 0.0
    for axis in range(3):
        pieces[0, axis], pieces[0, 3 + axis], pieces[0, 6 + axis] = a[axis], b[axis], c[axis]
    top, seen = 1, 0
    while top > 0:
        top -= 1
        seen += 1
        p = pieces[top, 0], pieces[top, 1], pieces[top, 2]
        q = pieces[top, 3], pieces[top, 4], pieces[top, 5]
        r = pieces[top, 6], pieces[top, 7], pieces[top, 8]
        farthest = _farthest(original, p, q, r)
        if farthest < 0.0 or seen > _MOST_PIECES:
            return UNKNOWN
        if farthest < UNKNOWN:
            greatest = max(greatest, farthest)
        else:
            _halve(pieces, top, p, q, r)
            top += 2
    return greatest


@part
def _has_far_point(original: OriginalSurface, surface: HalfEdgeSurface, patch: EdgePatch, ring: int) -> bool:
    """Tell whether the new vertex or the middle of an edge to it is beyond the limit, which refuses most fans."""
    w = patch.place[0], patch.place[1], patch.place[2]
    if _nearest(original, w)[0] < 0:
        return True
    for i in range(ring):
        middle = along(w, minus(start_of(surface, patch.ring[i]), w), 0.5)
        if _nearest(original, middle)[0] < 0:
            return True
    return False


@part
def exceeds(original: OriginalSurface, surface: HalfEdgeSurface, patch: EdgePatch, count: int) -> bool:
    """Tell whether a point of the fan of ``patch.place`` may be farther from the original surface than the limit.

    The bounds of the triangles that will carry the fan are updated if it is not.
    """
    if original.limit >= UNKNOWN:
        return False
    w, bounds, looked = (patch.place[0], patch.place[1], patch.place[2]), patch.sides, False
    upright, up = direction_of(surface, patch, count)
    for i in range(count - 2):
        h = patch.ring[i]
        bounds[i] = UNKNOWN
        if upright:
            bounds[i] = height_bound(surface, patch, count, i, up, original.bound, original.polygon)
        if bounds[i] > original.limit:
            if not looked and _has_far_point(original, surface, patch, count - 2):
                return True
            looked = True
            bounds[i] = _distance_bound(original, w, start_of(surface, h), start_of(surface, following(h)))
            if bounds[i] > original.limit:
                return True
    for i in range(count - 2):
        original.bound[patch.triangles[i]] = bounds[i]
    return False
