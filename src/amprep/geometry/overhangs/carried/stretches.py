"""Find which knife edges the part carries from points at which it goes further down."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.overhangs.candidates import Candidates
from amprep.geometry.overhangs.carried.points import TOLERANCE, Limits
from amprep.geometry.overhangs.faces import ANGLE_TOLERANCE_DEG
from amprep.geometry.overhangs.regions import OverhangRegion, components_of_edges, numbered_by_first
from amprep.geometry.overhangs.surface import LEVEL, Surface

_MOST_ANCHORS = 64
"""Largest number of anchors of a connected edge from which distances are found one by one."""


class CarriedEdges(NamedTuple):
    """How the part carries knife edges.

    Attributes
    ----------
    ledge, bridge
        ``(e,)`` mm, greatest distance of a point of each edge from the nearest anchor along connected edges, and length
        of the shortest way over the edge between two anchors; infinite where there is none.
    carried
        ``(e,)`` bool.
    """

    ledge: Floats
    bridge: Floats
    carried: Bools


def carried_edges(surface: Surface, minimum: Int64s, edges: Int64s, limits: Limits) -> CarriedEdges:
    """Find how the part carries knife edges ``(e, 2)``; `minimum` are the plateaus of local minima, else -1."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components, dijkstra

    count = len(surface.points)
    length = np.linalg.norm(np.diff(surface.points[edges][:, :, :2], axis=1)[:, 0], axis=1)
    ledge, bridge = np.full(len(edges), np.inf), np.full(len(edges), np.inf)
    if len(edges):
        weights = np.maximum(length, 1e-12)
        graph = coo_array((weights, tuple(edges.T)), shape=(count, count)).tocsr()
        _, label = connected_components(graph, directed=False)
        anchors = np.flatnonzero(_anchored(surface, minimum, edges, limits))
        for group in np.split(anchors[np.argsort(label[anchors], kind="stable")], _breaks(label[anchors])):
            if len(group):
                own = np.flatnonzero(label[edges[:, 0]] == label[group[0]])
                nodes, inverse = np.unique(edges[own], return_inverse=True)
                small = graph[nodes][:, nodes]
                from_ = np.searchsorted(nodes, group[:_MOST_ANCHORS])
                distance = dijkstra(small, directed=False, indices=from_)
                a, b = (distance[:, inverse.reshape(-1, 2)[:, i]] for i in (0, 1))
                ledge[own] = (a.min(axis=0) + b.min(axis=0) + length[own]) / 2
                bridge[own] = _spans(a, b, length[own])
    carried = (ledge <= limits.ledge + TOLERANCE) | (bridge <= limits.bridge + TOLERANCE)
    return CarriedEdges(ledge, bridge, carried)


def _breaks(label: Ints) -> Int64s:
    return np.flatnonzero(np.diff(np.sort(label))) + 1


def _spans(a: Floats, b: Floats, length: Floats) -> Floats:
    """Return the shortest way between two different anchors along each edge; ``a[i], b[i]`` lead from anchor i."""
    shortest = np.full(len(length), np.inf)
    for i in range(len(a)):
        others = np.delete(b, i, axis=0)
        if len(others):
            shortest = np.minimum(shortest, a[i] + length + others.min(axis=0))
    return shortest


def _anchored(surface: Surface, minimum: Int64s, edges: Int64s, limits: Limits) -> Bools:
    """Tell from which points of knife edges the part goes further down.

    It does so more steeply than the overhang angle, or anyhow at a point from which no knife edge goes down; if that
    is a local minimum, the part starts in the air there.
    """
    on_edges = np.zeros(len(surface.points), np.bool_)
    on_edges[edges.ravel()] = True
    anchored = on_edges & (surface.points[:, 2] <= limits.plate)
    steep = np.sin(np.radians(max(limits.angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    has_lower = np.zeros(len(surface.points), np.bool_)
    for one, other in (edges.T, edges.T[::-1]):
        has_lower[one[surface.points[other, 2] < surface.points[one, 2] - LEVEL]] = True
    for one, other in (surface.edges.T, surface.edges.T[::-1]):
        fall = surface.points[one, 2] - surface.points[other, 2]
        length = np.linalg.norm(surface.points[one] - surface.points[other], axis=1)
        anchored[one[(fall > LEVEL) & (fall >= steep * length)]] = True
    anchored |= ~has_lower & (minimum < 0)
    return anchored & on_edges


def edge_regions(found: Candidates, limits: Limits) -> tuple[Int64s, Int64s, list[OverhangRegion]]:
    """Return the knife edges ``(e, 2)`` that need support, the number of the region of each, and all regions."""
    surface, sharp = found.surface, found.sharp
    number = numbered_by_first(components_of_edges(sharp, len(surface.points)))
    count = int(number.max(initial=-1)) + 1
    how = carried_edges(surface, found.minimum, sharp, limits)
    starts = np.zeros(count, np.bool_)
    starts[number[(found.minimum[sharp] >= 0).any(axis=1)]] = True
    needed = ~how.carried | starts[number]
    regions = []
    for each in range(count):
        own = np.flatnonzero(number == each)
        chosen = own[needed[own]] if needed[own].any() else own
        regions.append(_edge_region(surface, sharp[chosen], how, chosen, limits, bool(starts[each])))
    return (
        sharp[needed],
        number[needed],
        [
            region._replace(is_self_supporting=not needed[number == each].any())
            for each, region in enumerate(regions)
        ],
    )


def _edge_region(
    surface: Surface, ends: Int64s, how: CarriedEdges, chosen: Int64s, limits: Limits, starts: bool
) -> OverhangRegion:
    along = np.diff(surface.points[ends], axis=1)[:, 0]
    length = np.linalg.norm(along, axis=1)
    middle = surface.points[ends].mean(axis=1)
    worst = chosen[np.minimum(2 * how.ledge[chosen], how.bridge[chosen]).argmax()]
    ledge, bridge = float(how.ledge[worst]), float(how.bridge[worst])
    is_bridge = bridge <= 2.1 * ledge and np.isfinite(bridge)
    size, limit = (bridge, limits.bridge) if is_bridge else (ledge, limits.ledge)
    if np.isinf(size):
        size = limit = 0.0
    slope = np.degrees(np.arcsin(np.clip(np.abs(along[:, 2]) / np.maximum(length, 1e-300), 0, 1)))
    return OverhangRegion(
        "edge",
        float(length.sum()),
        (length[:, None] * middle).sum(axis=0) / max(float(length.sum()), 1e-300),
        size,
        limit,
        starts,
        angle_deg=float(slope.min()),
        lowest_mm=float(surface.points[ends, 2].min()),
    )
