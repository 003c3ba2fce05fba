"""Whether the surfaces of two bodies intersect or are closer than a margin."""

from amprep.arrays import Floats
from amprep.kernels.helper import kernel
from amprep.kernels.trees.boxes import boxes_apart
from amprep.kernels.trees.records import (
    RADIUS,
    TOUCH,
    ObbTree,
    Stack,
    moved_triangle,
    relative,
    triangle_of,
    turned,
)
from amprep.kernels.trees.triangles.crossing import triangles_enter
from amprep.kernels.trees.triangles.distance import closest_points

# Strategy. Pairs of nodes whose boxes are apart are dropped; of the others the larger box is replaced by its children
# (thesis 2.6, where both are). All is computed in the frame of the second body, so the motion is composed once.


@kernel
def surfaces_collide(
    a: ObbTree, pose_a: Floats, b: ObbTree, pose_b: Floats, margin: float, stack: Stack
) -> bool:
    """Return whether the surfaces of two bodies intersect or are closer than a margin (thesis 2.6).

    With margin 0, surfaces that only touch do not intersect: see `triangles_enter`. With a positive margin the distance
    is compared with the margin minus `TOUCH`. For a body inside another without touching it see `containment`.

    Parameters
    ----------
    a, b
        Trees of the bodies.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    margin
        mm, at least 0.
    stack
        Work arrays for the depth of both trees.
    """
    frame = relative(pose_a, pose_b)
    near = margin - TOUCH if margin > TOUCH else 0.0
    stack.pairs[0, 0], stack.pairs[0, 1] = 0, 0
    waiting = 1
    while waiting > 0:
        waiting -= 1
        i, j = stack.pairs[waiting, 0], stack.pairs[waiting, 1]
        if boxes_apart(a.nodes, i, b.nodes, j, frame, near):
            continue
        next_a, next_b = a.link[i], b.link[j]
        if next_a < 0 and next_b < 0:
            s, t = -1 - next_a, -1 - next_b
            one, other = moved_triangle(frame, a, s), triangle_of(b, t)
            if near > 0.0:
                if closest_points(one, other)[0] < near * near:
                    return True
            else:
                normal = turned(frame, a.normals[s, 0], a.normals[s, 1], a.normals[s, 2])
                if triangles_enter(one, normal, other, (b.normals[t, 0], b.normals[t, 1], b.normals[t, 2])):
                    return True
        elif next_b < 0 or (next_a >= 0 and a.nodes[i, RADIUS] >= b.nodes[j, RADIUS]):
            stack.pairs[waiting, 0], stack.pairs[waiting, 1] = next_a + 1, j
            stack.pairs[waiting + 1, 0], stack.pairs[waiting + 1, 1] = next_a, j
            waiting += 2
        else:
            stack.pairs[waiting, 0], stack.pairs[waiting, 1] = i, next_b + 1
            stack.pairs[waiting + 1, 0], stack.pairs[waiting + 1, 1] = i, next_b
            waiting += 2
    return False
