"""Trees of axis-parallel boxes over triangles: made once per mesh, and fitted to each of its placements."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.meshes.shells import label_shells

if TYPE_CHECKING:
    from amprep.kernels.meshes.distance import PlacedTree

LEAF = 8
"""Greatest number of triangles in a leaf."""

_BITS = 16
"""Binary digits of a coordinate in a Morton code."""

_SPREAD = ((16, 0xFF0000FF), (8, 0xF00F00F00F), (4, 0xC30C30C30C3), (2, 0x249249249249))
"""Shifts and masks that move 16 binary digits to every third place."""


@dataclass(frozen=True, eq=False)
class BoxTree:
    """The triangles of a mesh in the order of the leaves of a tree; copies of a part share one.

    Attributes
    ----------
    vertex_count
        Number of vertices.
    triangles
        ``(m, 3)``, the triangles of the mesh in the order of the leaves.
    starts
        First triangle of each leaf, and m; the number of leaves is a power of 2.
    """

    vertex_count: int
    triangles: Int64s
    starts: Int64s

    @cached_property
    def shell_vertices(self) -> Int64s:
        """One vertex of each connected component of the surface, ``(k,)``."""
        _, label = label_shells(self.triangles, self.vertex_count)
        return np.asarray(self.triangles[np.unique(label, return_index=True)[1], 0])

    def placed(self, vertices: Floats) -> "PlacedTree":
        """Return the tree with the boxes that belong to given positions ``(n, 3)`` of the vertices, mm."""
        from amprep.kernels.meshes.distance import PlacedTree

        corners = vertices[self.triangles]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        lo = np.minimum.reduceat(np.minimum(np.minimum(a, b), c), self.starts[:-1])
        hi = np.maximum.reduceat(np.maximum(np.maximum(a, b), c), self.starts[:-1])
        levels = [np.hstack([lo, hi])]
        while len(levels[-1]) > 1:
            left, right = levels[-1][::2], levels[-1][1::2]
            lo, hi = np.minimum(left[:, :3], right[:, :3]), np.maximum(left[:, 3:], right[:, 3:])
            levels.append(np.hstack([lo, hi]))
        boxes = np.concatenate(levels[::-1])
        return PlacedTree(
            corners.reshape(-1, 9), self.starts, boxes, (boxes[:, 3:] - boxes[:, :3]).sum(axis=1)
        )


def box_tree(vertices: Floats, triangles: Int64s) -> BoxTree:
    """Order the triangles of a mesh along a Morton curve and divide them into leaves of nearly equal numbers.

    Parameters
    ----------
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)`` with m at least 1.
    """
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    order = np.argsort(_morton_codes(a + b + c), kind="stable")
    leaves = 1 << max(int(np.ceil(np.log2(len(triangles) / LEAF))), 0)
    starts = np.arange(leaves + 1, dtype=np.int64) * len(triangles) // leaves
    return BoxTree(len(vertices), np.ascontiguousarray(triangles[order]), starts)


def _morton_codes(points: Floats) -> Int64s:
    """Return the position of points ``(n, 3)`` along a curve that fills their enclosing cube (Morton 1966)."""
    codes = np.zeros(len(points), np.int64)
    low = [float(column.min()) for column in points.T]
    side = max(float(column.max()) - least for column, least in zip(points.T, low, strict=True))
    for axis in range(3):
        scaled = (points[:, axis] - low[axis]) * ((2**_BITS - 1) / max(side, 1e-12))
        codes |= _spread(scaled.astype(np.int64)) << axis
    return codes


def _spread(numbers: Int64s) -> Int64s:
    """Move the binary digits of numbers below 2**16 apart, so that two zeros are between any two."""
    for shift, mask in _SPREAD:
        numbers = (numbers | (numbers << shift)) & mask
    return numbers
