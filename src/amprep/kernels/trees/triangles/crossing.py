"""Whether the solids that two triangles bound enter one another at these triangles."""

import numpy as np

from amprep.kernels.helper import inlined
from amprep.kernels.trees.records import TOUCH, Triangle, Vector

# Strategy. Each triangle is the border of a solid, with the outward normal. The planes of two triangles intersect in a
# line, and each triangle covers an interval of it (Moeller 1997). The solids enter one another here if the intervals
# share more than `TOUCH`, and each triangle has a corner deeper than `TOUCH` below the plane of the other. Solids that
# touch at faces, edges or corners do not: one of the two triangles is on the outer side. Coplanar triangles enter if
# their normals agree and they overlap in their plane: then both solids are on the same side of it.


@inlined
def _heights(normal: Vector, origin: Vector, triangle: Triangle) -> Vector:
    """Return the heights of the corners of a triangle above a plane."""
    nx, ny, nz = normal
    base = nx * origin[0] + ny * origin[1] + nz * origin[2]
    return (
        nx * triangle[0] + ny * triangle[1] + nz * triangle[2] - base,
        nx * triangle[3] + ny * triangle[4] + nz * triangle[5] - base,
        nx * triangle[6] + ny * triangle[7] + nz * triangle[8] - base,
    )


@inlined
def _add_crossing(
    interval: tuple[float, float], h: float, k: float, x: float, y: float
) -> tuple[float, float]:
    """Extend an interval by the point at which an edge from height h, place x to height k, place y has height 0."""
    low, high = interval
    if abs(h) <= TOUCH:
        low, high = min(low, x), max(high, x)
    elif abs(k) > TOUCH and h * k < 0.0:
        at = x + (y - x) * (h / (h - k))
        low, high = min(low, at), max(high, at)
    return low, high


@inlined
def _interval(heights: Vector, places: Vector) -> tuple[float, float]:
    """Return the interval that a triangle covers of the line in which two planes intersect."""
    interval = (np.inf, -np.inf)
    interval = _add_crossing(interval, heights[0], heights[1], places[0], places[1])
    interval = _add_crossing(interval, heights[1], heights[2], places[1], places[2])
    return _add_crossing(interval, heights[2], heights[0], places[2], places[0])


@inlined
def _separated_in_plane(a: Triangle, b: Triangle, normal: Vector) -> bool:
    """Return whether coplanar triangles of one orientation overlap by at most `TOUCH` across an edge of the first."""
    nx, ny, nz = normal
    for i in range(3):
        x, y, z = a[3 * i], a[3 * i + 1], a[3 * i + 2]
        k = 3 * ((i + 1) % 3)
        ex, ey, ez = a[k] - x, a[k + 1] - y, a[k + 2] - z
        ix, iy, iz = ny * ez - nz * ey, nz * ex - nx * ez, nx * ey - ny * ex
        most = -np.inf
        for j in range(0, 9, 3):
            most = max(most, ix * (b[j] - x) + iy * (b[j + 1] - y) + iz * (b[j + 2] - z))
        if most <= TOUCH * np.sqrt(ex * ex + ey * ey + ez * ez):
            return True
    return False


@inlined
def triangles_enter(a: Triangle, normal_a: Vector, b: Triangle, normal_b: Vector) -> bool:
    """Return whether the solids that two triangles bound enter one another by more than `TOUCH` at these triangles.

    Parameters
    ----------
    a, b
        Triangles in one frame, mm.
    normal_a, normal_b
        Their outward unit normals.
    """
    over_b = _heights(normal_b, (b[0], b[1], b[2]), a)
    if min(over_b) > TOUCH or max(over_b) < -TOUCH:
        return False
    over_a = _heights(normal_a, (a[0], a[1], a[2]), b)
    if min(over_a) > TOUCH or max(over_a) < -TOUCH:
        return False
    flat = min(over_b) >= -TOUCH and max(over_b) <= TOUCH
    if flat or (min(over_a) >= -TOUCH and max(over_a) <= TOUCH):
        same = normal_a[0] * normal_b[0] + normal_a[1] * normal_b[1] + normal_a[2] * normal_b[2] > 0.0
        return same and not _separated_in_plane(a, b, normal_b) and not _separated_in_plane(b, a, normal_b)
    if min(over_b) >= -TOUCH or min(over_a) >= -TOUCH:
        return False
    dx = normal_a[1] * normal_b[2] - normal_a[2] * normal_b[1]
    dy = normal_a[2] * normal_b[0] - normal_a[0] * normal_b[2]
    dz = normal_a[0] * normal_b[1] - normal_a[1] * normal_b[0]
    length = np.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return False
    dx, dy, dz = dx / length, dy / length, dz / length
    low_a, high_a = _interval(
        over_b,
        (
            dx * a[0] + dy * a[1] + dz * a[2],
            dx * a[3] + dy * a[4] + dz * a[5],
            dx * a[6] + dy * a[7] + dz * a[8],
        ),
    )
    low_b, high_b = _interval(
        over_a,
        (
            dx * b[0] + dy * b[1] + dz * b[2],
            dx * b[3] + dy * b[4] + dz * b[5],
            dx * b[6] + dy * b[7] + dz * b[8],
        ),
    )
    return min(high_a, high_b) - max(low_a, low_b) > TOUCH
