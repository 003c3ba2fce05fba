"""Triangles split at points on their edges: the same area, and no point left inside an edge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from amprep.geometry.merging.t_junctions import split_at_points, split_on_grid_lines
from amprep.geometry.merging.voxel_contents import RESOLUTION


def area(points, triangles):
    corners = points[triangles].astype(float)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0) / 2


def edges(triangles):
    return {frozenset((row[a], row[b])) for row in triangles.tolist() for a, b in ((0, 1), (1, 2), (2, 0))}


def test_known_splits_are_applied_to_the_halves_too():
    points = np.array([[0, 0, 0], [8, 0, 0], [0, 8, 0], [4, 0, 0], [2, 0, 0]])
    triangles = split_at_points(np.array([[0, 1, 2]]), np.array([[0, 1, 3], [3, 0, 4]]), len(points))
    assert len(triangles) == 3
    assert {frozenset((0, 4)), frozenset((4, 3)), frozenset((3, 1))} <= edges(triangles)
    assert area(points, triangles) == pytest.approx([0, 0, 32])


def test_without_splits_nothing_changes():
    triangles = np.array([[0, 1, 2]])
    assert split_at_points(triangles, np.empty((0, 3), np.int64), 3) is triangles


@given(
    st.integers(0, 2), st.lists(st.integers(1, RESOLUTION - 1), max_size=8, unique=True), st.integers(0, 5)
)
def test_an_edge_on_a_grid_line_is_split_at_every_used_point_of_the_line(axis, places, inner):
    """One triangle has an edge on the line from voxel corner to voxel corner; others use the points between."""
    other = (axis + 1) % 3
    shared = np.zeros((3 + len(places), 3), np.int64)
    shared[1, axis] = shared[2, other] = RESOLUTION
    shared[3:, axis] = places
    fan = [[2, 3 + k, 2] for k in range(len(places))]  # degenerate, so that they add no area
    triangles = split_on_grid_lines(np.array([[0, 1, 2], *fan]) + inner, shared, inner)
    line = [0, *(3 + np.argsort(places)).tolist(), 1]
    assert {frozenset((a + inner, b + inner)) for a, b in zip(line, line[1:], strict=False)} <= edges(
        triangles
    )
    assert frozenset((inner, inner + 1)) not in edges(triangles) or not places
    points = np.concatenate([np.zeros((inner, 3), np.int64), shared])
    assert np.abs(area(points, triangles)).max() == pytest.approx(RESOLUTION**2 / 2)
