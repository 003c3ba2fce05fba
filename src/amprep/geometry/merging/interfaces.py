"""Subtract the two outlines on the shared face of neighbouring voxels and triangulate what stays exposed."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.meshes.topology import degenerate

_NEAR = 3.0
"""Distance (lattice steps) below which a corner counts as on an edge, unless it is as close to an end of the edge.

Corners are more than twice this distance apart, and rounding moves a crossing by at most 0.71 steps.
"""

_MAX_ROUNDS = 64
"""Number of rounds in which edges are split before outlines are rejected as too fine."""

# Strategy. On a shared face, the surface of the united cells consists of the regions that only one voxel covers.
# 1. Edges of both outlines are split at corners close to them and at crossings, rounded to the integer lattice,
#    until no edge passes through a point or crosses another edge (`_split_edges`). Both outlines then use the same
#    points and have common edges wherever they overlap.
# 2. An edge of one outline bounds the difference if its middle is outside the other region; an edge of the other
#    outline bounds it, in reverse, if its middle is inside; a common edge bounds it if the regions are on different
#    sides (`_difference`). Winding numbers decide, in exact integer arithmetic.
# 3. The edges of each difference are chained to loops and triangulated by manifold3d.
# Splits are reported so that the triangles of the voxels beside the face can be split at the same points; without
# this the mesh would have T-junctions. The cost is quadratic in the edges of one pair of outlines, but each pair is
# computed once and copied to all voxels where it occurs.


class Interface(NamedTuple):
    """Exposed parts of two regions that face each other in a plane.

    Attributes
    ----------
    points
        ``(k, 2)`` on the lattice: corners of both regions, and crossings of their outlines.
    low, high
        ``(m, 3)`` counter-clockwise triangles: the part of each region that the other region does not cover.
    splits
        ``(r, 3)``: the edge between the first two points, of either outline, passes through the third point. The
        halves may be split again.
    """

    points: Int64s
    low: Int64s
    high: Int64s
    splits: Int64s


def make_interface(low: Int64s, high: Int64s) -> Interface | None:
    """Subtract two regions from each other; None if the outlines are too fine for the lattice.

    Parameters
    ----------
    low, high
        ``(n, 2, 2)`` directed edges on the lattice with the region to their left; coordinates below 2**25.
    """
    points, number = np.unique(np.concatenate([low, high]).reshape(-1, 2), axis=0, return_inverse=True)
    edges = number.reshape(-1, 2)
    split = _split_edges(points, np.unique(np.sort(edges, axis=1), axis=0))
    if split is None:
        return None
    points, splits = split
    middle = {(a, b): c for a, b, c in splits}
    first, second = (_net_edges(_split_fully(part, middle)) for part in np.split(edges, [len(low)]))
    exposed = [
        _triangulate(points, _difference(points, own, other))
        for own, other in ((first, second), (second, first))
    ]
    if exposed[0] is None or exposed[1] is None:
        return None
    return Interface(points, exposed[0], exposed[1], np.array(splits, np.int64).reshape(-1, 3))


def _split_edges(points: Int64s, edges: Int64s) -> tuple[Int64s, list[tuple[int, int, int]]] | None:
    """Split edges until none passes through a point or crosses another edge; return all points, and each split."""
    splits: list[tuple[int, int, int]] = []
    for _ in range(_MAX_ROUNDS):
        edge, point = _points_on_edges(points, edges)
        if not len(edge):
            added = _crossings(points, edges)
            if not len(added):
                return points, splits
            points = np.concatenate([points, added])
            continue
        edge, first = np.unique(edge, return_index=True)
        halved = np.column_stack([edges[edge], point[first]])
        splits += [(a, b, c) for a, b, c in halved.tolist()]
        halves = np.concatenate([halved[:, [0, 2]], halved[:, [2, 1]]])
        edges = np.unique(np.sort(np.concatenate([np.delete(edges, edge, axis=0), halves]), axis=1), axis=0)
    return None


def _points_on_edges(points: Int64s, edges: Int64s) -> tuple[Int64s, Int64s]:
    """Return pairs of an edge and a point that the edge passes through."""
    start = points[edges[:, 0]]
    along = points[edges[:, 1]] - start
    offset = points[None] - start[:, None]
    square = (along**2).sum(axis=1)[:, None]
    length = np.sqrt(square)
    reach = (offset * along[:, None]).sum(axis=2)
    inside = (reach > _NEAR * length) & (reach < square - _NEAR * length)
    distance = np.abs(along[:, None, 0] * offset[:, :, 1] - along[:, None, 1] * offset[:, :, 0])
    edge, point = np.nonzero(inside & (distance <= (_NEAR + 1.0) * length))
    return edge, point


def _crossings(points: Int64s, edges: Int64s) -> Int64s:
    """Return the points in the interior of two edges where these cross, rounded to the lattice, each once."""
    start = points[edges[:, 0]]
    along = points[edges[:, 1]] - start
    turn = _cross(along[:, None], along[None])
    offset = start[None] - start[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        fraction = _cross(offset, np.broadcast_to(along[None], offset.shape)) / turn
    length = np.sqrt((along**2).sum(axis=1))
    least = (_NEAR + 1.0) / length
    inside = (turn != 0) & (fraction > least[:, None]) & (fraction < 1.0 - least[:, None])
    first, second = np.nonzero(np.triu(inside & inside.T))
    crossing = start[first] + fraction[first, second, None] * along[first]
    return np.unique(np.round(crossing).astype(np.int64), axis=0)


def _cross(a: Int64s, b: Int64s) -> Int64s:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _split_fully(edges: Int64s, middle: dict[tuple[int, int], int]) -> list[tuple[int, int]]:
    """Apply all splits to directed edges; `middle` gives the point in which an edge (lower, higher) is split."""
    done, todo = [], [(a, b) for a, b in edges.tolist()]
    while todo:
        a, b = todo.pop()
        point = middle.get((min(a, b), max(a, b)))
        if point is None:
            done.append((a, b))
        else:
            todo += [(a, point), (point, b)]
    return done


def _net_edges(edges: list[tuple[int, int]]) -> dict[tuple[int, int], int]:
    """Count for each edge (lower, higher) the forward occurrences less the backward ones; zeros are left out."""
    net: dict[tuple[int, int], int] = {}
    for a, b in edges:
        key = (min(a, b), max(a, b))
        net[key] = net.get(key, 0) + (1 if a < b else -1)
    return {key: times for key, times in net.items() if times}


def _difference(points: Int64s, own: dict[tuple[int, int], int], other: dict[tuple[int, int], int]) -> Int64s:
    """Return the directed edges of a region less another region."""
    kept = [(*key, sign) for key, sign in own.items() if other.get(key) == -sign]
    alone = [(*key, sign) for key, sign in own.items() if key not in other]
    cover = [(*key, -sign) for key, sign in other.items() if key not in own]
    kept += [edge for edge, inside in zip(alone, _inside(points, alone, other), strict=True) if not inside]
    kept += [edge for edge, inside in zip(cover, _inside(points, cover, own), strict=True) if inside]
    edges = np.array(kept, np.int64).reshape(-1, 3)
    return np.where(edges[:, 2:] > 0, edges[:, :2], edges[:, 1::-1])


def _inside(points: Int64s, edges: list[tuple[int, int, int]], region: dict[tuple[int, int], int]) -> Bools:
    """Tell which edges have their middle inside a region, by the winding number of its outline."""
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


def _triangulate(points: Int64s, edges: Int64s) -> Int64s | None:
    """Triangulate the region to the left of directed edges; None if the edges do not form closed loops."""
    from manifold3d import triangulate

    loops = _chain_loops(points, edges)
    if loops is None:
        return None
    if not loops:
        return np.empty((0, 3), np.int64)
    found = triangulate([points[loop].astype(np.float64) for loop in loops])
    triangles = np.concatenate(loops)[np.asarray(found, np.int64)]
    return np.asarray(triangles[~degenerate(triangles)])  # a loop may pass through a point twice


def _chain_loops(points: Int64s, edges: Int64s) -> list[Int64s] | None:
    """Chain directed edges to loops, turning left as far as possible where several edges leave a point."""
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
    """Return the next point that comes first clockwise from the previous point of the loop, `back`."""
    if back is None:
        return min(following)

    def angle(point: int) -> float:
        offset = points[point] - points[at]
        return float(np.arctan2(offset[1], offset[0]))

    return min(following, key=lambda point: ((angle(back) - angle(point)) % (2 * np.pi), point))
