"""Splits triangles where a finer mesh is wanted, neighbours included, so that edges still meet edges."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s, Int64s

MOST_TRIANGLES = 2_000_000

Wish = Callable[[Floats, Int64s], Bools]
"""Called with corners ``(m, 3, 3)`` and the original triangle of each ``(m,)``; says which are to be split."""


class SubdividedMesh(NamedTuple):
    """A finer mesh of the same surface; `parent` ``(m,)`` is the original triangle of each."""

    vertices: Floats
    triangles: Int32s
    parent: Int64s


def subdivide(vertices: Floats, triangles: Int32s, wish: Wish) -> SubdividedMesh:
    """Halve the longest edges of triangles until none is wanted finer, or there are 2 million.

    A triangle next to a halved edge is split with it, its own longest edge first, so the mesh keeps neither
    gaps nor corners on edges, and angles stay bounded (M.-C. Rivara 1984, doi 10.1002/nme.1620200412). New
    vertices come after the old ones.
    """
    refined = SubdividedMesh(
        np.asarray(vertices, np.float64), np.asarray(triangles), np.arange(len(triangles))
    )
    while len(refined.triangles) < MOST_TRIANGLES:
        wanted = wish(refined.vertices[refined.triangles], refined.parent)
        if not wanted.any():
            break
        refined = _halved(refined, wanted)
    return refined


def _halved(mesh: SubdividedMesh, wanted: Bools) -> SubdividedMesh:
    """Split the longest edges of the wanted triangles, and what has to be split with them."""
    corners = _longest_first(mesh)
    ends = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2).astype(np.int64)
    key, edge = np.unique(ends[..., 0] * len(mesh.vertices) + ends[..., 1], return_inverse=True)
    edge = edge.reshape(-1, 3)
    split = np.zeros(len(key), np.bool_)
    split[edge[wanted, 0]] = True
    while (more := split[edge].any(axis=1) & ~split[edge[:, 0]]).any():
        split[edge[more, 0]] = True
    chosen = np.flatnonzero(split)
    start, end = np.divmod(key[chosen], len(mesh.vertices))
    middle = np.full(len(key), -1)
    middle[chosen] = len(mesh.vertices) + np.arange(len(chosen))
    points = np.concatenate([mesh.vertices, (mesh.vertices[start] + mesh.vertices[end]) / 2])
    pieces, parent = _pieces(corners, middle[edge], mesh.parent)
    return SubdividedMesh(points, pieces.astype(np.int32), parent)


def _longest_first(mesh: SubdividedMesh) -> Int32s:
    """Return the corners of each triangle, turned so that its longest edge leads from the first to the second."""
    points = mesh.vertices[mesh.triangles]
    length = np.linalg.norm(np.roll(points, -1, axis=1) - points, axis=2)
    turn = (length.argmax(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(mesh.triangles, turn, axis=1)


def _pieces(corners: Int32s, middle: Int32s, parent: Int64s) -> tuple[Int32s, Int64s]:
    """Return the triangles after splitting; `middle` ``(m, 3)`` is each edge's new vertex, or -1."""
    a, b, c = corners.T
    m, right, left = middle.T
    whole, halved = m < 0, m >= 0
    families = [
        (whole, (a, b, c)),
        (halved & (left < 0), (a, m, c)),
        (halved & (left >= 0), (a, m, left)),
        (halved & (left >= 0), (left, m, c)),
        (halved & (right < 0), (m, b, c)),
        (halved & (right >= 0), (m, b, right)),
        (halved & (right >= 0), (m, right, c)),
    ]
    pieces = [np.column_stack(each)[chosen] for chosen, each in families]
    return np.concatenate(pieces), np.concatenate([parent[chosen] for chosen, _ in families])
