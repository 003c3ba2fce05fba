"""Anchors are seen exactly where a plain search over all edges sees them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.checks.overhangs.borders import RegionEdges
from amprep.checks.overhangs.lines import _sees_anchor

ANGLE, SLACK = 0.7, 0.05


def crossing(point, foot, start, end):
    """Fractions along the way to the foot and along the edge at which they cross in plan, or None."""
    way, edge = (foot - point)[:2], (end - start)[:2]
    turn = way[0] * edge[1] - way[1] * edge[0]
    if abs(turn) < 1e-12:
        return None
    from_point = (start - point)[:2]
    along = (from_point[0] * edge[1] - from_point[1] * edge[0]) / turn
    return along, (from_point[0] * way[1] - from_point[1] * way[0]) / turn


def sees(point, region, edges, reach, climb):
    feet = []
    for row in np.flatnonzero((edges.region == region) & edges.is_anchor):
        start, end = edges.start[row], edges.end[row]
        along = np.clip(
            (point - start)[:2] @ (end - start)[:2] / ((end - start)[:2] @ (end - start)[:2]), 0, 1
        )
        foot = start + along * (end - start)
        away, rise = np.hypot(*(foot - point)[:2]), foot[2] - point[2]
        if away <= reach and abs(rise) <= away * np.tan(ANGLE) + SLACK and rise <= climb:
            feet.append((away, foot))
    if not feet:
        return False
    away, foot = min(feet, key=lambda each: each[0])
    for row in np.flatnonzero((edges.region == region) & edges.is_border):
        start, end = edges.start[row], edges.end[row]
        met = crossing(point, foot, start, end)
        if met is None or not 0.0 <= met[1] <= 1.0:
            continue
        height = (start + met[1] * (end - start))[2] - (point + met[0] * (foot - point))[2]
        if met[0] > 0.0 and met[0] * away < away - 0.01 and abs(height) <= SLACK + met[0] * away:
            return False
    return True


@given(st.integers(0, 10**6), st.floats(0.1, 3.0))
@examples(30)
def test_anchors_are_seen_where_a_plain_search_sees_them(seed, reach):
    rng = np.random.default_rng(seed)
    points, start = (rng.uniform((0, 0, 0), (6, 6, 0.4), (size, 3)) for size in (30, 24))
    edges = RegionEdges(
        start,
        start + rng.normal(0.0, 1.0, start.shape) * (1.0, 1.0, 0.1),
        rng.integers(0, 3, len(start)),
        rng.random(len(start)) < 0.8,
        rng.random(len(start)) < 0.5,
    )
    region, climb = rng.integers(0, 3, len(points)), rng.choice([0.05, np.inf], len(points))
    seen = _sees_anchor(points, region, edges, reach, ANGLE, climb)
    expected = [sees(points[i], region[i], edges, reach, climb[i]) for i in range(len(points))]
    assert seen.tolist() == expected
