"""Subdivision of marked triangles by bisection of their longest edges."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s, Int64s

MOST_TRIANGLES = 2_000_000
"""Subdivision stops when there are this many triangles."""

Marker = Callable[[Floats, Int64s], Bools]
"""Function of the corners ``(m, 3, 3)`` mm and the original triangle ``(m,)`` that marks triangles to split."""


class SubdividedMesh(NamedTuple):
    """A finer mesh of the same surface; `parent` ``(m,)`` is the original triangle of each triangle."""

    vertices: Floats
    triangles: Int32s
    parent: Int64s


def subdivide(vertices: Floats, triangles: Int32s, mark: Marker) -> SubdividedMesh:
    """Bisect the longest edges of marked triangles until none is marked, or there are two million triangles.

    A triangle next to a bisected edge is split too, first at its own longest edge. So the mesh has no T-junctions, and
    angles stay bounded (Rivara 1984, doi 10.1002/nme.1620200412). New vertices follow the old ones.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    mark
        Called before each round with all present triangles.
    """
    refined = SubdividedMesh(
        np.asarray(vertices, np.float64), np.asarray(triangles), np.arange(len(triangles))
    )
    while len(refined.triangles) < MOST_TRIANGLES:
        marked = mark(refined.vertices[refined.triangles], refined.parent)
        if not marked.any():
            break
        halves = bisect(refined, marked)
        refined = SubdividedMesh(halves.vertices, halves.triangles, refined.parent[halves.parent])
    return refined


def bisect(mesh: SubdividedMesh, marked: Bools) -> SubdividedMesh:
    """Bisect the longest edges of the marked triangles, and of the neighbours that must be split with them.

    The parents are indices of triangles of the mesh given.
    """
    corners = _longest_first(mesh)
    ends = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2).astype(np.int64)
    key, edge = np.unique(ends[..., 0] * len(mesh.vertices) + ends[..., 1], return_inverse=True)
    edge = edge.reshape(-1, 3)
    split = np.zeros(len(key), np.bool_)
    split[edge[marked, 0]] = True
    while (more := split[edge].any(axis=1) & ~split[edge[:, 0]]).any():
        split[edge[more, 0]] = True
    chosen = np.flatnonzero(split)
    start, end = np.divmod(key[chosen], len(mesh.vertices))
    middle = np.full(len(key), -1)
    middle[chosen] = len(mesh.vertices) + np.arange(len(chosen))
    points = np.concatenate([mesh.vertices, (mesh.vertices[start] + mesh.vertices[end]) / 2])
    pieces, parent = _pieces(corners, middle[edge], np.arange(len(corners)))
    return SubdividedMesh(points, pieces.astype(np.int32), parent)


def _longest_first(mesh: SubdividedMesh) -> Int32s:
    """Return the corners of each triangle, rotated so that its longest edge is from the first to the second."""
    points = mesh.vertices[mesh.triangles]
    length = np.linalg.norm(np.roll(points, -1, axis=1) - points, axis=2)
    turn = (length.argmax(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(mesh.triangles, turn, axis=1)


def _pieces(corners: Int32s, middle: Int32s, parent: Int64s) -> tuple[Int32s, Int64s]:
    """Return the triangles after splitting; `middle` ``(m, 3)`` is the new vertex of each edge, or -1."""
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
