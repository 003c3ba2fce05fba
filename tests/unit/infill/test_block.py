"""Cells cover a region and reach beyond it by the overlap at least."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.infill.block import block_over, default_size
from amprep.testing.problems import box_mesh


def request(low, high, size, height, overlap=0.1):
    region = box_mesh(low, high)
    return block_over(region, size=size, height=height, overlap=overlap, part=region)


def boxes(made):
    """Return the least and greatest corner of each cell."""
    grid, edges = made.grid, made.edges
    size = np.array([grid.pitch, grid.pitch, grid.step])
    low = grid.origin + np.column_stack([edges.x, edges.y, edges.plane - 1]) * size
    return low, low + size


def test_a_region_of_whole_cells_is_centred_in_the_grid():
    made = request((0, 0, 0), (6, 6, 6), 2.0, 2.0)
    low, _ = boxes(made)
    assert (low % 2.0 == 0.0).all(), "cells meet at the sides of the region"
    assert len(low) == 5**3, "one more cell on each side, for the overlap"
    assert made.edges.plane.min() == 1


@examples(30)
@given(
    st.lists(st.floats(3, 12), min_size=3, max_size=3),
    st.floats(1, 4),
    st.floats(1, 4),
    st.floats(0.05, 0.4),
)
def test_points_within_the_overlap_of_a_region_are_in_a_cell(extent, size, height, overlap):
    low, high = boxes(request((1, 2, 3), np.array([1, 2, 3]) + extent, size, height, overlap))
    rng = np.random.default_rng(1)
    points = rng.uniform(np.array([1, 2, 3]) - overlap, np.array([1, 2, 3]) + extent + overlap, (50, 3))
    inside = ((points[:, None] >= low - 1e-9) & (points[:, None] <= high + 1e-9)).all(axis=2)
    assert inside.any(axis=1).all()


def test_the_default_size_is_a_third_of_small_regions():
    assert default_size([box_mesh((0, 0, 0), (30, 30, 30))]) == 5.0
    assert default_size(
        [box_mesh((0, 0, 0), (30, 30, 30)), box_mesh((0, 0, 0), (30, 6, 30))]
    ) == pytest.approx(2)
