"""Rotational distance: how far a body may turn about an axis before it meets another."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import inlined, kernel
from amprep.kernels.trees.boxes import distance_bound
from amprep.kernels.trees.directional import across
from amprep.kernels.trees.records import (
    CENTRE,
    RADIUS,
    TOUCH,
    Frame,
    ObbTree,
    Stack,
    Triangle,
    Vector,
    corners_along,
    moved,
    moved_triangle,
    push_nearer_last,
    relative,
    to_part,
    triangle_of,
)
from amprep.kernels.trees.triangles.turn import contact_turn, margin_turn

# Strategy. As for the directional distance, with the angle in place of the travel. Lower bounds of the angle for two
# boxes: infinity where the spheres around them have no common distance to the axis, or no common height along it; the
# angle between the sectors of the two spheres; and the distance of the boxes divided by the greatest distance of the
# first one to the axis, because no point moves faster than that. At the leaves only triangles that advance into the
# turn meet others that face it.


@inlined
def _triangle_in_frame(t: Triangle, origin: Vector, x: Vector, y: Vector, z: Vector) -> Triangle:
    """Return the corners relative to an origin, along three directions."""
    ox, oy, oz = origin
    ax, ay, az, bx, by, bz, cx, cy, cz = t
    moved_corners = (ax - ox, ay - oy, az - oz, bx - ox, by - oy, bz - oz, cx - ox, cy - oy, cz - oz)
    return corners_along(moved_corners, x, y, z)


@inlined
def _greatest_rate(t: Triangle) -> float:
    """Return the greatest rate at which a turn about z moves a corner along the normal of its triangle, unscaled."""
    ux, uy, uz = t[3] - t[0], t[4] - t[1], t[5] - t[2]
    vx, vy, vz = t[6] - t[0], t[7] - t[1], t[8] - t[2]
    nx, ny = uy * vz - uz * vy, uz * vx - ux * vz
    return max(ny * t[0] - nx * t[1], ny * t[3] - nx * t[4], ny * t[6] - nx * t[7])


@inlined
def _least_rate(t: Triangle) -> float:
    return -_greatest_rate((t[0], t[1], t[2], t[6], t[7], t[8], t[3], t[4], t[5]))


@inlined
def _cylindrical(p: Vector, origin: Vector, z: Vector) -> tuple[float, Vector]:
    """Return the height of a point along the axis, and its vector from the axis."""
    dx, dy, dz = p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]
    height = dx * z[0] + dy * z[1] + dz * z[2]
    return height, (dx - height * z[0], dy - height * z[1], dz - height * z[2])


@inlined
def _half_sector(radius: float, distance: float) -> float:
    """Return half the angle under which the axis sees a sphere; more than pi if it meets the sphere."""
    return np.arcsin(radius / distance) if radius < distance else 4.0


@inlined
def first_angle(
    a: Floats, i: int, b: Floats, j: int, frame: Frame, origin: Vector, z: Vector, margin: float, limit: float
) -> float:
    """Return a lower bound of the angle by which box i may turn until it is within a margin of box j.

    Parameters
    ----------
    a, b
        Nodes of two trees.
    frame
        Takes coordinates of the first body to those of the second.
    origin, z
        A point on the axis and its direction, in coordinates of the second body.
    margin, limit
        mm and rad; infinity is returned for bounds that are not below the limit.
    """
    centre = moved(frame, a[i, CENTRE], a[i, CENTRE + 1], a[i, CENTRE + 2])
    height_a, u = _cylindrical(centre, origin, z)
    height_b, v = _cylindrical((b[j, CENTRE], b[j, CENTRE + 1], b[j, CENTRE + 2]), origin, z)
    reach = a[i, RADIUS] + b[j, RADIUS] + margin
    if abs(height_a - height_b) > reach:
        return np.inf
    out_a = np.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
    out_b = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if abs(out_a - out_b) > reach:
        return np.inf
    apart = distance_bound(a, i, b, j, frame, np.inf) - margin
    angle = max(apart, 0.0) / (out_a + a[i, RADIUS] + 1e-300)
    half = _half_sector(a[i, RADIUS], out_a) + _half_sector(b[j, RADIUS] + margin, out_b)
    if half < np.pi:
        sine = z[0] * (u[1] * v[2] - u[2] * v[1]) + z[1] * (u[2] * v[0] - u[0] * v[2])
        sine += z[2] * (u[0] * v[1] - u[1] * v[0])
        between = np.arctan2(sine, u[0] * v[0] + u[1] * v[1] + u[2] * v[2])
        if abs(between) > half:
            angle = max(angle, (between if between > 0.0 else between + 2.0 * np.pi) - half)
    return angle if angle < limit else np.inf


@inlined
def _some_advances(tree: ObbTree, i: int, origin: Vector, z: Vector, sense: float) -> bool:
    """Return whether a triangle below a node may move along its normal in a turn; with sense -1, against it.

    Parameters
    ----------
    origin, z
        A point on the axis and its direction, in coordinates of the body.
    """
    dx, dy = tree.nodes[i, CENTRE] - origin[0], tree.nodes[i, CENTRE + 1] - origin[1]
    dz = tree.nodes[i, CENTRE + 2] - origin[2]
    ux, uy, uz = z[1] * dz - z[2] * dy, z[2] * dx - z[0] * dz, z[0] * dy - z[1] * dx
    sine = tree.cones[i, 3]
    if sine < 0.0:
        return False
    if sine > 1.0:
        return True
    along = sense * (tree.cones[i, 0] * ux + tree.cones[i, 1] * uy + tree.cones[i, 2] * uz)
    square, cosine = ux * ux + uy * uy + uz * uz, np.sqrt(1.0 - sine * sine)
    across = np.sqrt(max(square - along * along, 0.0))
    return along >= cosine * np.sqrt(square) or along * cosine + across * sine + tree.nodes[i, RADIUS] > 0.0


@kernel
def rotational_distance(
    a: ObbTree,
    pose_a: Floats,
    b: ObbTree,
    pose_b: Floats,
    point: Vector,
    axis: Vector,
    margin: float,
    limit: float,
    stack: Stack,
) -> float:
    """Return how far the first body may turn about an axis before it is within a margin of the second (thesis 2.6).

    With margin 0 the result is exact up to rounding; with a positive margin the travel is at most 1e-6 mm short and
    never too long. It is 0 if the bodies are in contact (within `TOUCH`) and would go deeper; contacts that slide or
    open do not count. The bodies must not intersect by more than `TOUCH`.

    Parameters
    ----------
    a, b
        Trees of closed, outward oriented meshes.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    point, axis
        A point (x, y, z) on the axis, mm, and its direction, a unit vector, in the coordinates of the poses; the turn
        is counter-clockwise seen against the direction.
    margin
        mm, at least 0.
    limit
        rad; returned if the first body may turn at least as far.
    stack
        Work arrays for the depth of both trees.
    """
    frame = relative(pose_a, pose_b)
    z = to_part(pose_b, axis[0], axis[1], axis[2])
    origin = to_part(pose_b, point[0] - pose_b[3], point[1] - pose_b[7], point[2] - pose_b[11])
    z_a = to_part(pose_a, axis[0], axis[1], axis[2])
    from_a = to_part(pose_a, point[0] - pose_a[3], point[1] - pose_a[7], point[2] - pose_a[11])
    x, y = across(z)
    best, reach = limit, margin + TOUCH
    stack.pairs[0, 0], stack.pairs[0, 1] = 0, 0
    stack.bounds[0] = first_angle(a.nodes, 0, b.nodes, 0, frame, origin, z, reach, best)
    waiting = 1
    while waiting > 0:
        waiting -= 1
        i, j = stack.pairs[waiting, 0], stack.pairs[waiting, 1]
        if stack.bounds[waiting] >= best:
            continue
        next_a, next_b = a.link[i], b.link[j]
        if next_a < 0 and next_b < 0:
            one = _triangle_in_frame(moved_triangle(frame, a, -1 - next_a), origin, x, y, z)
            other = _triangle_in_frame(triangle_of(b, -1 - next_b), origin, x, y, z)
            if _greatest_rate(one) > 0.0 and _least_rate(other) < 0.0:
                if margin > TOUCH:
                    best = min(best, margin_turn(one, other, margin, best))
                else:
                    best = min(best, contact_turn(one, other, best))
            continue
        if next_b < 0 or (next_a >= 0 and a.nodes[i, RADIUS] >= b.nodes[j, RADIUS]):
            near_a, near_b, far_a, far_b = next_a, j, next_a + 1, j
        else:
            near_a, near_b, far_a, far_b = i, next_b, i, next_b + 1
        near, far = np.inf, np.inf
        if _some_advances(a, near_a, from_a, z_a, 1.0) and _some_advances(b, near_b, origin, z, -1.0):
            near = first_angle(a.nodes, near_a, b.nodes, near_b, frame, origin, z, reach, best)
        if _some_advances(a, far_a, from_a, z_a, 1.0) and _some_advances(b, far_b, origin, z, -1.0):
            far = first_angle(a.nodes, far_a, b.nodes, far_b, frame, origin, z, reach, best)
        waiting = push_nearer_last(stack, waiting, best, near, near_a, near_b, far, far_a, far_b)
        if best <= 0.0:
            return 0.0
    return best
