"""Pairs of triangles: distance with the closest points, and travel until a margin is reached."""

import numpy as np

from amprep.kernels.helper import inlined
from amprep.kernels.trees.records import TOUCH, Triangle, Vector

# Strategy. The closest points of two disjoint triangles are on two edges, or one is a corner and the other is inside
# (Larsen, Gottschalk, Lin, Manocha 2000). For each of the nine pairs of edges the closest points are found. If the slab
# between them has the third corners of both triangles outside, it separates the triangles, and these are the closest
# points. Else the least of the nine pairs and the six corners is taken; it is 0 where an edge pierces a triangle.

ClosestPoints = tuple[float, float, float, float, float, float, float]
"""Squared distance, closest point of the first triangle, and the vector from it to that of the second."""


@inlined
def _corner(t: Triangle, i: int) -> Vector:
    return (t[3 * i], t[3 * i + 1], t[3 * i + 2])


@inlined
def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inlined
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def _closest_on_edges(p: Vector, u: Vector, q: Vector, v: Vector) -> ClosestPoints:
    """Return the gap of the segments from p along u and from q along v (Ericson 2005, 5.1.9)."""
    w = _minus(p, q)
    a, b, c, d, e = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, w), _dot(v, w)
    det = a * c - b * b
    s = 0.0
    if det > 1e-14 * a * c:
        s = min(1.0, max(0.0, (b * e - c * d) / det))
    t = (b * s + e) / c if c > 0.0 else 0.0
    if t < 0.0 or t > 1.0 or det <= 1e-14 * a * c:
        t = min(1.0, max(0.0, t))
        s = min(1.0, max(0.0, (b * t - d) / a)) if a > 0.0 else 0.0
    x, y, z = p[0] + s * u[0], p[1] + s * u[1], p[2] + s * u[2]
    gx, gy, gz = q[0] + t * v[0] - x, q[1] + t * v[1] - y, q[2] + t * v[2] - z
    return (gx * gx + gy * gy + gz * gz, x, y, z, gx, gy, gz)


@inlined
def _over(t: Triangle, normal: Vector, p: Vector) -> bool:
    """Return whether the projection of a point is inside a triangle."""
    for i in range(3):
        a = _corner(t, i)
        if _dot(_cross(_minus(_corner(t, (i + 1) % 3), a), _minus(p, a)), normal) < 0.0:
            return False
    return True


@inlined
def _closest_inside(a: Triangle, b: Triangle, forward: float, best: ClosestPoints) -> ClosestPoints:
    """Return the lesser of `best` and the gaps of the corners of `a` and the inside of `b`; 0 where `a` pierces `b`.

    With `forward` -1 the two triangles were exchanged, and gaps go from `b` to `a`.
    """
    origin = _corner(b, 0)
    normal = _cross(_minus(_corner(b, 1), origin), _minus(_corner(b, 2), origin))
    square = _dot(normal, normal)
    if square <= 0.0:
        return best
    heights = (
        _dot(_minus(_corner(a, 0), origin), normal),
        _dot(_minus(_corner(a, 1), origin), normal),
        _dot(_minus(_corner(a, 2), origin), normal),
    )
    if min(heights) > 0.0 or max(heights) < 0.0:
        for i in range(3):
            h = heights[i]
            if h * h < best[0] * square:
                p = _corner(a, i)
                if _over(b, normal, p):
                    k = -h / square
                    gx, gy, gz = k * normal[0], k * normal[1], k * normal[2]
                    gap = h * h / square
                    if forward > 0.0:
                        best = (gap, p[0], p[1], p[2], gx, gy, gz)
                    else:
                        best = (gap, p[0] + gx, p[1] + gy, p[2] + gz, -gx, -gy, -gz)
        return best
    for i in range(3):
        h, k = heights[i], heights[(i + 1) % 3]
        if (h >= 0.0) != (k >= 0.0) or h == 0.0:
            p, q = _corner(a, i), _corner(a, (i + 1) % 3)
            at = h / (h - k) if h != k else 0.0
            x = (p[0] + at * (q[0] - p[0]), p[1] + at * (q[1] - p[1]), p[2] + at * (q[2] - p[2]))
            if _over(b, normal, x):
                return (0.0, x[0], x[1], x[2], 0.0, 0.0, 0.0)
    return best


@inlined
def closest_points(a: Triangle, b: Triangle) -> ClosestPoints:
    """Return the squared distance of two triangles, the closest point of the first, and the vector to the second."""
    best = (np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(3):
        p = _corner(a, i)
        u = _minus(_corner(a, (i + 1) % 3), p)
        third_a = _corner(a, (i + 2) % 3)
        for j in range(3):
            q = _corner(b, j)
            gap = _closest_on_edges(p, u, q, _minus(_corner(b, (j + 1) % 3), q))
            if gap[0] < best[0]:
                best = gap
                g = (gap[4], gap[5], gap[6])
                x = (gap[1], gap[2], gap[3])
                beyond = _dot(_minus(_corner(b, (j + 2) % 3), x), g)
                if gap[0] > 0.0 and _dot(_minus(third_a, x), g) <= 0.0 and beyond >= gap[0]:
                    return best
    best = _closest_inside(a, b, 1.0, best)
    if best[0] > 0.0:
        best = _closest_inside(b, a, -1.0, best)
    return best


@inlined
def _shifted(t: Triangle, v: Vector, by: float) -> Triangle:
    x, y, z = by * v[0], by * v[1], by * v[2]
    return (t[0] + x, t[1] + y, t[2] + z, t[3] + x, t[4] + y, t[5] + z, t[6] + x, t[7] + y, t[8] + z)


@inlined
def margin_travel(a: Triangle, b: Triangle, direction: Vector, margin: float, limit: float) -> float:
    """Return how far a triangle may travel before it is within a margin of another; infinity if beyond the limit.

    The distance is a convex function of the travel, so Newton's method from the left never goes too far: the plane
    normal to the closest points separates the triangles until the step ends. It stops less than 1e-7 mm short of the
    margin. Triangles that only graze the margin, by at most `TOUCH`, are free.

    Parameters
    ----------
    a, b
        Triangles in one frame, mm; the first one moves.
    direction
        Unit vector.
    margin, limit
        mm; the margin is positive.
    """
    travel, reached, goal = 0.0, np.inf, margin
    for _ in range(200):
        gap = closest_points(_shifted(a, direction, travel), b)
        distance = np.sqrt(gap[0])
        if distance <= 0.0:
            return min(travel, reached)
        rate = (gap[4] * direction[0] + gap[5] * direction[1] + gap[6] * direction[2]) / distance
        if rate <= 1e-10:
            return np.inf
        step = (distance - goal) / rate
        if step < 1e-8 or distance - goal < 1e-10:
            if goal < margin or rate > 1e-2:
                return min(travel, reached)
            reached, goal = travel, margin - TOUCH
            step = (distance - goal) / rate
            if step <= 0.0:
                return reached
        travel += step
        if travel >= limit:
            return np.inf
    return min(travel, reached)
