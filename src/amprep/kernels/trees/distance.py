"""Distance of the surfaces of two bodies."""

import numpy as np

from amprep.arrays import Floats
from amprep.kernels.helper import kernel
from amprep.kernels.trees.boxes import distance_bound
from amprep.kernels.trees.records import (
    RADIUS,
    ObbTree,
    Stack,
    moved_triangle,
    push_nearer_last,
    relative,
    triangle_of,
)
from amprep.kernels.trees.triangles.distance import closest_points


@kernel
def surface_distance(
    a: ObbTree, pose_a: Floats, b: ObbTree, pose_b: Floats, limit: float, stack: Stack
) -> float:
    """Return the distance of the surfaces of two bodies, mm; 0 if they intersect or touch.

    Pairs of nodes are visited in the order of a lower bound of their distance, the nearer one first, and dropped if it
    is no less than the least distance found.

    Parameters
    ----------
    a, b
        Trees of the bodies.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    limit
        mm; returned if the bodies are at least as far apart.
    stack
        Work arrays for the depth of both trees.
    """
    frame = relative(pose_a, pose_b)
    best = limit
    stack.pairs[0, 0], stack.pairs[0, 1] = 0, 0
    stack.bounds[0] = distance_bound(a.nodes, 0, b.nodes, 0, frame, best)
    waiting = 1
    while waiting > 0:
        waiting -= 1
        i, j = stack.pairs[waiting, 0], stack.pairs[waiting, 1]
        if stack.bounds[waiting] >= best:
            continue
        next_a, next_b = a.link[i], b.link[j]
        if next_a < 0 and next_b < 0:
            gap = closest_points(moved_triangle(frame, a, -1 - next_a), triangle_of(b, -1 - next_b))
            best = min(best, np.sqrt(gap[0]))
            continue
        if next_b < 0 or (next_a >= 0 and a.nodes[i, RADIUS] >= b.nodes[j, RADIUS]):
            near_a, near_b, far_a, far_b = next_a, j, next_a + 1, j
        else:
            near_a, near_b, far_a, far_b = i, next_b, i, next_b + 1
        near = distance_bound(a.nodes, near_a, b.nodes, near_b, frame, best)
        far = distance_bound(a.nodes, far_a, b.nodes, far_b, frame, best)
        waiting = push_nearer_last(stack, waiting, best, near, near_a, near_b, far, far_a, far_b)
        if best <= 0.0:
            return 0.0
    return best
