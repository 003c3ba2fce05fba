"""Find which stretches of knife edges the part carries from points at which it goes further down."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.overhangs.candidates import Candidates
from amprep.geometry.overhangs.carried.points import TOLERANCE, Limits
from amprep.geometry.overhangs.carried.starts import Starts
from amprep.geometry.overhangs.faces import ANGLE_TOLERANCE_DEG
from amprep.geometry.overhangs.regions import (
    OverhangRegion,
    components_of_edges,
    connected_components,
    numbered_by_first,
)
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
        ``(e,)`` bool, edges that the part carries whole.
    away
        ``(e, 2)`` mm, distance of the ends of each edge from the nearest anchor.
    length
        ``(e,)`` mm, in plan.
    """

    ledge: Floats
    bridge: Floats
    carried: Bools
    away: Floats
    length: Floats


class NeededEdges(NamedTuple):
    """Stretches of knife edges that need support.

    Attributes
    ----------
    points
        ``(k, 3)`` mm, points inside edges at which stretches end.
    ends
        ``(e, 2)`` points of the surface; from its number of points on, those of `points`.
    number
        ``(e,)`` region of each stretch.
    regions
        All regions of knife edges.
    """

    points: Floats
    ends: Int64s
    number: Int64s
    regions: list[OverhangRegion]


def carried_edges(surface: Surface, starts: Starts, edges: Int64s, limits: Limits) -> CarriedEdges:
    """Find how the part carries knife edges ``(e, 2)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components, dijkstra

    count = len(surface.points)
    length = np.linalg.norm(np.diff(surface.points[edges][:, :, :2], axis=1)[:, 0], axis=1)
    ledge, bridge = np.full(len(edges), np.inf), np.full(len(edges), np.inf)
    away = np.full((len(edges), 2), np.inf)
    if len(edges):
        weights = np.maximum(length, 1e-12)
        graph = coo_array((weights, tuple(edges.T)), shape=(count, count)).tocsr()
        _, label = connected_components(graph, directed=False)
        anchors = np.flatnonzero(_anchored(surface, starts, edges, limits))
        for group in np.split(anchors[np.argsort(label[anchors], kind="stable")], _breaks(label[anchors])):
            if len(group):
                own = np.flatnonzero(label[edges[:, 0]] == label[group[0]])
                nodes, inverse = np.unique(edges[own], return_inverse=True)
                small = graph[nodes][:, nodes]
                from_ = np.searchsorted(nodes, group[:_MOST_ANCHORS])
                distance = dijkstra(small, directed=False, indices=from_)
                a, b = (distance[:, inverse.reshape(-1, 2)[:, i]] for i in (0, 1))
                away[own] = np.column_stack([a.min(axis=0), b.min(axis=0)])
                ledge[own] = (away[own].sum(axis=1) + length[own]) / 2
                bridge[own] = _spans(a, b, length[own])
    carried = (ledge <= limits.ledge + TOLERANCE) | (bridge <= limits.bridge + TOLERANCE)
    return CarriedEdges(ledge, bridge, carried, away, length)


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


def _anchored(surface: Surface, starts: Starts, edges: Int64s, limits: Limits) -> Bools:
    """Tell from which points of knife edges the part goes further down, or has a wide start that supports hold.

    It does so more steeply than the overhang angle, or anyhow at a point from which no knife edge goes down. A dip is
    such a point, too; if a local minimum is deeper, the part starts in the air there.
    """
    on_edges = np.zeros(len(surface.points), np.bool_)
    on_edges[edges.ravel()] = True
    anchored = on_edges & (surface.points[:, 2] <= limits.plate)
    steep = np.sin(np.radians(max(limits.angle_deg - ANGLE_TOLERANCE_DEG, 0.0)))
    has_lower, goes_down = np.zeros((2, len(surface.points)), np.bool_)
    for one, other in (edges.T, edges.T[::-1]):
        has_lower[one[surface.points[other, 2] < surface.points[one, 2] - LEVEL]] = True
    for one, other in (surface.edges.T, surface.edges.T[::-1]):
        fall = surface.points[one, 2] - surface.points[other, 2]
        length = np.linalg.norm(surface.points[one] - surface.points[other], axis=1)
        anchored[one[(fall > LEVEL) & (fall >= steep * length)]] = True
        goes_down[one[fall > LEVEL]] = True
    anchored |= (goes_down | _are_lowest(surface, goes_down)) & ~has_lower & ~starts.touching
    anchored[surface.triangles[starts.wide]] = True
    return anchored & on_edges


def _are_lowest(surface: Surface, goes_down: Bools) -> Bools:
    """Tell which points are on plateaus of which no point goes down."""
    level = surface.edges[np.abs(np.diff(surface.points[surface.edges, 2], axis=1)[:, 0]) <= LEVEL]
    plateau = connected_components(level[:, 0], level[:, 1], len(surface.points))
    falls = np.zeros(int(plateau.max(initial=-1)) + 1, np.bool_)
    falls[plateau[goes_down]] = True
    return np.asarray(~falls[plateau])


def edge_regions(found: Candidates, starts: Starts, limits: Limits) -> NeededEdges:
    """Return the stretches of knife edges that need support, and all regions of knife edges.

    Of a connected edge in which the part starts in the air all needs support.
    """
    surface, sharp = found.surface, found.sharp
    number = numbered_by_first(components_of_edges(sharp, len(surface.points)))
    count = int(number.max(initial=-1)) + 1
    how = carried_edges(surface, starts, sharp, limits)
    in_air = np.zeros(count, np.bool_)
    in_air[number[starts.pointed[sharp].any(axis=1)]] = True
    whole = in_air[number]
    needed = ~how.carried | whole
    points, ends = _stretches(surface, sharp, how, whole, limits.ledge)
    places = np.concatenate([surface.points, points])
    regions = []
    for each in range(count):
        own = np.flatnonzero(number == each)
        holds = not needed[own].any()
        chosen = own if holds else own[needed[own]]
        stretch = places[sharp[chosen] if holds else ends[chosen]]
        region = _edge_region(stretch, how, chosen, limits, bool(in_air[each]))
        regions.append(region._replace(is_self_supporting=holds))
    return NeededEdges(points, ends[needed], number[needed], regions)


def _stretches(
    surface: Surface, edges: Int64s, how: CarriedEdges, whole: Bools, ledge: float
) -> tuple[Floats, Int64s]:
    """Return the points inside edges at which ledges end, and the edges between them or their own ends."""
    length = np.maximum(how.length, 1e-12)
    share = np.clip((ledge - how.away) / length[:, None], 0.0, 1.0)
    share[whole | (share.sum(axis=1) >= 1.0)] = 0.0
    inside = (share > 0.0) & (share < 1.0)
    ends = edges.copy()
    ends[inside] = len(surface.points) + np.arange(int(inside.sum()))
    row, side = np.nonzero(inside)
    one, other = surface.points[edges[row, side]], surface.points[edges[row, 1 - side]]
    return one + share[row, side, None] * (other - one), ends


def _edge_region(
    stretches: Floats, how: CarriedEdges, chosen: Int64s, limits: Limits, starts: bool
) -> OverhangRegion:
    """Return the region of the stretches ``(n, 2, 3)`` mm of the chosen edges."""
    along = np.diff(stretches, axis=1)[:, 0]
    length = np.linalg.norm(along, axis=1)
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
        (length[:, None] * stretches.mean(axis=1)).sum(axis=0) / max(float(length.sum()), 1e-300),
        size,
        limit,
        starts,
        angle_deg=float(slope.min()),
        lowest_mm=float(stretches[:, :, 2].min()),
    )
