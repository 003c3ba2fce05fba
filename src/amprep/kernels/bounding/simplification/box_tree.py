"""A tree of boxes over triangles that move: found by box, refitted after each change."""

from typing import NamedTuple

from amprep.arrays import Floats, Int32s
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface
from amprep.kernels.bounding.simplification.points import kernel, part

EMPTY = 1e150
"""Least coordinate of an empty box, the negative of its greatest; its square is finite."""


class MovingBoxTree(NamedTuple):
    """A complete binary tree; the children of node i are ``2 i`` and ``2 i + 1``, the root is node 1.

    Attributes
    ----------
    lo, hi
        ``(2 s, 3)`` corners of the box of each node; empty boxes have ``lo > hi``. Nodes from s on are leaves.
    leaf
        ``(m,)`` leaf of each triangle.
    triangle
        ``(s,)`` triangle of each leaf, counted from the first one; -1 for none.
    stack
        ``(64,)`` work array.
    """

    lo: Floats
    hi: Floats
    leaf: Int32s
    triangle: Int32s
    stack: Int32s


@part
def _set_leaf(tree: MovingBoxTree, surface: HalfEdgeSurface, triangle: int) -> int:
    """Set the box of the leaf of a triangle, an empty one if the triangle is gone; return the leaf."""
    node, first = tree.leaf[triangle], 3 * triangle
    for axis in range(3):
        if surface.start[first] < 0:
            tree.lo[node, axis], tree.hi[node, axis] = EMPTY, -EMPTY
            continue
        a = surface.points[surface.start[first], axis]
        b = surface.points[surface.start[first + 1], axis]
        c = surface.points[surface.start[first + 2], axis]
        tree.lo[node, axis], tree.hi[node, axis] = min(a, b, c), max(a, b, c)
    return int(node)


@part
def _enclose(tree: MovingBoxTree, node: int) -> bool:
    """Set the box of a node to that of its children; return whether it has changed."""
    changed = False
    for axis in range(3):
        least = min(tree.lo[2 * node, axis], tree.lo[2 * node + 1, axis])
        most = max(tree.hi[2 * node, axis], tree.hi[2 * node + 1, axis])
        changed |= least != tree.lo[node, axis] or most != tree.hi[node, axis]
        tree.lo[node, axis], tree.hi[node, axis] = least, most
    return changed


@part
def refit(tree: MovingBoxTree, surface: HalfEdgeSurface, triangle: int) -> None:
    """Update the boxes above a triangle that has moved or is gone."""
    node = _set_leaf(tree, surface, triangle) >> 1
    while node > 0 and _enclose(tree, node):
        node >>= 1


@kernel
def fill_tree(tree: MovingBoxTree, surface: HalfEdgeSurface) -> None:
    """Set the boxes of all nodes."""
    for triangle in range(tree.leaf.size):
        _set_leaf(tree, surface, triangle)
    for node in range(tree.triangle.size - 1, 0, -1):
        _enclose(tree, node)


@part
def find_boxes(tree: MovingBoxTree, lo: Floats, hi: Floats, found: Int32s) -> int:
    """Write the triangles whose boxes meet a box into `found`; return their number, -1 if there are too many."""
    count, top, leaves = 0, 1, tree.triangle.size
    tree.stack[0] = 1
    while top > 0:
        top -= 1
        node = tree.stack[top]
        if (
            tree.lo[node, 0] > hi[0]
            or tree.hi[node, 0] < lo[0]
            or tree.lo[node, 1] > hi[1]
            or tree.hi[node, 1] < lo[1]
            or tree.lo[node, 2] > hi[2]
            or tree.hi[node, 2] < lo[2]
        ):
            continue
        if node >= leaves:
            if count == found.size:
                return -1
            found[count] = tree.triangle[node - leaves]
            count += 1
        else:
            tree.stack[top] = 2 * node
            tree.stack[top + 1] = 2 * node + 1
            top += 2
    return count
