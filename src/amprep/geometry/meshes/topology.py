"""Mesh clean-up and edge queries: equal vertices, degenerate and repeated triangles, open edges."""

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s

_LEAST_HASHED = 20_000
"""Rows from which hashing is faster than sorting; both find the same."""


def first_of_equal_rows(rows: NDArray[np.generic]) -> Int64s:
    """Return for each row of an array ``(n, k)`` the index of the first equal row, ``(n,)``."""
    if len(rows) == 0:
        return np.empty(0, np.int64)
    if len(rows) >= _LEAST_HASHED and rows.dtype.itemsize == 8:
        from amprep.kernels.meshes.equal_rows import first_of_equal

        first = np.empty(len(rows), np.int64)
        same_zeros = np.add(rows, rows.dtype.type(0))  # -0.0 becomes 0.0
        if first_of_equal(np.ascontiguousarray(same_zeros).view(np.uint64), first):
            return first
    order = np.lexsort(rows.T)  # stable, so equal rows keep their order
    ordered = rows[order]
    starts = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    first = np.empty(len(rows), np.int64)
    first[order] = order[starts][np.cumsum(starts) - 1]
    return first


def merge_equal_vertices(vertices: Floats, triangles: Int64s) -> tuple[Floats, Int64s]:
    """Merge vertices with equal coordinates and drop unused ones; the order is kept.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` finite coordinates, and ``(m, 3)`` indices in range.

    Returns
    -------
    vertices, triangles
        Different vertices, and as many triangles as before.
    """
    return drop_unused_vertices(vertices, first_of_equal_rows(vertices)[triangles])


def drop_unused_vertices(vertices: Floats, triangles: Int64s) -> tuple[Floats, Int64s]:
    """Drop vertices that no triangle uses; the order is kept."""
    used = np.zeros(len(vertices), np.bool_)
    used[triangles] = True
    return vertices[used], (np.cumsum(used) - 1)[triangles]


def degenerate(triangles: Int64s) -> Bools:
    """Tell which triangles use a vertex twice, ``(m,)``."""
    following = np.roll(triangles, -1, axis=1)
    return np.asarray((triangles == following).any(axis=1))


def repeated(triangles: Int64s) -> Bools:
    """Tell which triangles repeat an earlier one with the same orientation, ``(m,)``."""
    lowest = triangles.argmin(axis=1)[:, None]
    turned = np.take_along_axis(triangles, (lowest + np.arange(3)) % 3, axis=1)
    return np.asarray(first_of_equal_rows(turned) != np.arange(len(triangles)))


def count_edges(triangles: Int64s) -> tuple[Int64s, Int64s, Int64s]:
    """Count the triangles at each edge.

    Returns
    -------
    edges
        ``(e, 2)`` vertex indices, the lower first.
    uses
        ``(e,)`` number of triangles at the edge.
    balance
        ``(e,)`` number of triangles that traverse the edge from the lower to the higher vertex, minus the others; 0
        where they match.
    """
    triangles = triangles.astype(np.int64, copy=False)
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    base = int(triangles.max(initial=0)) + 1
    keys, which = np.unique(low * base + high, return_inverse=True)
    balance = np.bincount(which, np.where(start == low, 1.0, -1.0), len(keys))
    return np.stack(np.divmod(keys, base), axis=1), np.bincount(which), balance.astype(np.int64)


def edges_match(triangles: Int64s) -> bool:
    """Tell whether every edge is traversed equally often in both directions."""
    triangles = triangles.astype(np.int64, copy=False)
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    base = int(triangles.max(initial=0)) + 1
    there, back = start < end, start > end
    forward, backward = (start * base + end)[there], (end * base + start)[back]
    return len(forward) == len(backward) and bool((np.sort(forward) == np.sort(backward)).all())


def open_vertices(triangles: Int64s) -> Int64s:
    """Return the vertices of edges whose triangles do not match, ``(k,)`` in ascending order."""
    edges, _, balance = count_edges(triangles)
    return np.unique(edges[balance != 0])


def join_near(vertices: Floats, chosen: Int64s, tolerance: float) -> Int64s:
    """Join chosen vertices within a tolerance, directly or through chains of others.

    Nothing is joined if on average more than twenty others are within the tolerance: that is not a seam.

    Parameters
    ----------
    vertices
        ``(n, 3)`` mm.
    chosen
        ``(k,)`` indices of the vertices to join.
    tolerance
        Largest distance, mm.

    Returns
    -------
    source
        ``(n,)`` lowest vertex to which each vertex is joined; itself if there is none.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    source = np.arange(len(vertices))
    if len(chosen) == 0:
        return source
    tree = cKDTree(vertices[chosen])
    if tree.count_neighbors(tree, tolerance) > 21 * len(chosen):
        return source
    near = tree.query_pairs(tolerance, output_type="ndarray")
    graph = coo_array((np.ones(len(near), np.int8), (near[:, 0], near[:, 1])), shape=(len(chosen),) * 2)
    _, label = connected_components(graph, directed=False)
    source[chosen] = chosen[np.unique(label, return_index=True)[1][label]]
    return source
