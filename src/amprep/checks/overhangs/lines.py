"""Tell which points of overhang regions the part itself carries: ledges, bridges and arches.

Strategy. Known are the edges of each region in plan, with heights; some of those at its border are anchors. Through
each point go horizontal lines in many directions. The first borders that a line crosses on both sides are the ends of
the stretch inside the region. A region may lie above itself (a thread); an edge belongs to the same turn only if its
height differs by no more than the overhang angle allows over the distance. The point is carried

(a) if the nearest anchor is visible and at most `ledge_mm` away, or so is an end of a line that is an anchor;
(b) if both ends of a line are anchors and it is at most `bridge_mm` long;
(c) if both ends are anchors, the region rises between them by at least half as much as a circular arc that is flatter
    than the overhang angle, and the diameter is at most `bore_mm`. Between parallel anchors their distance counts,
    since lines along the oblique end of a bore are longer.

In a region in which the part starts in the air, an anchor counts only if it is hardly higher than the point, as it is
printed later otherwise; of the two ends in (b) and (c) one suffices.

At the open end of a bridge or bore no straight line may lead from anchor to anchor, because the rim is bent or frayed.
Points that are at most `_RIM` from points that (b) or (c) carry are carried, too.

Pairs of points and edges of a region are listed in chunks, and only pairs that cross are computed further: a part with
10,000 points takes about a second.
"""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.borders import RegionEdges

if TYPE_CHECKING:
    from amprep.kernels.overhangs.anchors import RegionSegments

CHUNK = 1_000_000
"""Pairs of a point and an edge that are computed at once."""

_FEW, _MORE, _MANY = 12, 72, 360
"""Numbers of lines through a point: the first ones, then those for points that none of the former carries."""

_RIM = 0.25
"""Width (mm) of the strip along open borders of a bridge or bore that its neighbourhood carries."""

_NEAR = 0.3
"""Distance (mm) up to which anchors are looked for first, because most points have one as near."""

_STRAIGHT, _OBLIQUE = 0.8, 2.0
"""Greatest length of a line across an arch, in diameters: at first, and where few points are left."""

_PARALLEL = 0.985
"""Cosine of the greatest angle between anchors that count as parallel."""

_SLACK = 0.05
"""Error (mm) of the height at which a line leaves a region."""


class Reaches(NamedTuple):
    """Distances up to which the part carries a region, and the overhang angle.

    Attributes
    ----------
    ledge, bridge, bore
        mm.
    angle
        radians.
    arch
        Least rise of an arch, as a fraction of that of a circular arc.
    """

    ledge: float
    bridge: float
    bore: float
    angle: float
    arch: float = 0.5


class _Group(NamedTuple):
    """Points, and the edges that concern them, as indices."""

    points: Int64s
    edges: Int64s


class _Ends(NamedTuple):
    """Where lines leave the region: distance from their points, height, edge, whether at an anchor; ``(n,)`` each."""

    distance: Floats
    height: Floats
    edge: Int64s
    at_anchor: Bools


