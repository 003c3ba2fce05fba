"""Distances and intersections of triangles."""

import numpy as np
from numba import njit

from amprep.arrays import Floats

Point = tuple[float, float, float]
Triangle = tuple[Point, Point, Point]

# Strategy. Two triangles that do not intersect have their least distance between two edges, or between a corner of one
# and the inside of the other. If they intersect, an edge of one pierces the other. So nine pairs of edges and six
# corners are measured per pair of triangles. One set is sorted by x, and boxes that are farther apart than the least
# distance so far are skipped (sweep and prune). Points are tuples, which numba keeps in registers.


@njit(cache=True)
def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@njit(cache=True)
def _along(a: Point, direction: Point, t: float) -> Point:
    return (a[0] + t * direction[0], a[1] + t * direction[1], a[2] + t * direction[2])


@njit(cache=True)
def _cross(a: Point, b: Point) -> Point:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@njit(cache=True)
def _segment_distance(p: Point, q: Point, r: Point, s: Point) -> float:
    """Return the squared distance of the segments pq and rs (Ericson 2005, Real-Time Collision Detection, 5.1.9)."""
    u, v, w = _minus(q, p), _minus(s, r), _minus(p, r)
    a, b, c, d, e = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, w), _dot(v, w)
    det = a * c - b * b
    t = 0.0
    if det > 1e-18 * a * c:
        t = min(1.0, max(0.0, (b * e - c * d) / det))
    k = min(1.0, max(0.0, (b * t + e) / c)) if c > 0.0 else 0.0
    t = min(1.0, max(0.0, (b * k - d) / a)) if a > 0.0 else 0.0
    apart = _minus(_along(p, u, t), _along(r, v, k))
    return float(_dot(apart, apart))


@njit(cache=True)
def _inside(point: Point, triangle: Triangle, normal: Point) -> bool:
    """Return whether the projection of a point is inside a triangle."""
    for i in range(3):
        a, b = triangle[i], triangle[(i + 1) % 3]
        if _dot(_cross(_minus(b, a), _minus(point, a)), normal) < 0.0:
            return False
    return True


@njit(cache=True)
def _border_distance(point: Point, triangle: Triangle) -> float:
    """Return the distance of a point to the nearest edge of a triangle."""
    least = np.inf
    for i in range(3):
        least = min(least, _segment_distance(point, point, triangle[i], triangle[(i + 1) % 3]))
    return float(np.sqrt(least))


@njit(cache=True)
def _against_inside(one: Triangle, other: Triangle, gap: float) -> float:
    """Return the lesser of `gap` and the signed distance of the corners and edges of `one` to the inside of `other`."""
    normal = _cross(_minus(other[1], other[0]), _minus(other[2], other[0]))
    length = np.sqrt(_dot(normal, normal))
    if length == 0.0:
        return gap
    for i in range(3):
        a, b = one[i], one[(i + 1) % 3]
        height_a = _dot(_minus(a, other[0]), normal) / length
        height_b = _dot(_minus(b, other[0]), normal) / length
        if abs(height_a) < gap and _inside(a, other, normal):
            gap = min(gap, abs(height_a))
        if height_a * height_b < 0.0:
            point = _along(a, _minus(b, a), height_a / (height_a - height_b))
            if _inside(point, other, normal):
                gap = min(gap, -min(abs(height_a), abs(height_b), _border_distance(point, other)))
    return gap


@njit(cache=True)
def _corners(triangles: Floats, i: int) -> Triangle:
    return (
        (triangles[i, 0, 0], triangles[i, 0, 1], triangles[i, 0, 2]),
        (triangles[i, 1, 0], triangles[i, 1, 1], triangles[i, 1, 2]),
        (triangles[i, 2, 0], triangles[i, 2, 1], triangles[i, 2, 2]),
    )


@njit(cache=True)
def least_distance(triangles: Floats, others: Floats, widest: float, limit: float) -> float:
    """Return the least distance of two sets of triangles, at most a limit; if they intersect, minus the depth.

    Parameters
    ----------
    triangles, others
        ``(n, 3, 3)`` and ``(m, 3, 3)`` mm; `others` are sorted by their least x.
    widest
        Largest extent of one of the `others` in x, mm.
    limit
        Largest distance that is searched, mm.
    """
    least = limit
    starts = np.empty(others.shape[0])
    for j in range(others.shape[0]):
        starts[j] = min(others[j, 0, 0], others[j, 1, 0], others[j, 2, 0])
    for i in range(triangles.shape[0]):
        one = _corners(triangles, i)
        lo_x, hi_x = min(one[0][0], one[1][0], one[2][0]), max(one[0][0], one[1][0], one[2][0])
        reach = max(least, 0.0)
        j = np.searchsorted(starts, lo_x - widest - reach)
        while j < others.shape[0] and starts[j] <= hi_x + reach:
            two = _corners(others, j)
            j += 1
            apart = False
            for axis in range(1, 3):
                lo_1, hi_1 = (
                    min(one[0][axis], one[1][axis], one[2][axis]),
                    max(one[0][axis], one[1][axis], one[2][axis]),
                )
                lo_2, hi_2 = (
                    min(two[0][axis], two[1][axis], two[2][axis]),
                    max(two[0][axis], two[1][axis], two[2][axis]),
                )
                apart = apart or lo_1 > hi_2 + reach or lo_2 > hi_1 + reach
            if apart:
                continue
            for p in range(3):
                for q in range(3):
                    square = _segment_distance(one[p], one[(p + 1) % 3], two[q], two[(q + 1) % 3])
                    if least > 0.0 and square < least * least:
                        least = np.sqrt(square)
            least = _against_inside(two, one, _against_inside(one, two, least))
            reach = max(least, 0.0)
    return least
