"""Directional distance: how far a body may travel along a direction before it meets another."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import inlined, kernel
from amprep.kernels.trees.boxes import first_overlap
from amprep.kernels.trees.records import (
    RADIUS,
    TOUCH,
    ObbTree,
    Stack,
    Vector,
    corners_along,
    moved_triangle,
    push_nearer_last,
    relative,
    to_part,
    triangle_of,
)
from amprep.kernels.trees.triangles.distance import margin_travel
from amprep.kernels.trees.triangles.travel import EDGE_ON, shadow_travel

# Strategy. The thesis's branch and bound: pairs of nodes are visited in the order of the travel at which their boxes
# meet, and dropped if that is no less than the least travel found so far. The larger box of a pair is replaced by its
# children, and the nearer pair is visited first. At the leaves only leading triangles of the first body and facing ones
# of the second can meet first, which is true with a margin as well.


@inlined
def across(direction: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors that form a right-handed frame with a direction."""
    x, y, z = direction
    if abs(x) < 0.6:
        length = np.sqrt(y * y + z * z)
        first = (0.0, z / length, -y / length)
    else:
        length = np.sqrt(x * x + y * y)
        first = (y / length, -x / length, 0.0)
    second = (
        y * first[2] - z * first[1],
        z * first[0] - x * first[2],
        x * first[1] - y * first[0],
    )
    return first, second


@inlined
def _cosine(tree: ObbTree, t: int, direction: Vector) -> float:
    """Return the cosine between the normal of a triangle and a direction, both in part coordinates."""
    n = tree.normals
    return n[t, 0] * direction[0] + n[t, 1] * direction[1] + n[t, 2] * direction[2]


@inlined
def _some_within(cones: Floats, i: int, direction: Vector) -> bool:
    """Return whether a normal below a node may make an acute angle with a direction."""
    cosine = cones[i, 0] * direction[0] + cones[i, 1] * direction[1] + cones[i, 2] * direction[2]
    return cosine > -cones[i, 3]


@kernel
def directional_distance(
    a: ObbTree,
    pose_a: Floats,
    b: ObbTree,
    pose_b: Floats,
    direction: Vector,
    margin: float,
    limit: float,
    stack: Stack,
) -> float:
    """Return how far the first body may travel before it is within a margin of the second (thesis 2.6).

    With margin 0 the result is exact up to rounding; with a positive margin it is at most 1e-6 mm short and never too
    long. It is 0 if the bodies are in contact (within `TOUCH`) and would go deeper; contacts that slide or open do not
    count. The bodies must not intersect by more than `TOUCH`.

    Parameters
    ----------
    a, b
        Trees of closed, outward oriented meshes.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    direction
        Unit vector (x, y, z) in the coordinates of the poses.
    margin
        mm, at least 0.
    limit
        mm; returned if the first body may travel at least as far.
    stack
        Work arrays for the depth of both trees.
    """
    frame = relative(pose_a, pose_b)
    z = to_part(pose_b, direction[0], direction[1], direction[2])
    x, y = across(z)
    back = to_part(pose_a, direction[0], direction[1], direction[2])
    toward = (-z[0], -z[1], -z[2])
    best, reach = limit, margin + TOUCH
    low = first_overlap(a.nodes, 0, b.nodes, 0, frame, z, reach, best)
    stack.pairs[0, 0], stack.pairs[0, 1], stack.bounds[0] = 0, 0, low
    waiting = 1 if low < best else 0
    while waiting > 0:
        waiting -= 1
        i, j = stack.pairs[waiting, 0], stack.pairs[waiting, 1]
        if stack.bounds[waiting] >= best:
            continue
        next_a, next_b = a.link[i], b.link[j]
        if next_a < 0 and next_b < 0:
            s, t = -1 - next_a, -1 - next_b
            leading, facing = _cosine(a, s, back), -_cosine(b, t, z)
            if leading > EDGE_ON and facing > EDGE_ON:
                one, other = moved_triangle(frame, a, s), triangle_of(b, t)
                if margin > TOUCH:
                    travel = margin_travel(one, other, z, margin, best)
                else:
                    travel = shadow_travel(
                        corners_along(one, x, y, z),
                        corners_along(other, x, y, z),
                        min(leading, facing),
                        stack.sides,
                    )
                best = min(best, travel)
            continue
        if next_b < 0 or (next_a >= 0 and a.nodes[i, RADIUS] >= b.nodes[j, RADIUS]):
            near_a, near_b, far_a, far_b = next_a, j, next_a + 1, j
        else:
            near_a, near_b, far_a, far_b = i, next_b, i, next_b + 1
        near, far = np.inf, np.inf
        if _some_within(a.cones, near_a, back) and _some_within(b.cones, near_b, toward):
            near = first_overlap(a.nodes, near_a, b.nodes, near_b, frame, z, reach, best)
        if _some_within(a.cones, far_a, back) and _some_within(b.cones, far_b, toward):
            far = first_overlap(a.nodes, far_a, b.nodes, far_b, frame, z, reach, best)
        waiting = push_nearer_last(stack, waiting, best, near, near_a, near_b, far, far_a, far_b)
        if best <= 0.0:
            return 0.0
    return best
