"""Part closed meshes along edges where solids merely touch, so that no edge has more than two triangles."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.meshes.welding import label_equal_rows, round_as_stored

_SAME_ANGLE = 1e-3
"""Radians; what rounding to a build file's precision turns the faces of an edge at most."""


def separate_edges(points: Floats, triangles: Int64s) -> tuple[Floats, Int64s]:
    """Copy vertices so that no edge of a closed mesh has more than two triangles.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``, closed and without overlaps; an open mesh comes back as it is.
    """
    crowded = crowded_ends(triangles)
    if crowded is None or not len(crowded):
        return points, triangles
    added, triangles = part_at(points, triangles, crowded)
    return drop_unused_vertices(np.concatenate([points, added]), triangles)


def part_at(points: Floats, triangles: Int64s, crowded: Int64s) -> tuple[Floats, Int64s]:
    """Copy the vertices `crowded` so that no edge to them has more than two triangles.

    Of the triangles around an edge, each pairs with the next one across the solid. Where both ends of an
    edge hang together all the same, the edge is split in the middle, once for each pair: manifold3d would
    part it as well, but loses a corner of the solid now and then.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``: all triangles at the crowded vertices, and any others.

    Returns
    -------
    added, triangles
        Vertices that follow after `points`, and all triangles, those at crowded vertices last.
    """
    if not len(crowded):
        return points[:0], triangles
    touched = np.zeros(len(points), np.bool_)
    touched[crowded] = True
    around = touched[triangles].any(axis=1)
    near = triangles[around]
    start, end = near.ravel(), np.roll(near, -1, axis=1).ravel()
    ends = np.column_stack([np.minimum(start, end), np.maximum(start, end), np.zeros_like(start)])
    edge, _ = label_equal_rows(ends)
    first, second = _paired(points, near, np.flatnonzero(touched[start] | touched[end]), ends, edge)
    source, near = _split(len(points), near, touched, first, second)
    added = points[source]
    middles, near = _halve_doubled(points, added, near, first, second)
    return np.concatenate([added, middles]), np.concatenate([triangles[~around], near])


def crowded_ends(triangles: Int64s, first: int = 0) -> Int64s | None:
    """Return the vertices of edges with more than two triangles; None when some edge is not matched.

    Only edges between vertices from `first` on count.
    """
    base = int(triangles.max(initial=0)) + 1
    ways: list[Int64s] = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = triangles[:, a], triangles[:, b]
        counted = (start >= first) & (end >= first)
        ways.append(np.where(start < end, start * base + end, -1 - (end * base + start))[counted])
    keys = np.concatenate(ways)
    forth, back = np.sort(keys[keys >= 0]), np.sort(-1 - keys[keys < 0])
    if len(forth) != len(back) or (forth != back).any():
        return None
    twice = forth[1:][forth[1:] == forth[:-1]]
    return np.unique(np.concatenate(np.divmod(twice, base)))


def _paired(
    points: Floats, triangles: Int64s, halves: Int64s, ends: Int64s, edge: Int64s
) -> tuple[Int64s, Int64s]:
    """Pair half-edges (3 triangle + corner) across the solid: each that runs back with the next one forth.

    Seen along the edge from its lower vertex, the solid lies clockwise of a triangle that runs forth and
    counter-clockwise of one that runs back.
    """
    forth = triangles.ravel()[halves] == ends[halves, 0]
    opposite = np.roll(triangles, -2, axis=1).ravel()[halves]
    low, high = points[ends[halves, 0]], points[ends[halves, 1]]
    axis = high - low
    ray = points[opposite] - low
    right = np.cross(axis, np.eye(3)[np.abs(axis).argmin(axis=1)])
    up = np.cross(axis, right) / np.linalg.norm(axis, axis=1)[:, None]
    angle = np.arctan2(np.einsum("ij,ij->i", ray, up), np.einsum("ij,ij->i", ray, right))
    order = np.lexsort((angle, forth, edge[halves]))
    begins = np.flatnonzero(np.diff(edge[halves[order]], prepend=-1))
    pairs = np.diff(np.append(begins, len(order))) // 2
    # faces that coincide end one solid and begin the next: then the one that runs forth comes first
    turned = angle[order[begins + pairs]] < angle[order[begins]] + _SAME_ANGLE
    begin, count, turn = (np.repeat(each, pairs) for each in (begins, pairs, turned.astype(np.int64)))
    rank = np.arange(len(begin)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    return halves[order[begin + rank]], halves[order[begin + count + (rank + turn) % count]]


def _split(
    count: int, triangles: Int64s, touched: Bools, first: Int64s, second: Int64s
) -> tuple[Int64s, Int64s]:
    """Give each fan of triangles around a touched vertex its own copy of it, from vertex `count` on.

    Returns
    -------
    source, triangles
        The vertex that each copy is of.
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


def _halve_doubled(
    points: Floats, added: Floats, triangles: Int64s, first: Int64s, second: Int64s
) -> tuple[Floats, Int64s]:
    """Put a vertex of its own, after those added, into each pair's edge where two pairs share both vertices."""
    corner = triangles.ravel()
    start, end = corner[first], corner[_following(first)]
    ends = np.column_stack([np.minimum(start, end), np.maximum(start, end), np.zeros_like(start)])
    edge, count = label_equal_rows(ends)
    doubled = np.flatnonzero(np.bincount(edge, minlength=count)[edge] > 1)
    middle = np.full(len(corner), -1)
    count = len(points) + len(added)
    middle[first[doubled]] = middle[second[doubled]] = count + np.arange(len(doubled))
    low, high = added[start[doubled] - len(points)], added[end[doubled] - len(points)]
    return round_as_stored((low + high) / 2), halved(triangles, middle.reshape(-1, 3))


def halved(triangles: Int64s, middle: Int64s) -> Int64s:
    """Split triangles at the vertices `middle` ``(m, 3)`` on their sides (-1 for none), a side at a time."""
    done = [triangles[(middle < 0).all(axis=1)]]
    open_ = (middle >= 0).any(axis=1)
    triangles, middle = triangles[open_], middle[open_]
    while len(triangles):
        turn = ((middle >= 0).argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles, turn, axis=1).T
        m, on_bc, on_ca = np.take_along_axis(middle, turn, axis=1).T
        none = np.full(len(m), -1)
        triangles = np.concatenate([np.column_stack([a, m, c]), np.column_stack([m, b, c])])
        middle = np.concatenate([np.column_stack([none, none, on_ca]), np.column_stack([none, on_bc, none])])
        open_ = (middle >= 0).any(axis=1)
        done.append(triangles[~open_])
        triangles, middle = triangles[open_], middle[open_]
    return np.concatenate(done)


def _following(half: Int64s) -> Int64s:
    """Return the next half-edge of the same triangle."""
    return half - half % 3 + (half + 1) % 3
