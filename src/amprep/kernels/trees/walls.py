"""Walls of the build volume: the interval of travel, and the angle up to which a body is inside."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import inlined, kernel
from amprep.kernels.trees.circles import first_exit
from amprep.kernels.trees.records import TOUCH, Vector

# Strategy. The build volume is convex, so a body is inside if the vertices of its convex hull are, and the travel along
# which a vertex is inside is one interval: between two planes, or between the roots of a quadratic for a cylinder. A
# vertex that turns about an axis has coordinates b cos(angle) + c sin(angle) + constant, and so has its squared
# distance to an axis parallel to the one it turns about. Where a cylinder meets an axis of another direction, steps are
# taken that a bound of the second derivative allows; they never go too far.


class Walls(NamedTuple):
    """The build volume: a box, or the upright cylinder inscribed in it, mm.

    Attributes
    ----------
    low, high
        Corners of the box.
    is_cylinder
        Whether the volume is the cylinder.
    """

    low: Vector
    high: Vector
    is_cylinder: bool


@inlined
def _placed(pose: Floats, x: float, y: float, z: float) -> Vector:
    return (
        pose[0] * x + pose[1] * y + pose[2] * z + pose[3],
        pose[4] * x + pose[5] * y + pose[6] * z + pose[7],
        pose[8] * x + pose[9] * y + pose[10] * z + pose[11],
    )


@inlined
def _axis(walls: Walls) -> tuple[float, float, float]:
    """Return the centre and the radius of the cylinder."""
    x, y = 0.5 * (walls.low[0] + walls.high[0]), 0.5 * (walls.low[1] + walls.high[1])
    return x, y, 0.5 * (walls.high[0] - walls.low[0])


@kernel
def depth_outside(hull: Floats, pose: Floats, walls: Walls, margin: float) -> float:
    """Return how far a body is outside the walls moved inwards by a margin, mm; at most 0 if it is inside.

    Parameters
    ----------
    hull
        ``(h, 3)``, vertices of the convex hull.
    pose
        ``(12,)``.
    walls
        The build volume.
    margin
        mm.
    """
    deepest = -np.inf
    x, y, radius = _axis(walls)
    for h in range(hull.shape[0]):
        p = _placed(pose, hull[h, 0], hull[h, 1], hull[h, 2])
        deepest = max(deepest, walls.low[2] - p[2], p[2] - walls.high[2])
        if walls.is_cylinder:
            deepest = max(deepest, np.sqrt((p[0] - x) ** 2 + (p[1] - y) ** 2) - radius)
        else:
            deepest = max(deepest, walls.low[0] - p[0], p[0] - walls.high[0])
            deepest = max(deepest, walls.low[1] - p[1], p[1] - walls.high[1])
    return deepest + margin


@inlined
def _between(enter: float, leave: float, below: float, above: float, rate: float) -> tuple[float, float]:
    """Return the part of an interval of travel that keeps a vertex between two planes.

    Parameters
    ----------
    below, above
        Distance to the lower and the upper plane, mm; rounding up to `TOUCH` outside counts as contact.
    rate
        Of the coordinate.
    """
    below = 0.0 if -TOUCH <= below < 0.0 else below
    above = 0.0 if -TOUCH <= above < 0.0 else above
    if abs(rate) <= 1e-14:
        return (enter, leave) if min(below, above) >= 0.0 else (np.inf, -np.inf)
    if rate > 0.0:
        return max(enter, -below / rate), min(leave, above / rate)
    return max(enter, above / rate), min(leave, -below / rate)


@inlined
def _in_circle(
    enter: float, leave: float, dx: float, dy: float, direction: Vector, radius: float
) -> tuple[float, float]:
    """Return the part of an interval of travel that keeps a vertex in a circle about the origin."""
    a = direction[0] ** 2 + direction[1] ** 2
    b = dx * direction[0] + dy * direction[1]
    distance = np.sqrt(dx * dx + dy * dy)
    radius = distance if radius < distance <= radius + TOUCH else radius
    c = (distance - radius) * (distance + radius)
    if a <= 1e-28:
        return (enter, leave) if c <= 0.0 else (np.inf, -np.inf)
    square = b * b - a * c
    if square < 0.0:
        return np.inf, -np.inf
    root = np.sqrt(square)
    first = (-b - root) / a if b >= 0.0 else c / (-b + root)
    last = (-b + root) / a if b <= 0.0 else c / (-b - root)
    return max(enter, first), min(leave, last)


@kernel
def travel_inside(
    hull: Floats, pose: Floats, direction: Vector, walls: Walls, margin: float
) -> tuple[float, float]:
    """Return the first and the last travel at which a body is inside the walls moved inwards by a margin, mm.

    The first one is negative or 0 if the body is inside now, up to `TOUCH`; it is above the last one if the body is
    never inside.

    Parameters
    ----------
    hull
        ``(h, 3)``, vertices of the convex hull.
    pose
        ``(12,)``.
    direction
        Unit vector (x, y, z).
    walls
        The build volume.
    margin
        mm.
    """
    enter, leave = -np.inf, np.inf
    x, y, radius = _axis(walls)
    for h in range(hull.shape[0]):
        p = _placed(pose, hull[h, 0], hull[h, 1], hull[h, 2])
        for k in range(3):
            if k == 2 or not walls.is_cylinder:
                below, above = p[k] - walls.low[k] - margin, walls.high[k] - margin - p[k]
                enter, leave = _between(enter, leave, below, above, direction[k])
        if walls.is_cylinder:
            enter, leave = _in_circle(enter, leave, p[0] - x, p[1] - y, direction, radius - margin)
    return enter, leave


@inlined
def _steps_in_circle(px: Vector, py: Vector, radius: float, limit: float) -> float:
    """Return an angle up to which a vertex stays in a circle about the origin, at most 1e-9 short.

    Parameters
    ----------
    px, py
        Constant, factor of the cosine and factor of the sine of its coordinates.
    """
    most_x, most_y = np.sqrt(px[1] ** 2 + px[2] ** 2), np.sqrt(py[1] ** 2 + py[2] ** 2)
    curve = 2.0 * (most_x * (abs(px[0]) + 2.0 * most_x) + most_y * (abs(py[0]) + 2.0 * most_y))
    angle = 0.0
    for _ in range(10_000):
        c, s = np.cos(angle), np.sin(angle)
        x, y = px[0] + px[1] * c + px[2] * s, py[0] + py[1] * c + py[2] * s
        room = radius * radius - x * x - y * y
        if angle == 0.0 and -2.0 * TOUCH * radius <= room < 0.0:
            room = 0.0
        rate = 2.0 * (x * (px[2] * c - px[1] * s) + y * (py[2] * c - py[1] * s))
        if room < 0.0 or curve == 0.0:
            return angle if room < 0.0 else np.inf
        step = (np.sqrt(rate * rate + 2.0 * curve * room) - rate) / curve
        if step < 1e-10:
            return angle
        angle += step
        if angle >= limit:
            return np.inf
    return angle


@kernel
def turn_inside(
    hull: Floats, pose: Floats, point: Vector, axis: Vector, walls: Walls, margin: float, limit: float
) -> float:
    """Return the angle by which a body may turn about an axis inside the walls moved inwards by a margin, rad.

    The result is exact up to rounding, except about an axis that is not upright in a cylinder: then it is never too
    large. A body that is outside by more than `TOUCH` may not turn: the result is 0.

    Parameters
    ----------
    hull
        ``(h, 3)``, vertices of the convex hull.
    pose
        ``(12,)``.
    point, axis
        A point on the axis, mm, and its direction, a unit vector; the turn is counter-clockwise seen against it.
    walls
        The build volume.
    margin
        mm.
    limit
        rad; returned if the body may turn at least as far.
    """
    best = limit
    cx, cy, radius = _axis(walls)
    for h in range(hull.shape[0]):
        p = _placed(pose, hull[h, 0], hull[h, 1], hull[h, 2])
        dx, dy, dz = p[0] - point[0], p[1] - point[1], p[2] - point[2]
        along = dx * axis[0] + dy * axis[1] + dz * axis[2]
        fixed = (along * axis[0], along * axis[1], along * axis[2])
        out = (dx - fixed[0], dy - fixed[1], dz - fixed[2])
        side = (axis[1] * dz - axis[2] * dy, axis[2] * dx - axis[0] * dz, axis[0] * dy - axis[1] * dx)
        for k in range(3):
            if k == 2 or not walls.is_cylinder:
                at = point[k] + fixed[k]
                best = min(best, first_exit(out[k], side[k], walls.high[k] - margin - at))
                best = min(best, first_exit(-out[k], -side[k], at - walls.low[k] - margin))
        if walls.is_cylinder:
            x, y, room = point[0] + fixed[0] - cx, point[1] + fixed[1] - cy, radius - margin
            if abs(axis[0]) + abs(axis[1]) <= 1e-14:
                reach = out[0] * out[0] + out[1] * out[1] + x * x + y * y
                distance = np.sqrt((x + out[0]) ** 2 + (y + out[1]) ** 2)
                room = distance if room < distance <= room + TOUCH else room
                most = 0.5 * (room * room - reach)
                best = min(best, first_exit(x * out[0] + y * out[1], x * side[0] + y * side[1], most))
            else:
                steps = _steps_in_circle((x, out[0], side[0]), (y, out[1], side[1]), room, best)
                best = min(best, steps)
    return best
