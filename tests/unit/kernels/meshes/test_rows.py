"""Rows of lines cross triangles where the equations of line and plane say so, and adjacent triangles agree."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.kernels.meshes.rows import ends_in_row, slopes_of


@examples(100)
@given(st.integers(0, 10**6))
def test_the_slopes_are_those_of_the_plane_through_the_corners(seed):
    points = np.random.default_rng(seed).uniform(0, 3, (3, 3))
    flat = np.column_stack([points[:, :2], np.ones(3)])
    if abs(np.linalg.det(flat)) > 0.1:
        expected = np.linalg.solve(flat, points[:, 2])[:2]
        assert slopes_of(points, 0, 1, 2) == pytest.approx(tuple(expected), abs=1e-6)


def test_a_vertical_triangle_has_no_slopes():
    assert slopes_of(np.array([[0, 0, 0], [1, 1, 0], [0.5, 0.5, 2.0]]), 0, 1, 2) == (0.0, 0.0)


@examples(100)
@given(st.integers(0, 10**6))
def test_a_row_crosses_the_triangle_between_its_two_ends(seed):
    rng = np.random.default_rng(seed)
    points, y = rng.uniform(0, 3, (3, 3)), rng.uniform(-0.5, 3.5)
    ends = ends_in_row(points, np.array([[0, 1, 2]]), 0, y)
    crossings = sorted(
        a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        for a, b in zip(points, np.roll(points, -1, axis=0), strict=True)
        if (a[1] - y) * (b[1] - y) < 0
    )
    assert sorted(ends) == pytest.approx(crossings or [np.inf, np.inf])


@examples(100)
@given(st.integers(0, 10**6))
def test_triangles_agree_on_a_common_edge_to_the_last_bit(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 3, (4, 3))
    triangles = np.array([[0, 1, 2], [1, 0, 3]])
    low, high = sorted(points[:2, 1])
    y = rng.uniform(low, high)
    # the edge rises in one triangle and falls in the other
    up, down = (ends_in_row(points, triangles, t, y) for t in (0, 1))
    assert up[0] == down[1] or up[1] == down[0]
