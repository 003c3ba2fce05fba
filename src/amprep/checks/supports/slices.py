"""Cut closed meshes by horizontal planes into contours, and tell which contours of neighbouring planes are connected.

Strategy. A triangle meets each plane between its lowest and its highest corner in a segment, and two triangles with a
common edge have segments with a common end wherever the edge meets the plane. So the contours of all planes are the
components of one graph: its nodes are pairs of a triangle and a plane, its links pairs of an edge and a plane. The
pieces of surface between consecutive planes are the components of the same graph with slabs instead of planes. No
polygon is computed. 100,000 pairs take about 0.1 s.
"""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.topology import merge_equal_vertices
from amprep.model.mesh import Mesh

_DIRECTIONS, _FINEST = 16, 0.01
"""Number of horizontal directions in which widths are measured, and the step (radians) at which the best is refined."""


@dataclass(frozen=True, eq=False)
class Slices:
    """The contours in which horizontal planes cut a closed mesh.

    Attributes
    ----------
    heights
        ``(k,)`` mm, ascending.
    plane
        ``(c,)`` plane of each contour.
    area
        ``(c,)`` mm2, signed: positive for outer contours, negative for holes.
    width
        ``(c,)`` mm, least width of the convex hull.
    points, first
        ``(n, 2)`` mm, points of all contours, those of contour c from ``first[c]`` up to ``first[c + 1]``.
    above
        ``(c,)`` outer contour above, where the surface up to the next plane connects exactly one outer contour with
        exactly one above; else -1.
    """

    heights: Floats
    plane: Int64s
    area: Floats
    width: Floats
    points: Floats
    first: Int64s
    above: Int64s

    def points_of(self, contour: int) -> Floats:
        """Return the points of a contour, ``(n, 3)`` mm."""
        own = self.points[self.first[contour] : self.first[contour + 1]]
        return np.hstack([own, np.full((len(own), 1), self.heights[self.plane[contour]])])


def slices_of(mesh: Mesh, heights: Floats) -> Slices:
    """Cut a closed mesh by horizontal planes.

    Parameters
    ----------
    mesh
        Outward oriented.
    heights
        ``(k,)`` mm, ascending.
    """
    points, triangles = merge_equal_vertices(mesh.vertices, mesh.triangles)
    triangles = triangles.astype(np.int64)
    edge = _edges(triangles, len(points))
    z = points[triangles, 2]
    low, high = z.min(axis=1), z.max(axis=1)
    first = np.searchsorted(heights, low, side="right")
    last = np.searchsorted(heights, high, side="right")
    triangle, plane = _repeated(first, last - first)
    is_above = z[triangle] >= heights[plane][:, None]
    crosses = is_above != np.roll(is_above, -1, axis=1)
    contour = _linked(edge[triangle], plane, crosses, len(heights))
    order = np.argsort(contour, kind="stable")
    starts = np.searchsorted(contour[order], np.arange(int(contour.max(initial=-1)) + 2))
    down, up = _segments(points[triangles[triangle[order]]], is_above[order], heights[plane[order]])
    area = (
        np.add.reduceat(down[:, 0] * up[:, 1] - down[:, 1] * up[:, 0], starts[:-1]) / 2.0
        if len(order)
        else up[:, 0]
    )
    own_plane = plane[order[starts[:-1]]]
    slabs = _slabs(edge, z, heights, np.maximum(first - 1, 0), np.minimum(last, len(heights) - 1))
    above = _above(slabs, triangle, plane, contour, area > 0.0, len(heights))
    return Slices(heights, own_plane, area, _widths(down, starts[:-1]), down, starts, above)


def _edges(triangles: Int64s, count: int) -> Int64s:
    """Number the edges of triangles, ``(m, 3)``: from each corner to the next."""
    following = np.roll(triangles, -1, axis=1)
    key = np.minimum(triangles, following) * count + np.maximum(triangles, following)
    return np.unique(key, return_inverse=True)[1].reshape(-1, 3)


def _repeated(first: Int64s, count: Int64s) -> tuple[Int64s, Int64s]:
    """Return pairs of each index and the `count` numbers from `first` on."""
    count = np.maximum(count, 0)
    own = np.repeat(np.arange(len(count)), count)
    return own, first[own] + np.arange(len(own)) - (np.cumsum(count) - count)[own]


