"""Split closed meshes along non-manifold edges, where solids touch, until no edge has more than two triangles."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.meshes.welding import label_equal_rows, round_as_stored

_SAME_ANGLE = 1e-3
"""Largest angle (radians) by which rounding to the precision of a build file turns a face about its edge."""

# Strategy. An edge between two solids that touch has four triangles or more (or an even number in general).
# Around such an edge, solid and void alternate. Each triangle that bounds a solid on one side of the edge is
# therefore paired with the triangle that bounds the same solid on the other side; `_pair_half_edges` finds the
# pairs by sorting the triangles of every edge by angle. The pairs join the triangles around a vertex to fans, and
# every fan gets its own copy of the vertex (`_copy_vertices`). Two fans may still meet in both vertices of an
# edge, where the solids are connected elsewhere; such an edge is bisected once per pair (`_bisect_doubled`), after
# which the halves differ in one vertex. All steps are sorts and one connected-components search over the triangles
# at the affected vertices, so the cost does not depend on the rest of the mesh.


def split_nonmanifold_edges(points: Floats, triangles: Int64s) -> tuple[Floats, Int64s]:
    """Copy vertices until no edge of a closed mesh has more than two triangles.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``, closed and without overlaps. An open mesh is returned unchanged.
    """
    vertices = nonmanifold_vertices(triangles)
    if vertices is None or not len(vertices):
        return points, triangles
    added, triangles = split_vertices(points, triangles, vertices)
    return drop_unused_vertices(np.concatenate([points, added]), triangles)


def nonmanifold_vertices(triangles: Int64s, first: int = 0) -> Int64s | None:
    """Return the vertices of edges with more than two triangles; None if the mesh is open.

    Parameters
    ----------
    triangles
        ``(m, 3)``.
    first
        Edges with a vertex below this number are ignored.
    """
    base = int(triangles.max(initial=0)) + 1
    keys: list[Int64s] = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = triangles[:, a], triangles[:, b]
        counted = (start >= first) & (end >= first)
        # forward edges get keys from 0 on, backward edges negative keys
        keys.append(np.where(start < end, start * base + end, -1 - (end * base + start))[counted])
    key = np.concatenate(keys)
    forward, backward = np.sort(key[key >= 0]), np.sort(-1 - key[key < 0])
    if len(forward) != len(backward) or (forward != backward).any():
        return None
    twice = forward[1:][forward[1:] == forward[:-1]]
    return np.unique(np.concatenate(np.divmod(twice, base)))


def split_vertices(points: Floats, triangles: Int64s, vertices: Int64s) -> tuple[Floats, Int64s]:
    """Copy vertices until no edge at them has more than two triangles.

    manifold3d splits such edges as well, but it occasionally loses a corner of the solid.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``: all triangles at the given vertices, and any others.
    vertices
        ``(k,)`` vertices of non-manifold edges.

    Returns
    -------
    added, triangles
        Vertices to append to `points`, and all triangles; those at the given vertices come last.
    """
    if not len(vertices):
        return points[:0], triangles
    touched = np.zeros(len(points), np.bool_)
    touched[vertices] = True
    around = touched[triangles].any(axis=1)
    near = triangles[around]
    start, end = near.ravel(), np.roll(near, -1, axis=1).ravel()
    ends, edge, _ = _label_edges(start, end)
    first, second = _pair_half_edges(points, near, np.flatnonzero(touched[start] | touched[end]), ends, edge)
    source, near = _copy_vertices(len(points), near, touched, first, second)
    added = points[source]
    middles, near = _bisect_doubled(points, added, near, first, second)
    return np.concatenate([added, middles]), np.concatenate([triangles[~around], near])


def bisect_triangles(triangles: Int64s, middle: Int64s) -> Int64s:
    """Split triangles at vertices on their sides, one side at a time.

    Parameters
    ----------
    triangles, middle
        ``(m, 3)``, and the vertex on each side (0 to 1, 1 to 2, 2 to 0) of each triangle, or -1.
    """
    done = [triangles[(middle < 0).all(axis=1)]]
    remaining = (middle >= 0).any(axis=1)
    triangles, middle = triangles[remaining], middle[remaining]
    while len(triangles):
        turn = ((middle >= 0).argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles, turn, axis=1).T
        m, on_bc, on_ca = np.take_along_axis(middle, turn, axis=1).T
        none = np.full(len(m), -1)
        triangles = np.concatenate([np.column_stack([a, m, c]), np.column_stack([m, b, c])])
        middle = np.concatenate([np.column_stack([none, none, on_ca]), np.column_stack([none, on_bc, none])])
        remaining = (middle >= 0).any(axis=1)
        done.append(triangles[~remaining])
        triangles, middle = triangles[remaining], middle[remaining]
    return np.concatenate(done)


def _label_edges(start: Int64s, end: Int64s) -> tuple[Int64s, Int64s, int]:
    """Number undirected edges: their vertices ``(n, 3)`` (lower, higher, 0), their numbers, and the count."""
    ends = np.column_stack([np.minimum(start, end), np.maximum(start, end), np.zeros_like(start)])
    edge, count = label_equal_rows(ends)
    return ends, edge, count


def _pair_half_edges(
    points: Floats, triangles: Int64s, halves: Int64s, ends: Int64s, edge: Int64s
) -> tuple[Int64s, Int64s]:
    """Pair each backward half-edge with the forward half-edge that bounds the same solid.

    A half-edge is numbered 3 triangle + corner; it is forward if it runs from the lower vertex to the higher one.
    Seen along the edge from its lower vertex, the solid is clockwise of the triangle of a forward half-edge and
    counter-clockwise of the triangle of a backward one. The partner of a backward half-edge is therefore the next
    forward half-edge in order of angle.

    Parameters
    ----------
    halves
        Half-edges to pair.
    ends, edge
        Vertices of the edge of every half-edge, and the number of that edge.
    """
    forward = triangles.ravel()[halves] == ends[halves, 0]
    opposite = np.roll(triangles, -2, axis=1).ravel()[halves]
    low, high = points[ends[halves, 0]], points[ends[halves, 1]]
    angle = _angle_about(low, high - low, points[opposite])
    order = np.lexsort((angle, forward, edge[halves]))
    begins = np.flatnonzero(np.diff(edge[halves[order]], prepend=-1))
    pairs = np.diff(np.append(begins, len(order))) // 2
    # two coinciding faces end one solid and begin the next one; the forward half-edge then precedes
    turned = angle[order[begins + pairs]] < angle[order[begins]] + _SAME_ANGLE
    begin, count, turn = (np.repeat(each, pairs) for each in (begins, pairs, turned.astype(np.int64)))
    rank = np.arange(len(begin)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    return halves[order[begin + rank]], halves[order[begin + count + (rank + turn) % count]]


def _angle_about(origin: Floats, axis: Floats, points: Floats) -> Floats:
    """Return the angle of each point about the axis ``(n, 3)`` through its origin, in radians."""
    ray = points - origin
    right = np.cross(axis, np.eye(3)[np.abs(axis).argmin(axis=1)])
    up = np.cross(axis, right) / np.linalg.norm(axis, axis=1)[:, None]
    return np.asarray(np.arctan2(np.einsum("ij,ij->i", ray, up), np.einsum("ij,ij->i", ray, right)))


def _copy_vertices(
    count: int, triangles: Int64s, touched: Bools, first: Int64s, second: Int64s
) -> tuple[Int64s, Int64s]:
    """Give each fan of triangles around a touched vertex its own copy of the vertex.

    Parameters
    ----------
    count
        Number of the first copy.
    first, second
        Paired half-edges.

    Returns
    -------
    source, triangles
        The vertex that each copy repeats, and the triangles with the copies as corners.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    corner = triangles.ravel()
    near = np.concatenate([first, _following(first)])
    far = np.concatenate([_following(second), second])
    at_touched = np.flatnonzero(touched[corner])
    number = np.full(len(corner), -1)
    number[at_touched] = np.arange(len(at_touched))
    joins = touched[corner[near]]
    rows, columns = number[near[joins]], number[far[joins]]
    graph = coo_array((np.ones(len(rows), np.int8), (rows, columns)), shape=(len(at_touched),) * 2)
    _, fan = connected_components(graph, directed=False)
    _, first_corner = np.unique(fan, return_index=True)
    split = corner.copy()
    split[at_touched] = count + fan
    return corner[at_touched[first_corner]], split.reshape(-1, 3)


def _bisect_doubled(
    points: Floats, added: Floats, triangles: Int64s, first: Int64s, second: Int64s
) -> tuple[Floats, Int64s]:
    """Bisect edges that two pairs of half-edges still share, with a separate middle vertex for each pair.

    Returns
    -------
    middles, triangles
        Vertices that follow after `added`, and the triangles.
    """
    corner = triangles.ravel()
    start, end = corner[first], corner[_following(first)]
    _, edge, count = _label_edges(start, end)
    doubled = np.flatnonzero(np.bincount(edge, minlength=count)[edge] > 1)
    middle = np.full(len(corner), -1)
    next_vertex = len(points) + len(added)
    middle[first[doubled]] = middle[second[doubled]] = next_vertex + np.arange(len(doubled))
    low, high = added[start[doubled] - len(points)], added[end[doubled] - len(points)]
    return round_as_stored((low + high) / 2), bisect_triangles(triangles, middle.reshape(-1, 3))


def _following(half: Int64s) -> Int64s:
    """Return the next half-edge of the same triangle."""
    return half - half % 3 + (half + 1) % 3
