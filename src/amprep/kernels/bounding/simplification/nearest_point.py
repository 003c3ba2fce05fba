"""The point of a polyhedron that is nearest to a given point: a quadratic program in three unknowns.

Strategy: the constraints are added one by one (Seidel 1991, DOI 10.1007/BF02574699). While the nearest
point satisfies the next half-space it remains. Otherwise the new nearest point is on the plane of that
half-space, and the same is done in this plane: its nearest point either satisfies the earlier
half-spaces or is on the line in which the plane meets one of them. On a line the half-spaces are bounds
of one parameter. At most three planes are active, as there are three unknowns. The objective is strictly
convex, so the point is unique and nothing can cycle. The time is linear in the number of constraints
while few of them are violated.
"""

from amprep.arrays import Floats
from amprep.kernels.bounding.simplification.points import Point, along, cross, dot, part

_PARALLEL = 1e-22
"""Square of the sine of the angle below which two planes are parallel."""

_NONE = (0.0, 0.0, 0.0)


@part
def _on_line(normals: Floats, offsets: Floats, i: int, j: int, q: Point) -> tuple[bool, Point]:
    """Return whether a point on the planes i and j satisfies the half-spaces before j, and the nearest such point."""
    a = normals[i, 0], normals[i, 1], normals[i, 2]
    b = normals[j, 0], normals[j, 1], normals[j, 2]
    line = cross(a, b)
    square = dot(line, line)
    if square < _PARALLEL:
        return False, _NONE
    cosine, one, two = dot(a, b), offsets[i] - dot(a, q), offsets[j] - dot(b, q)
    p = along(along(q, a, (one - cosine * two) / square), b, (two - cosine * one) / square)
    low, high = -1e300, 1e300
    for k in range(j):
        n = normals[k, 0], normals[k, 1], normals[k, 2]
        slope, need = dot(n, line), offsets[k] - dot(n, p)
        if slope * slope < _PARALLEL * square:
            if need > 1e-12 * abs(offsets[k]) + 1e-15:
                return False, _NONE
        elif slope > 0.0:
            low = max(low, need / slope)
        else:
            high = min(high, need / slope)
    if low > high:
        return False, _NONE
    return True, along(p, line, min(max(0.0, low), high))


@part
def nearest_point(normals: Floats, offsets: Floats, count: int, q: Point) -> tuple[bool, Point]:
    """Return whether half-spaces have a common point, and the one nearest to a point.

    Parameters
    ----------
    normals, offsets
        ``(k, 3)`` unit vectors and ``(k,)``: half-space i is ``normals[i] @ x >= offsets[i]``.
    count
        Number of half-spaces.
    q
        The point.
    """
    p = q
    for i in range(count):
        a = normals[i, 0], normals[i, 1], normals[i, 2]
        if dot(a, p) >= offsets[i]:
            continue
        p = along(q, a, offsets[i] - dot(a, q))
        for j in range(i):
            if normals[j, 0] * p[0] + normals[j, 1] * p[1] + normals[j, 2] * p[2] >= offsets[j]:
                continue
            found, p = _on_line(normals, offsets, i, j, q)
            if not found:
                return False, _NONE
    return True, p
