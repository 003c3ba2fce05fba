"""Records that the kernels on OBB trees share: the tree, its work array, and rigid motions."""

from typing import NamedTuple

from amprep.arrays import Floats, Int32s, Int64s
from amprep.kernels.helper import inlined

CENTRE, HALF, AXES, RADIUS = 0, 3, 6, 15
"""First columns of a node: centre, half lengths, three unit axes as rows, and radius of the enclosing sphere."""

NODE_WIDTH = 16

TOUCH = 1e-7
"""mm; surfaces that enter one another by at most this much only touch."""

Frame = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
"""The ``(3, 4)`` rows of a rigid motion as a tuple, which numba keeps in registers."""

Vector = tuple[float, float, float]

Triangle = tuple[float, float, float, float, float, float, float, float, float]
"""The corners of a triangle, x y z each."""


class ObbTree(NamedTuple):
    """A tree of oriented bounding boxes of the triangles of a closed mesh (Gottschalk, Lin, Manocha 1996), mm.

    The children of node i are ``link[i]`` and ``link[i] + 1``. The leaves have one triangle each.

    Attributes
    ----------
    nodes
        ``(2 n - 1, 16)``: centre, half lengths, three unit axes as rows, radius.
    link
        ``(2 n - 1,)`` int32: the first child of an inner node; of a leaf, -1 minus its triangle.
    cones
        ``(2 n - 1, 4)``, cones of the normals below each node; see `write_cones`.
    corners
        ``(n, 9)``, triangles in the order of the leaves, outward oriented.
    normals
        ``(n, 3)``, outward unit normals; 0 for triangles without area.
    order
        ``(n,)`` int64, their numbers in the mesh.
    samples
        ``(k, 6)``: for each component of the surface a point on it, and one inside the solid below that.
    hull
        ``(h, 3)``, the vertices of the convex hull.
    depth
        Greatest number of nodes above a leaf.
    """

    nodes: Floats
    link: Int32s
    cones: Floats
    corners: Floats
    normals: Floats
    order: Int64s
    samples: Floats
    hull: Floats
    depth: int


class Stack(NamedTuple):
    """Work arrays of a traversal of two trees; see `amprep.geometry.trees.stacks.new_stack`.

    Attributes
    ----------
    pairs
        ``(k, 2)`` int32, pairs of nodes that are still to be visited.
    bounds
        ``(k,)``, lower bounds of the pairs.
    sides
        ``(18,)``, work array of the test of two triangles.
    """

    pairs: Int32s
    bounds: Floats
    sides: Floats


@inlined
def relative(pose: Floats, other: Floats) -> Frame:
    """Return the motion that takes coordinates of a body at `pose` to coordinates of a body at `other`."""
    dx, dy, dz = pose[3] - other[3], pose[7] - other[7], pose[11] - other[11]
    return (
        other[0] * pose[0] + other[4] * pose[4] + other[8] * pose[8],
        other[0] * pose[1] + other[4] * pose[5] + other[8] * pose[9],
        other[0] * pose[2] + other[4] * pose[6] + other[8] * pose[10],
        other[0] * dx + other[4] * dy + other[8] * dz,
        other[1] * pose[0] + other[5] * pose[4] + other[9] * pose[8],
        other[1] * pose[1] + other[5] * pose[5] + other[9] * pose[9],
        other[1] * pose[2] + other[5] * pose[6] + other[9] * pose[10],
        other[1] * dx + other[5] * dy + other[9] * dz,
        other[2] * pose[0] + other[6] * pose[4] + other[10] * pose[8],
        other[2] * pose[1] + other[6] * pose[5] + other[10] * pose[9],
        other[2] * pose[2] + other[6] * pose[6] + other[10] * pose[10],
        other[2] * dx + other[6] * dy + other[10] * dz,
    )


@inlined
def to_part(pose: Floats, x: float, y: float, z: float) -> Vector:
    """Return a direction in the coordinates of a body at `pose`."""
    return (
        pose[0] * x + pose[4] * y + pose[8] * z,
        pose[1] * x + pose[5] * y + pose[9] * z,
        pose[2] * x + pose[6] * y + pose[10] * z,
    )


@inlined
def turned(frame: Frame, x: float, y: float, z: float) -> Vector:
    """Return a direction after a motion."""
    return (
        frame[0] * x + frame[1] * y + frame[2] * z,
        frame[4] * x + frame[5] * y + frame[6] * z,
        frame[8] * x + frame[9] * y + frame[10] * z,
    )


@inlined
def moved(frame: Frame, x: float, y: float, z: float) -> Vector:
    """Return a point after a motion."""
    return (
        frame[0] * x + frame[1] * y + frame[2] * z + frame[3],
        frame[4] * x + frame[5] * y + frame[6] * z + frame[7],
        frame[8] * x + frame[9] * y + frame[10] * z + frame[11],
    )


@inlined
def triangle_of(tree: ObbTree, t: int) -> Triangle:
    """Return a triangle in part coordinates."""
    c = tree.corners
    return (c[t, 0], c[t, 1], c[t, 2], c[t, 3], c[t, 4], c[t, 5], c[t, 6], c[t, 7], c[t, 8])


@inlined
def moved_triangle(frame: Frame, tree: ObbTree, t: int) -> Triangle:
    """Return a triangle after a motion."""
    c = tree.corners
    ax, ay, az = moved(frame, c[t, 0], c[t, 1], c[t, 2])
    bx, by, bz = moved(frame, c[t, 3], c[t, 4], c[t, 5])
    cx, cy, cz = moved(frame, c[t, 6], c[t, 7], c[t, 8])
    return (ax, ay, az, bx, by, bz, cx, cy, cz)


@inlined
def corners_along(triangle: Triangle, x: Vector, y: Vector, z: Vector) -> Triangle:
    """Return the corners along three directions."""
    ax, ay, az, bx, by, bz, cx, cy, cz = triangle
    return (
        x[0] * ax + x[1] * ay + x[2] * az,
        y[0] * ax + y[1] * ay + y[2] * az,
        z[0] * ax + z[1] * ay + z[2] * az,
        x[0] * bx + x[1] * by + x[2] * bz,
        y[0] * bx + y[1] * by + y[2] * bz,
        z[0] * bx + z[1] * by + z[2] * bz,
        x[0] * cx + x[1] * cy + x[2] * cz,
        y[0] * cx + y[1] * cy + y[2] * cz,
        z[0] * cx + z[1] * cy + z[2] * cz,
    )


@inlined
def push_nearer_last(
    stack: Stack,
    waiting: int,
    best: float,
    near: float,
    near_a: int,
    near_b: int,
    far: float,
    far_a: int,
    far_b: int,
) -> int:
    """Push two pairs of nodes whose bounds are below the best one, the nearer one on top; return the new number.

    Parameters
    ----------
    waiting
        Number of pairs on the stack.
    best
        Least value so far; pairs whose bound is no less are dropped.
    near, far
        Bounds of the pairs, in any order.
    """
    if far < near:
        near, near_a, near_b, far, far_a, far_b = far, far_a, far_b, near, near_a, near_b
    if far < best:
        stack.pairs[waiting, 0], stack.pairs[waiting, 1], stack.bounds[waiting] = far_a, far_b, far
        waiting += 1
    if near < best:
        stack.pairs[waiting, 0], stack.pairs[waiting, 1], stack.bounds[waiting] = near_a, near_b, near
        waiting += 1
    return waiting
