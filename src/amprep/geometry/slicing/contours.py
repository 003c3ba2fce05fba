"""Cut a mesh by many horizontal planes at once, into closed contours."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s, Ints
from amprep.geometry.meshes.topology import merge_equal_vertices

if TYPE_CHECKING:
    from manifold3d import CrossSection


@dataclass(frozen=True, eq=False)
class PlaneContours:
    """The contours in which horizontal planes cut a mesh, the inside to their left.

    Attributes
    ----------
    heights
        ``(k,)`` mm, ascending.
    plane, triangle
        ``(c,)`` plane of each contour, and a triangle of the linked mesh that it crosses.
    area
        ``(c,)`` mm2, signed: positive for outer contours, negative for holes.
    points, first
        ``(n, 2)`` mm, points of all contours, those of contour c from ``first[c]`` up to ``first[c + 1]``.
    """

    heights: Floats
    plane: Int64s
    triangle: Int64s
    area: Floats
    points: Floats
    first: Int64s

    def points_of(self, contour: int) -> Floats:
        """Return the points of a contour, ``(n, 2)`` mm."""
        return self.points[self.first[contour] : self.first[contour + 1]]

    def region_of(self, contours: Int64s) -> "CrossSection":
        """Return the region that some contours of one plane enclose."""
        from manifold3d import CrossSection, FillRule

        return CrossSection([self.points_of(each) for each in contours.tolist()], FillRule.Positive)


class SlicedMesh:
    """A mesh whose triangles know their neighbours, so that it can be cut again and again.

    Where bodies touch along an edge only, four triangles share it; those that bound one body
    are neighbours, so the contours of the bodies are apart.

    Parameters
    ----------
    vertices, triangles
        The mesh, ``(n, 3)`` mm, finite, and ``(m, 3)``, outward oriented. Contours end at open edges.
    merge
        Whether equal vertices are merged first.
    """

    def __init__(self, vertices: Floats, triangles: Ints, *, merge: bool = True) -> None:
        from amprep.kernels.slicing.contours import LinkedTriangles
        from amprep.kernels.slicing.edges import order_edges, pair_edges

        points, corners = vertices, np.asarray(triangles, np.int64)
        if merge:
            points, corners = merge_equal_vertices(points, corners)
        points, corners = np.ascontiguousarray(points).view(), np.ascontiguousarray(corners)
        points.flags.writeable = (
            False  # arrays that may be written to are another type, for which all is compiled again
        )
        order, twin = np.empty(corners.size, np.int64), np.empty(corners.size, np.int64)
        order_edges(corners, np.empty(len(points) + 1, np.int64), twin, order)
        if pair_edges(corners, order, twin):
            _pair_nonmanifold(points, corners, order, twin)
        self.linked = LinkedTriangles(points, corners, twin)

    def contours(self, heights: Floats) -> PlaneContours:
        """Cut the mesh by planes at ascending heights, ``(k,)`` mm. A vertex at a plane counts as above it."""
        from amprep.kernels.slicing.contours import trace_contours

        return self._traced(heights, trace_contours, 1)

    def lines(self, heights: Floats) -> PlaneContours:
        """Cut a surface by planes at ascending heights, whichever way its triangles face; areas are 0.

        The last point of a closed line is its first one.
        """
        from amprep.kernels.slicing.lines import trace_lines

        return self._traced(heights, trace_lines, 2)

    def _traced(self, heights: Floats, trace: Callable[..., int], points_per_row: int) -> PlaneContours:
        """Return what a kernel traces at ascending heights, with its most points for each row."""
        from amprep.kernels.slicing.contours import LevelRows, TracedContours

        level, low, high = self.levels(heights)
        count = high - low
        size = int(count.sum())
        plane, triangle = np.empty(size, np.int64), np.empty(size, np.int64)
        found = TracedContours(
            np.empty((points_per_row * size, 2)),
            np.empty(size + 1, np.int64),
            plane,
            triangle,
            np.empty(size),
        )
        rows = LevelRows(low + 1, np.cumsum(count) - count)
        number = trace(
            self.linked, np.asarray(heights, np.float64), level, rows, np.zeros(size, np.bool_), found
        )
        first = found.first[: number + 1].copy()
        return PlaneContours(
            heights,
            plane[:number].copy(),
            triangle[:number].copy(),
            found.area[:number].copy(),
            found.points,
            first,
        )

    def slabs(self, contours: PlaneContours) -> tuple[Int64s, Int64s]:
        """Return the pieces of surface below and above each contour, up to the next planes, ``(c,)``; -1 for none.

        Contours with the same piece are connected between the planes.
        """
        from amprep.kernels.slicing.contours import LevelRows, join_slabs

        slabs = len(contours.heights) - 1
        level, low, high = self.levels(contours.heights)
        first = np.maximum(low, 0)
        count = np.maximum(np.minimum(high, slabs - 1) - first + 1, 0)
        rows = LevelRows(first, np.cumsum(count) - count)
        piece = np.arange(int(count.sum()))
        join_slabs(self.linked, level, slabs, rows, piece)
        below, above = (np.full(len(contours.plane), -1) for _ in range(2))
        for found, step, has in ((below, -1, contours.plane > 0), (above, 0, contours.plane < slabs)):
            triangle = contours.triangle[has]
            found[has] = piece[rows.start[triangle] + contours.plane[has] + step - first[triangle]]
        return below, above

    def levels(self, heights: Floats) -> tuple[Int64s, Int64s, Int64s]:
        """Return the highest plane at or below each vertex, and the lowest and highest of them for each triangle."""
        level = np.searchsorted(heights, self.linked.points[:, 2], side="right") - 1
        corners = level[self.linked.triangles]
        low = np.minimum(np.minimum(corners[:, 0], corners[:, 1]), corners[:, 2])
        high = np.maximum(np.maximum(corners[:, 0], corners[:, 1]), corners[:, 2])
        return level, low, high


def _pair_nonmanifold(points: Floats, triangles: Int64s, order: Int64s, twin: Int64s) -> None:
    """Pair the half-edges of edges at which more than two triangles meet, in place.

    The triangles of a pair follow each other around the edge, with the solid between: from one in which the edge leads
    from its higher vertex to its lower one to one in which it leads back. Where solids overlap there, or foils have no
    thickness, pairs enclose others: those that are paired are left out, until none is left.
    """
    nonmanifold = order[twin[order] == -2]
    triangle, corner = np.divmod(nonmanifold, 3)
    start, end, apex = (triangles[triangle, (corner + step) % 3] for step in range(3))
    low, high = np.minimum(start, end), np.maximum(start, end)
    edge = np.cumsum(np.append(0, (np.diff(low) != 0) | (np.diff(high) != 0)))
    turned = np.lexsort((_angles(points[apex], points[low], points[high]), edge))
    nonmanifold, edge, is_back = nonmanifold[turned], edge[turned], (start > end)[turned]
    while len(edge):
        following = _following(edge)
        chosen = np.flatnonzero(is_back & ~is_back[following] & (following != np.arange(len(edge))))
        if not len(chosen):
            break
        one, other = nonmanifold[chosen], nonmanifold[following[chosen]]
        twin[one], twin[other] = other, one
        left = np.ones(len(edge), np.bool_)
        left[chosen] = left[following[chosen]] = False
        nonmanifold, edge, is_back = nonmanifold[left], edge[left], is_back[left]


def _following(edge: Int64s) -> Int64s:
    """Return the row after each one of the same edge, ``(k,)``; after the last comes the first. Rows are in order."""
    begins = np.flatnonzero(np.append(True, np.diff(edge) != 0))
    following = np.arange(1, len(edge) + 1)
    following[np.append(begins[1:], len(edge)) - 1] = begins
    return following


def _angles(points: Floats, low: Floats, high: Floats) -> Floats:
    """Return the angle of each point around its axis from `low` to `high`, counter-clockwise, ``(k,)``."""
    along = high - low
    along /= np.maximum(np.linalg.norm(along, axis=1), np.finfo(np.float64).tiny)[:, None]
    right = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
    from_axis = points - low
    across = np.cross(along, right)
    return np.asarray(
        np.arctan2(np.einsum("ij,ij->i", from_axis, across), np.einsum("ij,ij->i", from_axis, right))
    )
