"""Split triangles at points on their edges, so that a mesh has no T-junctions."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.merging.nonmanifold_edges import bisect_triangles
from amprep.geometry.merging.voxel_contents import RESOLUTION
from amprep.geometry.meshes.topology import degenerate


def split_at_points(triangles: Int64s, splits: Int64s, count: int) -> Int64s:
    """Split triangles whose edges are known to pass through a point.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    splits
        ``(r, 3)``: two ends of an edge, and the point that the edge passes through.
    count
        Number of points.
    """
    if not len(splits):
        return triangles
    ends = np.sort(splits[:, :2], axis=1)
    key, first = np.unique(ends[:, 0] * count + ends[:, 1], return_index=True)
    through = splits[first, 2]
    candidate = np.zeros(count, np.bool_)
    candidate[splits[:, :2]] = True

    def middle(start: Int64s, end: Int64s) -> Int64s:
        wanted = np.minimum(start, end) * count + np.maximum(start, end)
        at = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
        return np.where(key[at] == wanted, through[at], -1)

    return _bisect_repeatedly(triangles, candidate, middle)


def split_on_grid_lines(triangles: Int64s, shared: Int64s, first: int) -> Int64s:
    """Split triangles whose edges run along a line of the grid at all used points of that line.

    Up to four voxels meet in such a line, and an interface knows only the points of two of them.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    shared
        ``(s, 3)`` lattice points; corner `first` + k is point k.
    first
        Number of inner points, which come before the shared ones.
    """
    used = np.zeros(len(shared), np.bool_)
    used[triangles[triangles >= first] - first] = True
    on_plane = shared % RESOLUTION == 0
    for axis in range(3):
        others = [(axis + 1) % 3, (axis + 2) % 3]
        here = np.flatnonzero(used & on_plane[:, others].all(axis=1))
        order = here[np.lexsort((shared[here, axis], *shared[here][:, others].T))]
        if len(order):
            starts = (shared[order[1:]][:, others] != shared[order[:-1]][:, others]).any(axis=1)
            triangles = _split_along(triangles, len(shared), order, starts, first)
    return triangles


def _split_along(triangles: Int64s, count: int, order: Int64s, starts: Bools, first: int) -> Int64s:
    """Split triangles along the grid lines of one axis.

    Parameters
    ----------
    count
        Number of shared points.
    order
        Points on the lines, sorted by line and then along it.
    starts
        Whether a new line begins between two consecutive points of `order`.
    first
        Number of inner points.
    """
    rank, line = np.full(count, -1), np.full(count, -1)
    rank[order] = np.arange(len(order))
    line[order] = np.cumsum(np.concatenate([[0], starts]))

    def middle(start: Int64s, end: Int64s) -> Int64s:
        outer = np.minimum(start, end) >= first
        start, end = np.maximum(start - first, 0), np.maximum(end - first, 0)
        between = np.abs(rank[start] - rank[end]) > 1
        along = outer & (line[start] == line[end]) & (line[start] >= 0) & between
        half = (rank[start] + rank[end]) // 2
        return np.where(along, first + order[np.where(along, half, 0)], -1)

    candidate = np.concatenate([np.zeros(first, np.bool_), line >= 0])
    return _bisect_repeatedly(triangles, candidate, middle)


def _bisect_repeatedly(
    triangles: Int64s, candidate: Bools, middle: Callable[[Int64s, Int64s], Int64s]
) -> Int64s:
    """Split triangles at points on their edges, and the results again, until no edge has such a point.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    candidate
        Points at which an edge that is to be split can end; triangles with fewer than two are skipped quickly.
    middle
        Returns a point on each edge from start to end, or -1.
    """
    done = []
    while len(triangles):
        likely = candidate[triangles].sum(axis=1) > 1
        done.append(triangles[~likely])
        triangles = triangles[likely]
        middles = np.column_stack(
            [middle(triangles[:, a], triangles[:, b]) for a, b in ((0, 1), (1, 2), (2, 0))]
        )
        open_ = (middles >= 0).any(axis=1)
        done.append(triangles[~open_])
        triangles = bisect_triangles(triangles[open_], middles[open_])
        triangles = triangles[~degenerate(triangles)]  # an edge may pass through the third corner of a sliver
    return np.concatenate([*done, triangles])
