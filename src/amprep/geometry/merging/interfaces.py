"""Two outlines on the common side of two voxels: what of each side stays a surface, on one set of corners."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.meshes.topology import degenerate

_NEAR = 3.0
"""Steps of the lattice: a corner this close to an edge lies on it, unless it is as close to its ends. Corners are
further apart than twice that, and rounding moves a crossing by 0.71 at most."""

_ROUNDS = 64
"""Corners and crossings that one edge may get; outlines that need more are given up."""


class Seam(NamedTuple):
    """What two regions of a plane that face each other come to.

    Attributes
    ----------
    points
        ``(k, 2)`` on the lattice; corners of both regions, crossings of their outlines.
    ours, theirs
        ``(m, 3)`` counter-clockwise triangles of what the other region does not cover.
    splits
        ``(r, 3)``: the edge between the first two points, of either outline, passes through the third. Its
        halves may be split again.
    """

    points: Int64s
    ours: Int64s
    theirs: Int64s
    splits: Int64s


def seam(ours: Int64s, theirs: Int64s) -> Seam | None:
    """Take two regions off one another; None where their outlines are too fine for the lattice.

    Edges of both are first split at each other's corners and crossings. An edge of the one then bounds what
    is left of it where its middle lies outside the other, and so on; what is left is triangulated.

    Parameters
    ----------
    ours, theirs
        ``(n, 2, 2)`` directed edges on the lattice, the region to their left; below 2**25 in size.
    """
    points, number = np.unique(np.concatenate([ours, theirs]).reshape(-1, 2), axis=0, return_inverse=True)
    edges = number.reshape(-1, 2)
    split = _split(points, np.unique(np.sort(edges, axis=1), axis=0))
    if split is None:
        return None
    points, splits = split
    through = {(a, b): c for a, b, c in splits}
    first, second = (_net(_fine(part, through)) for part in np.split(edges, [len(ours)]))
    left = _left_over(points, first, second), _left_over(points, second, first)
    triangles = [_triangles(points, outline) for outline in left]
    if triangles[0] is None or triangles[1] is None:
        return None
    return Seam(points, triangles[0], triangles[1], np.array(splits, np.int64).reshape(-1, 3))


def _split(points: Int64s, edges: Int64s) -> tuple[Int64s, list[tuple[int, int, int]]] | None:
    """Split edges until none passes through a point or across another; return all points, and each split."""
    splits: list[tuple[int, int, int]] = []
    for _ in range(_ROUNDS):
        edge, point = _passed(points, edges)
        if not len(edge):
            added = _crossings(points, edges)
            if not len(added):
                return points, splits
            points = np.concatenate([points, added])
            continue
        edge, first = np.unique(edge, return_index=True)
        halved = np.column_stack([edges[edge], point[first]])
        splits += [(a, b, c) for a, b, c in halved.tolist()]
        parts = np.concatenate([halved[:, [0, 2]], halved[:, [2, 1]]])
        edges = np.unique(np.sort(np.concatenate([np.delete(edges, edge, axis=0), parts]), axis=1), axis=0)
    return None


def _passed(points: Int64s, edges: Int64s) -> tuple[Int64s, Int64s]:
    """Return edges and the points they pass through, in pairs."""
    start = points[edges[:, 0]]
    along = points[edges[:, 1]] - start
    away = points[None] - start[:, None]
    square = (along**2).sum(axis=1)[:, None]
    length = np.sqrt(square)
    reach = (away * along[:, None]).sum(axis=2)
    inside = (reach > _NEAR * length) & (reach < square - _NEAR * length)
    off = np.abs(along[:, None, 0] * away[:, :, 1] - along[:, None, 1] * away[:, :, 0])
    edge, point = np.nonzero(inside & (off <= (_NEAR + 1.0) * length))
    return edge, point


def _crossings(points: Int64s, edges: Int64s) -> Int64s:
    """Return where edges cross, well inside both, rounded to the lattice; no two on one edge."""
    start = points[edges[:, 0]]
    along = points[edges[:, 1]] - start
    turn = _cross(along[:, None], along[None])
    offset = start[None] - start[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = _cross(offset, np.broadcast_to(along[None], offset.shape)) / turn
    length = np.sqrt((along**2).sum(axis=1))
    least = (_NEAR + 1.0) / length
    inside = (turn != 0) & (share > least[:, None]) & (share < 1.0 - least[:, None])
    first, second = np.nonzero(np.triu(inside & inside.T))
    place = start[first] + share[first, second, None] * along[first]
    return np.unique(np.round(place).astype(np.int64), axis=0)


def _cross(a: Int64s, b: Int64s) -> Int64s:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _fine(edges: Int64s, through: dict[tuple[int, int], int]) -> list[tuple[int, int]]:
    """Return directed edges with all their splits carried out."""
    done, todo = [], [(a, b) for a, b in edges.tolist()]
    while todo:
        a, b = todo.pop()
        middle = through.get((min(a, b), max(a, b)))
        if middle is None:
            done.append((a, b))
        else:
            todo += [(a, middle), (middle, b)]
    return done


def _net(edges: list[tuple[int, int]]) -> dict[tuple[int, int], int]:
    """Return how often each edge, lower end first, is run along more often forth than back."""
    net: dict[tuple[int, int], int] = {}
    for a, b in edges:
        key = (min(a, b), max(a, b))
        net[key] = net.get(key, 0) + (1 if a < b else -1)
    return {key: times for key, times in net.items() if times}


def _left_over(points: Int64s, own: dict[tuple[int, int], int], other: dict[tuple[int, int], int]) -> Int64s:
    """Return directed edges around what of a region lies outside the other."""
    kept = [(*key, sign) for key, sign in own.items() if other.get(key) == -sign]
    alone = [(*key, sign) for key, sign in own.items() if key not in other]
    cover = [(*key, -sign) for key, sign in other.items() if key not in own]
    kept += [edge for edge, inside in zip(alone, _inside(points, alone, other), strict=True) if not inside]
    kept += [edge for edge, inside in zip(cover, _inside(points, cover, own), strict=True) if inside]
    edges = np.array(kept, np.int64).reshape(-1, 3)
    return np.where(edges[:, 2:] > 0, edges[:, :2], edges[:, 1::-1])


def _inside(points: Int64s, edges: list[tuple[int, int, int]], region: dict[tuple[int, int], int]) -> Bools:
    """Tell which edges have their middle inside a region: its outline winds around it."""
    if not edges or not region:
        return np.zeros(len(edges), np.bool_)
    which = np.array(edges, np.int64)
    middle = points[which[:, 0]] + points[which[:, 1]]
    outline, sign = 2 * points[np.array(list(region))], np.array(list(region.values()))
    low, high = outline[:, 0], outline[:, 1]
    below, above = low[:, 1] <= middle[:, 1:], high[:, 1] <= middle[:, 1:]
    side = _cross(high - low, middle[:, None] - low)
    up, down = below & ~above & (side > 0), ~below & above & (side < 0)
    return np.asarray(((up.astype(np.int64) - down) * sign).sum(axis=1) > 0)


def _triangles(points: Int64s, edges: Int64s) -> Int64s | None:
    """Triangulate what lies to the left of closed directed edges; None when they are not closed."""
    from manifold3d import triangulate

    loops = _loops(points, edges)
    if loops is None:
        return None
    if not loops:
        return np.empty((0, 3), np.int64)
    found = triangulate([points[loop].astype(np.float64) for loop in loops])
    triangles = np.concatenate(loops)[np.asarray(found, np.int64)]
    return np.asarray(triangles[~degenerate(triangles)])  # where a loop passes a point twice


def _loops(points: Int64s, edges: Int64s) -> list[Int64s] | None:
    """Chain directed edges to loops; where several go on from a point, the one that turns most to the left."""
    leaving: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        leaving.setdefault(a, []).append(b)
    loops = []
    while leaving:
        first = at = min(leaving)
        back: int | None = None
        loop: list[int] = []
        while not loop or at != first:
            if at not in leaving:
                return None
            following = leaving[at]
            after = following[0] if len(following) == 1 else _leftmost(points, back, at, following)
            following.remove(after)
            if not following:
                del leaving[at]
            loop.append(at)
            back, at = at, after
        loops.append(np.array(loop))
    return loops


def _leftmost(points: Int64s, back: int | None, at: int, following: list[int]) -> int:
    """Return the first of the points that come next, clockwise from where the loop came from."""
    if back is None:
        return min(following)

    def angle(point: int) -> float:
        there = points[point] - points[at]
        return float(np.arctan2(there[1], there[0]))

    return min(following, key=lambda point: ((angle(back) - angle(point)) % (2 * np.pi), point))
