"""Trees of boxes over the triangles of a surface."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.bounding.simplification.box_tree import EMPTY, MovingBoxTree
from amprep.kernels.bounding.simplification.half_edges import HalfEdgeSurface

_BITS = 20
"""Bits of each coordinate of a Morton code."""


def make_tree(surface: HalfEdgeSurface) -> MovingBoxTree:
    """Return a tree over the triangles of a surface, which are sorted along a Z-order curve (Morton 1966)."""
    from amprep.kernels.bounding.simplification.box_tree import fill_tree

    count = len(surface.start) // 3
    leaves = 1 << max(count - 1, 1).bit_length()
    order = np.argsort(
        morton_codes(surface.points[surface.start].reshape(-1, 3, 3).mean(axis=1)), kind="stable"
    )
    leaf, triangle = np.empty(count, np.int32), np.full(leaves, -1, np.int32)
    leaf[order] = leaves + np.arange(count)
    triangle[:count] = order
    lo, hi = np.full((2 * leaves, 3), EMPTY), np.full((2 * leaves, 3), -EMPTY)
    tree = MovingBoxTree(lo, hi, leaf, triangle, np.empty(64, np.int32))
    fill_tree(tree, surface)
    return tree


def morton_codes(points: Floats) -> Int64s:
    """Return the place of each point ``(n, 3)`` on a Z-order curve through their enclosing box."""
    lo, hi = points.min(axis=0), points.max(axis=0)
    scale = (2**_BITS - 1) / max(float((hi - lo).max()), 1e-300)
    cells = ((points - lo) * scale).astype(np.int64)
    code = np.zeros(len(points), np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code
