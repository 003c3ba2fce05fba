"""Pairs of triangles: how far one may turn about an axis before it meets the other."""

import numpy as np

from amprep.kernels.helper import inlined
from amprep.kernels.trees.circles import first_exit
from amprep.kernels.trees.records import TOUCH, Triangle, Vector
from amprep.kernels.trees.triangles.distance import closest_points

# Strategy. The axis is the z axis. While all corners of the turning triangle are on one side of a plane, and the other
# triangle is on its other side, they do not meet, and the angle at which a corner passes a plane has a closed form. So
# the triangle turns up to that angle, a new plane is chosen, and so on. Two triangles that do not meet are separated by
# a plane that is parallel to one of them or to an edge of each, or normal to one of them through an edge. Of all that
# separate, the one that allows most is taken. Where a corner meets a face the plane is that of the face, and one step
# is exact; where two edges meet the steps converge quadratically. No step is too long. In contact, a plane that corners
# leave or slide along allows a step; if there is none, the triangles would enter one another, and the angle is 0. Until
# the triangles are near, the plane normal to their closest points is taken, which costs least.

STEPS = 100
"""Most planes that are tried."""

NEAR = 1e-2
"""mm; distance from which all planes are tried."""

LEAST_STEP = 1e-12
"""rad; where no plane allows more, the triangles meet."""


@inlined
def _corner(t: Triangle, i: int) -> Vector:
    return (t[3 * i], t[3 * i + 1], t[3 * i + 2])


@inlined
def turned_triangle(t: Triangle, angle: float) -> Triangle:
    """Return a triangle that has turned about the z axis."""
    c, s = np.cos(angle), np.sin(angle)
    return (
        c * t[0] - s * t[1],
        s * t[0] + c * t[1],
        t[2],
        c * t[3] - s * t[4],
        s * t[3] + c * t[4],
        t[5],
        c * t[6] - s * t[7],
        s * t[6] + c * t[7],
        t[8],
    )


@inlined
def _extent(t: Triangle, w: Vector) -> tuple[float, float]:
    """Return the least and the greatest coordinate of a triangle along a direction."""
    p = w[0] * t[0] + w[1] * t[1] + w[2] * t[2]
    q = w[0] * t[3] + w[1] * t[4] + w[2] * t[5]
    r = w[0] * t[6] + w[1] * t[7] + w[2] * t[8]
    return min(p, q, r), max(p, q, r)


@inlined
def _turn_below(t: Triangle, w: Vector, room: float, sense: float) -> float:
    """Return how far a triangle may turn until a corner is more than `room` above its highest corner now."""
    least = np.inf
    _, high = _extent(t, w)
    for i in range(3):
        x, y, z = _corner(t, i)
        sine = sense * (w[1] * x - w[0] * y)
        least = min(least, first_exit(w[0] * x + w[1] * y, sine, high + room - w[2] * z))
    return least


@inlined
def _step(a: Triangle, b: Triangle, wx: float, wy: float, wz: float, least: float) -> float:
    """Return how far the first triangle may turn while a plane of given normal separates the two, at least `least`.

    The plane may be fixed, or turn with the first triangle; then the second one turns back.
    """
    length = np.sqrt(wx * wx + wy * wy + wz * wz)
    if length <= 1e-12:
        return least
    w = (wx / length, wy / length, wz / length)
    low_a, high_a = _extent(a, w)
    low_b, high_b = _extent(b, w)
    room = low_b - high_a
    if low_a - high_b > room:
        room, w = low_a - high_b, (-w[0], -w[1], -w[2])
    if room < -TOUCH:
        return least
    least = max(least, _turn_below(a, w, max(room, 0.0), 1.0))
    return max(least, _turn_below(b, (-w[0], -w[1], -w[2]), max(room, 0.0), -1.0))


@inlined
def _edge(t: Triangle, i: int) -> Vector:
    k = (i + 1) % 3
    x, y, z = t[3 * k] - t[3 * i], t[3 * k + 1] - t[3 * i + 1], t[3 * k + 2] - t[3 * i + 2]
    length = np.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length) if length > 0.0 else (0.0, 0.0, 0.0)


@inlined
def _cross(u: Vector, v: Vector) -> Vector:
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


@inlined
def _longest_step(a: Triangle, b: Triangle) -> float:
    """Return how far the first triangle may turn while one of the 17 planes separates the two."""
    least = -1.0
    for k in range(8):
        t = a if k < 4 else b
        normal = _cross(_edge(t, 0), _edge(t, 1))
        w = normal if k % 4 == 3 else _cross(normal, _edge(t, k % 4))
        least = _step(a, b, w[0], w[1], w[2], least)
    for i in range(3):
        u = _edge(a, i)
        for j in range(3):
            w = _cross(u, _edge(b, j))
            least = _step(a, b, w[0], w[1], w[2], least)
    return least


@inlined
def contact_turn(a: Triangle, b: Triangle, limit: float) -> float:
    """Return the angle by which a triangle may turn about z before it meets another; infinity if beyond a limit."""
    angle = 0.0
    for _ in range(STEPS):
        t = turned_triangle(a, angle)
        closest = closest_points(t, b)
        distance = np.sqrt(closest[0])
        if distance > NEAR:
            w = (closest[4] / distance, closest[5] / distance, closest[6] / distance)
            step = _turn_below(t, w, distance, 1.0)
        else:
            step = _longest_step(t, b)
        if step <= LEAST_STEP:
            return angle
        angle += step
        if angle >= limit:
            return np.inf
    return angle


@inlined
def margin_turn(a: Triangle, b: Triangle, margin: float, limit: float) -> float:
    """Return the angle by which a triangle may turn about z before it is within a margin of another.

    As `contact_turn`, with the plane normal to the closest points. The result ends less than 1e-7 mm of travel before
    the margin, and never beyond it; triangles that only graze the margin, by at most `TOUCH`, are free. It is infinity
    if it is beyond the limit.
    """
    angle, reached, goal = 0.0, np.inf, margin
    for _ in range(STEPS):
        t = turned_triangle(a, angle)
        closest = closest_points(t, b)
        distance = np.sqrt(closest[0])
        if distance <= 0.0 or distance < goal - TOUCH:
            return min(angle, reached)
        w = (closest[4] / distance, closest[5] / distance, closest[6] / distance)
        step = _turn_below(t, w, max(distance - goal, 0.0), 1.0)
        if step < 1e-10:
            rate = w[1] * closest[1] - w[0] * closest[2]
            if goal < margin or rate > 1e-2:
                return min(angle, reached)
            reached, goal = angle, margin - TOUCH
            continue
        angle += step
        if angle >= limit:
            return np.inf
    return min(angle, reached)
