"""Distance and penetration depth of two sets of triangles, by trees of axis-parallel boxes."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper

Point = tuple[float, float, float]
Triangle = tuple[Point, Point, Point]

# Strategy. Two triangles that do not intersect have their least distance between two edges, or between a corner of one
# and the inside of the other. If they intersect, an edge of one pierces the other. So nine pairs of edges and six
# corners are measured per pair of triangles. Boxes that are farther apart than the least distance so far are skipped,
# first those of nodes, then those of triangles. The tree is complete: the children of node i are 2 i + 1 and 2 i + 2,
# so it needs no links. Points are tuples, which numba keeps in registers.


class PlacedTree(NamedTuple):
    """Triangles in the coordinates of a build, with a complete binary tree of their axis-parallel boxes.

    Attributes
    ----------
    corners
        ``(n, 9)`` mm, in the order of the leaves.
    starts
        ``(m + 1,)``: leaf k, node ``m - 1 + k``, has the triangles from ``starts[k]`` to ``starts[k + 1] - 1``; m is a
        power of 2.
    boxes
        ``(2 m - 1, 6)`` mm, least and greatest corner of each node.
    sizes
        ``(2 m - 1,)`` mm, the sum of the sides of each box.
    """

    corners: Floats
    starts: Int64s
    boxes: Floats
    sizes: Floats


@helper
def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@helper
def _minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@helper
def _along(a: Point, direction: Point, t: float) -> Point:
    return (a[0] + t * direction[0], a[1] + t * direction[1], a[2] + t * direction[2])


@helper
def _cross(a: Point, b: Point) -> Point:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@helper
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


@helper
def _inside(point: Point, triangle: Triangle, normal: Point) -> bool:
    """Return whether the projection of a point is inside a triangle."""
    for i in range(3):
        a, b = triangle[i], triangle[(i + 1) % 3]
        if _dot(_cross(_minus(b, a), _minus(point, a)), normal) < 0.0:
            return False
    return True


@helper
def _border_distance(point: Point, triangle: Triangle) -> float:
    """Return the distance of a point to the nearest edge of a triangle."""
    least = np.inf
    for i in range(3):
        least = min(least, _segment_distance(point, point, triangle[i], triangle[(i + 1) % 3]))
    return float(np.sqrt(least))


@helper
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


@helper
def _corners(corners: Floats, i: int) -> Triangle:
    return (
        (corners[i, 0], corners[i, 1], corners[i, 2]),
        (corners[i, 3], corners[i, 4], corners[i, 5]),
        (corners[i, 6], corners[i, 7], corners[i, 8]),
    )


@helper
def _boxes_apart(one: Triangle, other: Triangle, reach: float) -> bool:
    """Return whether the boxes of two triangles are farther apart than `reach` along an axis."""
    for axis in range(3):
        low_1, high_1 = (
            min(one[0][axis], one[1][axis], one[2][axis]),
            max(one[0][axis], one[1][axis], one[2][axis]),
        )
        low_2, high_2 = (
            min(other[0][axis], other[1][axis], other[2][axis]),
            max(other[0][axis], other[1][axis], other[2][axis]),
        )
        if low_1 > high_2 + reach or low_2 > high_1 + reach:
            return True
    return False


@helper
def _of_triangles(one: Triangle, other: Triangle, least: float) -> float:
    """Return the lesser of `least` and the distance of two triangles; if they intersect, minus the depth."""
    for p in range(3):
        for q in range(3):
            square = _segment_distance(one[p], one[(p + 1) % 3], other[q], other[(q + 1) % 3])
            if least > 0.0 and square < least * least:
                least = np.sqrt(square)
    return _against_inside(other, one, _against_inside(one, other, least))


@helper
def _of_boxes(a: Floats, i: int, b: Floats, j: int) -> float:
    """Return the squared distance of two boxes."""
    square = 0.0
    for axis in range(3):
        gap = max(a[i, axis] - b[j, 3 + axis], b[j, axis] - a[i, 3 + axis], 0.0)
        square += gap * gap
    return square


@helper
def _nearer(square: float, least: float) -> bool:
    """Return whether what boxes of a squared distance contain can be nearer than `least`, or deeper in each other."""
    return square < least * least if least > 0.0 else square <= 0.0


@helper
def _of_leaves(a: PlacedTree, i: int, b: PlacedTree, j: int, least: float) -> float:
    """Return the lesser of `least` and the signed distance of the triangles of two leaves."""
    for s in range(a.starts[i], a.starts[i + 1]):
        one = _corners(a.corners, s)
        for t in range(b.starts[j], b.starts[j + 1]):
            other = _corners(b.corners, t)
            if not _boxes_apart(one, other, max(least, 0.0)):
                least = _of_triangles(one, other, least)
    return least


@njit(cache=True)
def least_distance(a: PlacedTree, b: PlacedTree, limit: float, enough: float, waiting: Int64s) -> float:
    """Return the least distance of two sets of triangles, at most a limit; if they intersect, minus the depth.

    Pairs of nodes are visited depth first, the nearer one first, and dropped if their boxes are farther apart than the
    least distance so far; then those that intersect are measured until the greatest depth is known.

    Parameters
    ----------
    a, b
        The sets.
    limit
        Largest distance that is searched, mm, at least 0.
    enough
        A distance (mm) at which the search ends: the result is exact only if it is greater.
    waiting
        ``(k, 2)``, work array: pairs of nodes that are still to be visited.
    """
    least = limit
    leaves_a, leaves_b = a.starts.shape[0] - 1, b.starts.shape[0] - 1
    waiting[0, 0], waiting[0, 1] = 0, 0
    count = 1
    while count > 0 and least > enough:
        count -= 1
        i, j = waiting[count, 0], waiting[count, 1]
        if not _nearer(_of_boxes(a.boxes, i, b.boxes, j), least):
            continue
        leaf_a, leaf_b = i >= leaves_a - 1, j >= leaves_b - 1
        if leaf_a and leaf_b:
            least = _of_leaves(a, i - leaves_a + 1, b, j - leaves_b + 1, least)
            continue
        if leaf_b or (not leaf_a and a.sizes[i] >= b.sizes[j]):
            near_i, near_j, far_i, far_j = 2 * i + 1, j, 2 * i + 2, j
        else:
            near_i, near_j, far_i, far_j = i, 2 * j + 1, i, 2 * j + 2
        near = _of_boxes(a.boxes, near_i, b.boxes, near_j)
        far = _of_boxes(a.boxes, far_i, b.boxes, far_j)
        if far < near:
            near_i, near_j, far_i, far_j, near, far = far_i, far_j, near_i, near_j, far, near
        if _nearer(far, least):
            waiting[count, 0], waiting[count, 1] = far_i, far_j
            count += 1
        if _nearer(near, least):
            waiting[count, 0], waiting[count, 1] = near_i, near_j
            count += 1
    return least