def carried(
    points: Floats,
    region: Int64s,
    edges: RegionEdges,
    reaches: Reaches,
    climb: Floats,
    *,
    thorough: bool = True,
) -> Bools:
    """Tell which points of overhang regions the part itself carries, ``(n,)``.

    Parameters
    ----------
    points, region
        ``(n, 3)`` mm inside faces of the regions, and the region of each.
    edges
        Edges of the regions.
    reaches
        Limits.
    climb
        ``(n,)`` greatest height (mm) of an anchor above each point.
    thorough
        Whether points that no line carries are tried with more lines.
    """
    found = np.zeros(len(points), np.bool_)
    for reach in (min(_NEAR, reaches.ledge), reaches.ledge):
        left = np.flatnonzero(~found)
        found[left] = _sees_anchor(points[left], region[left], edges, reach, reaches.angle, climb[left])
    anchored = np.isin(region, np.unique(edges.region[edges.is_anchor]))
    longest = max(reaches.ledge, reaches.bridge, _STRAIGHT * reaches.bore)
    oblique = max(longest, _OBLIQUE * reaches.bore)
    for count, reach in (
        ((_FEW, longest), (_MORE, longest), (_MANY, oblique)) if thorough else ((_FEW, longest),)
    ):
        left = np.flatnonzero(~found & anchored)
        found[left] = _carried_by_lines(
            points[left], region[left], edges, reaches, climb[left], longest=reach, count=count
        )
    left = np.flatnonzero(~found & anchored)
    if thorough and len(left):
        inner = _away_from_rims(points[left], region[left], edges)
        both_sides = reaches._replace(ledge=-1.0)
        found[left] = _carried_by_lines(
            inner, region[left], edges, both_sides, climb[left], longest=oblique, count=_MORE
        )
    return found


def _away_from_rims(points: Floats, region: Int64s, edges: RegionEdges) -> Floats:
    """Move points that are near a border without anchor to `_RIM` from it."""
    moved, least = points.copy(), np.full(len(points), _RIM)
    rims = np.flatnonzero(edges.is_border & ~edges.is_anchor)
    for i, j in _pairs(_groups(points, region, edges, rims, _RIM)):
        foot, distance = _nearest(points[i], edges.start[j], edges.end[j])
        order = np.lexsort((distance, i))
        own, first = np.unique(i[order], return_index=True)
        row = order[first]
        near = (distance[row] < least[own]) & (distance[row] > 1e-9)
        own, row = own[near], row[near]
        way = (points[own] - foot[row])[:, :2] / distance[row][:, None]
        moved[own, :2] = foot[row][:, :2] + _RIM * way
    return moved


def _groups(points: Floats, region: Int64s, edges: RegionEdges, rows: Int64s, reach: float) -> list[_Group]:
    """Group points by region and square of the plan, with those of the edges `rows` that come within `reach`."""
    side = max(0.75 * reach, 1.0)
    square = np.floor(points[:, :2] / side).astype(np.int64)
    key = np.stack([region, square[:, 0], square[:, 1]])
    order = np.lexsort(key)
    changes = np.flatnonzero((np.diff(key[:, order], axis=1) != 0).any(axis=0)) + 1
    by_region = rows[np.argsort(edges.region[rows], kind="stable")]
    sorted_region = edges.region[by_region]
    low = np.minimum(edges.start, edges.end)[:, :2] - reach
    high = np.maximum(edges.start, edges.end)[:, :2] + reach
    groups = []
    for own in np.split(order, changes) if len(order) else []:
        first, last = np.searchsorted(sorted_region, [region[own[0]], region[own[0]] + 1])
        near = by_region[first:last]
        plan = points[own, :2]
        meets = (low[near] <= plan.max(axis=0)) & (high[near] >= plan.min(axis=0))
        groups.append(_Group(own, near[meets.all(axis=1)]))
    return groups


