"""Tell which points of knife edges the part itself carries: within a ledge or a bridge along the edges.

Strategy. Knife edges are cut at their anchors: the points from which the part goes further down. In each piece, an
anchor is an end. The distances of a sample to all ends, along the edges and in plan, follow from those of both ends of
its edge (Dijkstra). It is carried if the nearest end is within the ledge, or the two nearest together are within the
bridge.
"""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.lines import Reaches
from amprep.checks.overhangs.starts import plateaus
from amprep.checks.overhangs.surface import LEVEL, MergedMesh

_MOST = 2_000_000
"""Distances that are kept at once."""


def carried_along(
    surface: MergedMesh,
    ends: Int64s,
    points: Floats,
    edge: Int64s,
    reaches: Reaches,
    plate: float,
    held: Bools,
) -> Bools:
    """Tell which points on knife edges the part itself carries, ``(n,)``.

    Parameters
    ----------
    surface
        The part.
    ends
        ``(e, 2)`` points of the knife edges.
    points, edge
        ``(n, 3)`` mm, and the edge of each.
    reaches
        Limits.
    plate
        Height up to which geometry is on the plate, mm.
    held
        ``(n,)`` bool, points of the part that are anchors because supports hold them.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    anchor = _anchors(surface, ends, reaches.angle, plate) | held
    node, count = _cut(ends, anchor)
    terminals = np.unique(node[anchor[ends]])
    if not len(points) or not len(terminals):
        return np.zeros(len(points), np.bool_)
    plan = surface.points[:, :2]
    length = np.maximum(np.linalg.norm(plan[ends[:, 1]] - plan[ends[:, 0]], axis=1), LEVEL)
    graph = csr_array((length, (node[:, 0], node[:, 1])), shape=(count, count))
    to_end = [np.linalg.norm(points[:, :2] - plan[ends[edge, side]], axis=1) for side in (0, 1)]
    best = np.full((2, len(points)), np.inf)
    for some in np.array_split(terminals, max(len(terminals) * count // _MOST, 1)):
        limit = max(reaches.ledge, reaches.bridge, LEVEL)
        away = np.atleast_2d(dijkstra(graph, directed=False, indices=some, limit=limit))
        reach = np.minimum(*(away[:, node[edge, side]] + to_end[side] for side in (0, 1)))
        best = np.sort(np.concatenate([best, reach]), axis=0)[:2]
    return np.asarray((best[0] <= reaches.ledge) | (best.sum(axis=0) <= reaches.bridge))


def _anchors(surface: MergedMesh, ends: Int64s, angle: float, plate: float) -> Bools:
    """Tell from which points of knife edges the part goes further down, ``(n,)`` bool over all points.

    It does so steeply, or anyhow at a point from which no knife edge goes down. A local minimum, a dip or a start, is
    such a point, too.
    """
    points = surface.points
    both = np.concatenate([surface.ends, surface.ends[:, ::-1]])
    step = points[both[:, 1]] - points[both[:, 0]]
    falls = step[:, 2] < -LEVEL
    steep = falls & (-step[:, 2] >= np.linalg.norm(step, axis=1) * np.sin(angle))
    goes_down, is_steep, has_lower = (np.zeros(len(points), np.bool_) for _ in range(3))
    goes_down[both[falls, 0]], is_steep[both[steep, 0]] = True, True
    sharp = np.concatenate([ends, ends[:, ::-1]])
    has_lower[sharp[points[sharp[:, 1], 2] < points[sharp[:, 0], 2] - LEVEL, 0]] = True
    on_edges = np.zeros(len(points), np.bool_)
    on_edges[ends] = True
    plateau = plateaus(surface)
    goes_down |= ~np.isin(plateau, plateau[goes_down])
    return np.asarray(on_edges & (is_steep | (goes_down & ~has_lower) | (points[:, 2] <= plate)))


def _cut(ends: Int64s, anchor: Bools) -> tuple[Int64s, int]:
    """Return nodes ``(e, 2)`` of edges such that every anchor is a node of its own in each edge, and their number."""
    node = ends.copy()
    at_anchor = anchor[ends]
    node[at_anchor] = len(anchor) + np.arange(int(at_anchor.sum()))
    known, node = np.unique(node, return_inverse=True)
    return node.reshape(-1, 2), len(known)
