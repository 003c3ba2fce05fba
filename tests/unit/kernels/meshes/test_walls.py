"""The horizontal distance to walls agrees with plain loops over all points and walls."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.supports.walls import PartWalls, wall_distance

SLACK = 0.01


def section(triangle, z):
    """Return the ends in plan of the section of a triangle at a height, or None."""
    ends = []
    for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
        if (a[2] <= z < b[2]) or (b[2] <= z < a[2]):
            ends.append((a + (z - a[2]) / (b[2] - a[2]) * (b - a))[:2])
    return ends if len(ends) == 2 else None


def nearest(point, walls, reach):
    """Return the distance to the nearest wall within reach, the obvious way."""
    best = np.inf
    for triangle, outward in zip(walls.corners, walls.outward, strict=True):
        if not triangle[:, 2].min() + SLACK <= point[2] <= triangle[:, 2].max() - SLACK:
            continue
        ends = section(triangle, point[2])
        if ends is None:
            continue
        a, along = ends[0], ends[1] - ends[0]
        place = a + np.clip(np.dot(point[:2] - a, along) / max(np.dot(along, along), 1e-300), 0, 1) * along
        away = point[:2] - place
        if np.linalg.norm(away) < min(best, reach) and np.dot(away, outward) > SLACK:
            best = float(np.linalg.norm(away))
    return best


@examples(30)
@given(st.integers(0, 10**6), st.floats(0.3, 3.0))
def test_the_nearest_wall_is_that_of_plain_loops(seed, reach):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(0, 4, (6, 3, 3))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, :2]
    walls = PartWalls(corners, normal / np.linalg.norm(normal, axis=1)[:, None])
    points = rng.uniform(-1, 5, (40, 3))
    away, foot = wall_distance(points, walls, reach, SLACK)
    assert np.allclose(away, [nearest(point, walls, reach) for point in points])
    near = np.isfinite(away)
    assert np.allclose(np.linalg.norm(points[near] - foot[near], axis=1), away[near])
    assert (points[near, 2] == foot[near, 2]).all()