def _linked(edge: Int64s, level: Int64s, links: Bools, levels: int) -> Int64s:
    """Label rows; rows with a linking edge in common, at the same level, have the same label.

    Parameters
    ----------
    edge, links
        ``(r, 3)`` edges of each row, and which of them link.
    level
        ``(r,)``.
    levels
        Number of levels.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    row, side = np.nonzero(links)
    key = edge[row, side] * levels + level[row]
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    one, other = row[order[same]], row[order[same + 1]]
    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(len(edge), len(edge)))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def _segments(corners: Floats, is_above: Bools, heights: Floats) -> tuple[Floats, Floats]:
    """Return both ends ``(r, 2)`` of the segments in which planes cut triangles, the inside to their left."""
    rows, following = np.arange(len(corners)), np.roll(is_above, -1, axis=1)
    ends = []
    for crossing in (is_above & ~following, ~is_above & following):
        side = crossing.argmax(axis=1)
        start, end = corners[rows, side], corners[rows, (side + 1) % 3]
        fraction = (heights - start[:, 2]) / (end[:, 2] - start[:, 2])
        ends.append(start[:, :2] + fraction[:, None] * (end - start)[:, :2])
    return ends[0], ends[1]


def _widths(points: Floats, starts: Int64s) -> Floats:
    """Return the least width of the convex hull of each run of points, mm."""
    widths, best = np.full(len(starts), np.inf), np.zeros(len(starts))
    if not len(starts):
        return widths
    owner = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(points))))

    def measure(angles: Floats) -> None:
        along = points[:, 0] * np.cos(angles)[owner] + points[:, 1] * np.sin(angles)[owner]
        extent = np.maximum.reduceat(along, starts) - np.minimum.reduceat(along, starts)
        best[:] = np.where(extent < widths, angles, best)
        np.minimum(widths, extent, out=widths)

    step = np.pi / _DIRECTIONS
    for number in range(_DIRECTIONS):
        measure(np.full(len(starts), number * step))
    while step > _FINEST:
        step /= 2.0
        around = best.copy()
        measure(around - step)
        measure(around + step)
    return widths


@dataclass(frozen=True, eq=False)
class _Slabs:
    """Pairs of a triangle and a slab, sorted by their key, with the component of surface that each belongs to."""

    key: Int64s
    component: Int64s
    levels: int

    def component_of(self, triangle: Int64s, slab: Int64s) -> Int64s:
        """Return the component of the part of each triangle in a slab."""
        return self.component[np.searchsorted(self.key, triangle * self.levels + slab)]


def _slabs(edge: Int64s, z: Floats, heights: Floats, first: Int64s, last: Int64s) -> _Slabs:
    """Return the components of surface in each slab between consecutive planes."""
    triangle, slab = _repeated(first, last - first)
    below, above = z[triangle] < heights[slab + 1][:, None], z[triangle] >= heights[slab][:, None]
    links = (below | np.roll(below, -1, axis=1)) & (above | np.roll(above, -1, axis=1))
    component = _linked(edge[triangle], slab, links, len(heights))
    return _Slabs(triangle * len(heights) + slab, component, len(heights))


def _above(
    slabs: _Slabs, triangle: Int64s, plane: Int64s, contour: Int64s, is_outer: Bools, levels: int
) -> Int64s:
    """Return the contour above each outer contour, -1 unless exactly one is above exactly one."""
    count = len(is_outer)
    above = np.full(count, -1)
    if not count or levels < 2:
        return above
    ends = []
    for step, rows in ((0, plane < levels - 1), (-1, plane > 0)):
        chosen = np.flatnonzero(rows & is_outer[contour])
        _, once = np.unique(contour[chosen], return_index=True)
        own = chosen[once]
        ends.append((contour[own], slabs.component_of(triangle[own], plane[own] + step)))
    (lower, lower_slab), (upper, upper_slab) = ends
    size = int(slabs.component.max()) + 1
    alone = (np.bincount(lower_slab, minlength=size) == 1) & (np.bincount(upper_slab, minlength=size) == 1)
    upper_of = np.full(size, -1)
    upper_of[upper_slab] = upper
    chosen = alone[lower_slab]
    above[lower[chosen]] = upper_of[lower_slab[chosen]]
    return above
