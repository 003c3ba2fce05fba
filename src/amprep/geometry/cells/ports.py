"""Find the ports of a cell, its outlines on the sides of the unit cube, and make opposite sides conform."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.meshes.topology import degenerate, drop_unused_vertices, first_of_equal_rows

SNAP = 1e-5
"""Distance, in edges of the unit cube, within which coordinates are taken as equal: files store six digits."""

PLANE_AXES = ((1, 2), (2, 0), (0, 1))
"""The two other axes u, v of each axis, such that u, v and the axis are right-handed."""

_MAX_ROUNDS = 32


class Outlines(NamedTuple):
    """Closed outlines of a mesh on one side of the cube.

    Attributes
    ----------
    loops
        Vertex indices; the mesh is to the left seen from outside.
    simple
        False if outlines touch in a point; there are no loops then.
    """

    loops: list[Int64s]
    simple: bool


def snapped(points: Floats) -> Floats:
    """Return the points with coordinates close to 0 or 1 set to exactly 0 or 1."""
    low, high = np.abs(points) < SNAP, np.abs(points - 1.0) < SNAP
    return np.asarray(np.where(low, 0.0, np.where(high, 1.0, points)))


def flush_sides(points: Floats, triangles: Int64s) -> Int64s:
    """Return the side of the cube that contains each triangle: 2 axis + (0 or 1), or -1."""
    corners = points[triangles]
    flush = np.stack([(corners == 0.0).all(axis=1), (corners == 1.0).all(axis=1)], axis=2).reshape(-1, 6)
    return np.where(flush.any(axis=1), flush.argmax(axis=1), -1)


def conform(points: Floats, triangles: Int64s) -> MeshArrays:
    """Triangulate opposite sides of a closed mesh alike, where their outlines are equal.

    Adjacent copies of the cell then have the same triangles on their common side and can be welded. Vertices move by
    at most `SNAP`. Sides whose outlines differ keep their triangles.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` in the unit cube and ``(m, 3)``.
    """
    points = snapped(points)
    triangles = first_of_equal_rows(points)[triangles]
    points, triangles = drop_unused_vertices(points, triangles[~degenerate(triangles)])
    for _ in range(_MAX_ROUNDS):
        points, triangles, changed = _share_corners(points, triangles)
        if not changed:
            break
    for axis in range(3):
        triangles = _triangulate_alike(points, triangles, axis)
    return drop_unused_vertices(points, triangles)


def _border(triangles: Int64s) -> Int64s:
    """Return the directed edges ``(e, 2)`` of triangles that have no opposite among them."""
    edges = np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    base = int(triangles.max(initial=0)) + 1
    forth, back = edges[:, 0] * base + edges[:, 1], edges[:, 1] * base + edges[:, 0]
    return np.asarray(edges[~np.isin(forth, back)])


def _loops(border: Int64s) -> Outlines:
    """Chain directed edges into closed loops."""
    following = dict(border.tolist())
    simple = len(following) == len(border) == len(set(following.values()))
    loops: list[Int64s] = []
    while simple and following:
        loop = [next(iter(following))]
        while (after := following.pop(loop[-1], None)) is not None and after != loop[0]:
            loop.append(after)
        if after is None:
            return Outlines([], simple=False)
        loops.append(np.array(loop, np.int64))
    return Outlines(loops, simple)


def _share_corners(points: Floats, triangles: Int64s) -> tuple[Floats, Int64s, bool]:
    """Give the outlines of opposite sides the same vertices: move near vertices, and split edges for the others."""
    changed = False
    for axis in (2, 0, 1):
        u, v = PLANE_AXES[axis]
        for here, there in ((0, 1), (1, 0)):
            side = flush_sides(points, triangles)
            borders = [_border(triangles[side == 2 * axis + end]) for end in (here, there)]
            if not len(borders[0]) or not len(borders[1]):
                continue
            wanted = np.unique(borders[0])
            known = np.unique(borders[1])
            gap = np.abs(points[wanted][:, None, [u, v]] - points[known][None, :, [u, v]]).max(axis=2)
            nearest, near = known[gap.argmin(axis=1)], gap.min(axis=1) < SNAP
            points = points.copy()
            points[np.ix_(nearest[near], [u, v])] = points[np.ix_(wanted[near], [u, v])]
            found = _on_edge(points, borders[1], points[wanted[~near]], (u, v))
            if found is not None:
                vertex, edge = found
                place = points[wanted[~near][vertex]].copy()
                place[axis] = float(there)
                points, triangles = _split_edge(points, triangles, edge, place)
                changed = True
    return points, triangles, changed


def _on_edge(
    points: Floats, border: Int64s, places: Floats, plane: tuple[int, int]
) -> tuple[int, tuple[int, int]] | None:
    """Return the first of the places ``(k, 3)`` that is inside a border edge seen along the axis, and that edge."""
    start, end = points[border[:, 0]][:, plane], points[border[:, 1]][:, plane]
    along, to = (end - start)[None], places[:, None, list(plane)] - start[None]
    length = np.maximum(np.linalg.norm(along, axis=2), 1e-300)
    fraction = (along * to).sum(axis=2) / length**2
    away = np.abs(along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0]) / length
    found = np.argwhere((away < SNAP) & (fraction > 0.0) & (fraction < 1.0))
    if not len(found):
        return None
    vertex, edge = found[0].tolist()
    return vertex, (int(border[edge, 0]), int(border[edge, 1]))


def _split_edge(points: Floats, triangles: Int64s, edge: tuple[int, int], place: Floats) -> MeshArrays:
    """Put a vertex on an edge, which halves each triangle with this edge."""
    middle = len(points)
    cut = np.isin(triangles, edge).sum(axis=1) == 2
    parts = [triangles[~cut]]
    for end in edge:
        parts.append(np.where(triangles[cut] == end, middle, triangles[cut]))
    return np.vstack([points, place]), np.concatenate(parts)


def _triangulate_alike(points: Floats, triangles: Int64s, axis: int) -> Int64s:
    """Triangulate the high side again, and the low side like it, if both have the same outlines."""
    from manifold3d import triangulate

    side = flush_sides(points, triangles)
    low, high = (_border(triangles[side == 2 * axis + end]) for end in (0, 1))
    found = _loops(high)
    if not found.loops or len(low) != len(high):
        return triangles
    plane = list(PLANE_AXES[axis])
    opposite = {tuple(points[i, plane].tolist()): int(i) for i in np.unique(low)}
    image = {int(i): opposite.get(tuple(points[i, plane].tolist()), -1) for i in np.unique(high)}
    mirrored = {(image[int(b)], image[int(a)]) for a, b in high}
    if mirrored != {(int(a), int(b)) for a, b in low}:
        return triangles
    loops = sorted(
        (_from_least(loop, points[:, plane]) for loop in found.loops),
        key=lambda loop: points[loop[0], plane].tolist(),
    )
    corner = np.concatenate(loops)
    cut = corner[np.asarray(triangulate([points[loop][:, plane] for loop in loops]), np.int64)]
    if not len(cut) or not np.array_equal(_sorted_rows(_border(cut)), _sorted_rows(high)):
        return triangles
    below = np.vectorize(image.__getitem__, otypes=[np.int64])(cut[:, ::-1])
    return np.concatenate([triangles[side // 2 != axis], cut, below])


def _from_least(loop: Int64s, plan: Floats) -> Int64s:
    """Rotate a loop to begin at its lowest corner."""
    return np.roll(loop, -int(np.lexsort(plan[loop].T[::-1])[0]))


def _sorted_rows(rows: Int64s) -> Int64s:
    return np.asarray(rows[np.lexsort(rows.T[::-1])])
