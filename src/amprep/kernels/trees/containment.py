"""Points and bodies inside others."""

from amprep.arrays import Floats
from amprep.kernels.helper import inlined, kernel
from amprep.kernels.trees.collide import surfaces_collide
from amprep.kernels.trees.records import AXES, CENTRE, HALF, ObbTree, Stack, Vector, to_part

# Strategy. A vertical line from a point downwards crosses the surface; the signed crossings are the winding number.
# Subtrees whose boxes the line misses are left out. Whether the line is within the projection of a triangle is decided
# edge by edge, and the crossing of an edge is computed from its end with the lower y, so the two triangles at an edge
# agree to the last bit. Bodies whose surfaces do not intersect are apart, or one contains the other: then it contains
# an interior point of each component of the other. Points on the surface tell whether a cavity is inside a body.


ON_SURFACE, IN_SOLID = 0, 3
"""First columns of the samples: a point on the surface, and one in the solid below it."""


@inlined
def _missed(nodes: Floats, i: int, p: Vector) -> bool:
    """Return whether a box is beside the vertical line below a point, or above the point."""
    h0, h1, h2 = nodes[i, HALF], nodes[i, HALF + 1], nodes[i, HALF + 2]
    for k in range(3):
        reach = h0 * abs(nodes[i, AXES + k])
        reach += h1 * abs(nodes[i, AXES + 3 + k]) + h2 * abs(nodes[i, AXES + 6 + k])
        reach += 1e-12 * (abs(p[k]) + reach)
        if nodes[i, CENTRE + k] - reach > p[k] or (k < 2 and nodes[i, CENTRE + k] + reach < p[k]):
            return True
    return False


@inlined
def _crossing(tree: ObbTree, t: int, p: Vector) -> int:
    """Return 1 if the line below a point enters the solid upwards through a triangle, -1 if it leaves it, else 0."""
    c = tree.corners
    turns = 0
    for i in range(3):
        low, high = 3 * i, 3 * ((i + 1) % 3)
        rising = c[t, low + 1] <= p[1] < c[t, high + 1]
        if not rising and not c[t, high + 1] <= p[1] < c[t, low + 1]:
            continue
        if not rising:
            low, high = high, low
        slope = (c[t, high] - c[t, low]) / (c[t, high + 1] - c[t, low + 1])
        if p[0] < c[t, low] + (p[1] - c[t, low + 1]) * slope:
            turns += 1 if rising else -1
    n = tree.normals
    if turns == 0 or n[t, 2] == 0.0:
        return 0
    ahead = n[t, 0] * (p[0] - c[t, 0]) + n[t, 1] * (p[1] - c[t, 1])
    height = c[t, 2] - ahead / n[t, 2]
    lowest, highest = min(c[t, 2], c[t, 5], c[t, 8]), max(c[t, 2], c[t, 5], c[t, 8])
    return -turns if min(max(height, lowest), highest) < p[2] else 0


@kernel
def contains_point(tree: ObbTree, point: Vector, stack: Stack) -> bool:
    """Return whether a point has a positive winding number with respect to a mesh.

    Points on the surface may count either way.

    Parameters
    ----------
    tree
        Of a closed, outward oriented mesh.
    point
        In the coordinates of the mesh, mm.
    stack
        Work arrays for the depth of the tree.
    """
    winding = 0
    stack.pairs[0, 0] = 0
    waiting = 1
    while waiting > 0:
        waiting -= 1
        i = stack.pairs[waiting, 0]
        if _missed(tree.nodes, i, point):
            continue
        first = tree.link[i]
        if first < 0:
            winding += _crossing(tree, -1 - first, point)
        else:
            stack.pairs[waiting, 0], stack.pairs[waiting + 1, 0] = first, first + 1
            waiting += 2
    return winding > 0


@inlined
def _sample(a: ObbTree, k: int, column: int, pose: Floats, other: Floats) -> Vector:
    """Return a sample of a body at one pose in the coordinates of a body at another."""
    px, py, pz = a.samples[k, column], a.samples[k, column + 1], a.samples[k, column + 2]
    x = pose[0] * px + pose[1] * py + pose[2] * pz + pose[3] - other[3]
    y = pose[4] * px + pose[5] * py + pose[6] * pz + pose[7] - other[7]
    z = pose[8] * px + pose[9] * py + pose[10] * pz + pose[11] - other[11]
    return to_part(other, x, y, z)


@kernel
def count_inside(a: ObbTree, pose_a: Floats, b: ObbTree, pose_b: Floats, column: int, stack: Stack) -> int:
    """Return how many samples of the first body are inside the second.

    Parameters
    ----------
    a, b
        Trees of the bodies.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    column
        `ON_SURFACE` or `IN_SOLID`: which sample of each component.
    stack
        Work arrays for the depth of both trees.
    """
    count = 0
    for k in range(a.samples.shape[0]):
        count += contains_point(b, _sample(a, k, column, pose_a, pose_b), stack)
    return count


@kernel
def solids_collide(
    a: ObbTree, pose_a: Floats, b: ObbTree, pose_b: Floats, margin: float, stack: Stack
) -> bool:
    """Return whether two solids intersect or are closer than a margin; one that contains the other intersects it.

    Parameters
    ----------
    a, b
        Trees of the bodies.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    margin
        mm, at least 0; see `surfaces_collide`.
    stack
        Work arrays for the depth of both trees.
    """
    if surfaces_collide(a, pose_a, b, pose_b, margin, stack):
        return True
    if count_inside(a, pose_a, b, pose_b, IN_SOLID, stack) > 0:
        return True
    return count_inside(b, pose_b, a, pose_a, IN_SOLID, stack) > 0


@kernel
def is_inside(a: ObbTree, pose_a: Floats, b: ObbTree, pose_b: Floats, stack: Stack) -> bool:
    """Return whether the first body is inside the second; where it touches faces from inside, it may count either way.

    Parameters
    ----------
    a, b
        Trees of the bodies.
    pose_a, pose_b
        ``(12,)``: the rows of the ``(3, 4)`` matrix of each rigid motion.
    stack
        Work arrays for the depth of both trees.
    """
    if surfaces_collide(a, pose_a, b, pose_b, 0.0, stack):
        return False
    if count_inside(a, pose_a, b, pose_b, IN_SOLID, stack) < a.samples.shape[0]:
        return False
    return count_inside(b, pose_b, a, pose_a, ON_SURFACE, stack) == 0