def _pairs(groups: Sequence[_Group]) -> Iterator[tuple[Int64s, Int64s]]:
    """Yield chunks of pairs of a point and an edge; all edges of a point are in the same chunk."""
    points: list[Int64s] = []
    edges: list[Int64s] = []
    total = 0
    for group in groups:
        most = max(CHUNK // max(len(group.edges), 1), 1)
        for at in range(0, len(group.points), most):
            own = group.points[at : at + most]
            if total and total + len(own) * len(group.edges) > CHUNK:
                yield np.concatenate(points), np.concatenate(edges)
                points, edges, total = [], [], 0
            points.append(np.repeat(own, len(group.edges)))
            edges.append(np.tile(group.edges, len(own)))
            total += len(points[-1])
    if total:
        yield np.concatenate(points), np.concatenate(edges)


def _sees_anchor(
    points: Floats, region: Int64s, edges: RegionEdges, reach: float, angle: float, climb: Floats
) -> Bools:
    """Tell from which points the nearest anchor is at most `reach` away and visible inside the region."""
    from amprep.kernels.overhangs.anchors import see_anchors

    seen = np.zeros(len(points), np.bool_)
    if len(points):
        regions = int(region.max()) + 1
        anchors, borders = (_segments_of(edges, rows, regions) for rows in (edges.is_anchor, edges.is_border))
        limits = (float(reach), float(np.tan(angle)), _SLACK)
        see_anchors(points, region, np.asarray(climb, np.float64), anchors, borders, limits, seen)
    return seen


def _segments_of(edges: RegionEdges, chosen: Bools, regions: int) -> "RegionSegments":
    """Return the chosen edges of the first regions, ordered by region and least x."""
    from amprep.kernels.overhangs.anchors import RegionSegments

    low = np.minimum(edges.start[:, 0], edges.end[:, 0])
    rows = np.flatnonzero(chosen & (edges.region < regions))
    rows = rows[np.lexsort((low[rows], edges.region[rows]))]
    first = np.searchsorted(edges.region[rows], np.arange(regions + 1))
    high = np.maximum(edges.start[rows, 0], edges.end[rows, 0])
    for begin, end in zip(first[:-1].tolist(), first[1:].tolist(), strict=True):
        np.maximum.accumulate(high[begin:end], out=high[begin:end])
    return RegionSegments(edges.start[rows], edges.end[rows], first, low[rows], high)


def _nearest(points: Floats, start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Return the point of each segment that is nearest in plan to its point, and the distance in plan."""
    along = end - start
    square = np.maximum((along[:, :2] ** 2).sum(axis=1), 1e-18)
    fraction = np.clip(((points - start)[:, :2] * along[:, :2]).sum(axis=1) / square, 0.0, 1.0)
    place = start + fraction[:, None] * along
    return place, np.hypot(*(place - points)[:, :2].T)


def _carried_by_lines(
    points: Floats,
    region: Int64s,
    edges: RegionEdges,
    reaches: Reaches,
    climb: Floats,
    *,
    longest: float,
    count: int,
) -> Bools:
    """Tell which points one of `count` lines carries."""
    found = np.zeros(len(points), np.bool_)
    groups = _groups(points, region, edges, np.flatnonzero(edges.is_border), longest)
    pairs = list(_pairs(groups))
    for angle in np.arange(count) * np.pi / count:
        direction = np.array([np.cos(angle), np.sin(angle)])
        ahead, back = _ends(points, edges, pairs, direction, reaches.angle)
        for end in (ahead, back):
            end.at_anchor[end.distance > longest] = False
            found |= end.at_anchor & (end.distance <= reaches.ledge) & (end.height - points[:, 2] <= climb)
        both = ahead.at_anchor & back.at_anchor
        both &= np.minimum(ahead.height, back.height) - points[:, 2] <= climb
        span = ahead.distance + back.distance
        found |= both & (span <= reaches.bridge)
        arches = np.flatnonzero(both & ~found & (span <= _OBLIQUE * reaches.bore))
        if len(arches):
            top = _top(points, arches, region, edges, direction, (ahead, back), reaches)
            rise = top - np.maximum(ahead.height, back.height)[arches]
            across = span[arches] * _straightness(edges, ahead.edge[arches], back.edge[arches], direction)
            found[arches] = _is_arch(across, rise, reaches)
    return found


def _ends(
    points: Floats,
    edges: RegionEdges,
    pairs: Sequence[tuple[Int64s, Int64s]],
    direction: Floats,
    angle: float,
) -> tuple[_Ends, _Ends]:
    """Return where the lines through all points in one direction leave the region, ahead and back."""
    normal = np.array([-direction[1], direction[0]])
    side = points[:, :2] @ normal
    side_start, side_end = edges.start[:, :2] @ normal, edges.end[:, :2] @ normal
    ends = [
        _Ends(
            np.full(len(points), np.inf),
            np.zeros(len(points)),
            np.zeros(len(points), np.int64),
            np.zeros(len(points), np.bool_),
        )
        for _ in range(2)
    ]
    for i, j in pairs:
        rows = np.flatnonzero((side_start[j] > side[i]) != (side_end[j] > side[i]))
        p, e = i[rows], j[rows]
        fraction = (side[p] - side_start[e]) / (side_end[e] - side_start[e])
        place = edges.start[e] + fraction[:, None] * (edges.end - edges.start)[e]
        at = (place[:, :2] - points[p, :2]) @ direction
        level = np.abs(place[:, 2] - points[p, 2]) <= np.abs(at) * np.tan(angle) + _SLACK
        for end, sign in zip(ends, (1.0, -1.0), strict=True):
            chosen = np.flatnonzero(level & (sign * at > 0.0))
            order = chosen[np.lexsort((np.abs(at[chosen]), p[chosen]))]
            own, first = np.unique(p[order], return_index=True)
            hit = order[first]
            end.distance[own], end.height[own] = np.abs(at[hit]), place[hit, 2]
            end.edge[own], end.at_anchor[own] = e[hit], edges.is_anchor[e[hit]]
    return ends[0], ends[1]


def _top(
    points: Floats,
    rows: Int64s,
    region: Int64s,
    edges: RegionEdges,
    direction: Floats,
    ends: tuple[_Ends, _Ends],
    reaches: Reaches,
) -> Floats:
    """Return the greatest height of the region along the lines through the points `rows`, between their ends."""
    normal = np.array([-direction[1], direction[0]])
    slope = np.tan(reaches.angle)
    own = points[rows]
    top = own[:, 2].copy()
    ahead, back = (each.distance[rows] for each in ends)
    groups = _groups(own, region[rows], edges, np.arange(len(edges.region)), _OBLIQUE * reaches.bore)
    for i, j in _pairs(groups):
        a, b = edges.start[j] - own[i], edges.end[j] - own[i]
        side_a, side_b = a[:, :2] @ normal, b[:, :2] @ normal
        cross = np.flatnonzero((side_a > 0.0) != (side_b > 0.0))
        fraction = side_a[cross] / (side_a - side_b)[cross]
        place = a[cross] + fraction[:, None] * (b - a)[cross]
        at, k = place[:, :2] @ direction, i[cross]
        within = (at < ahead[k]) & (at > -back[k]) & (np.abs(place[:, 2]) <= np.abs(at) * slope + _SLACK)
        np.maximum.at(top, k[within], (place[:, 2] + own[k, 2])[within])
    return top


def _straightness(edges: RegionEdges, ahead: Int64s, back: Int64s, direction: Floats) -> Floats:
    """Return the sine of the angle between lines and the anchors at their ends; 1 if these are not parallel."""
    one, other = ((edges.end - edges.start)[each, :2] for each in (ahead, back))
    one, other = (each / np.maximum(np.linalg.norm(each, axis=1), 1e-12)[:, None] for each in (one, other))
    parallel = np.abs((one * other).sum(axis=1)) >= _PARALLEL
    sine = np.abs(one[:, 0] * direction[1] - one[:, 1] * direction[0])
    return np.where(parallel, sine, 1.0)


def _is_arch(span: Floats, rise: Floats, reaches: Reaches) -> Bools:
    """Tell which lines are arches of at most the largest diameter; of two ways to measure it the smaller counts."""
    arc = (1.0 - np.cos(reaches.angle)) / (2.0 * np.sin(reaches.angle))
    high = np.maximum(rise, 1e-9)
    diameter = np.minimum(span / np.sin(reaches.angle), (span**2 / 4.0 + high**2) / high)
    return np.asarray((rise >= reaches.arch * arc * span) & (diameter <= reaches.bore))
