"""Surfaces that are too narrow for connectors are left out, and held by posts where nothing else holds them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.connectors.columns import ConnectorColumns, clip_to_columns
from amprep.geometry.connectors.least_width import LeastSection, find_posts, find_wide
from amprep.geometry.connectors.sites import areas_in_plan

PITCH, SHAPE = 2.0, (8, 8)
LEAST = LeastSection(0.3, 0.09)


def columns(step=None):
    """A column above each square of a grid; `step` raises the base of the squares from that x on."""
    square = np.argwhere(np.ones(SHAPE)).astype(np.int64)
    low = np.column_stack([square[:, ::-1] * PITCH, np.where(square[:, 1] >= (step or 99), 4.0, 2.0)])
    high = np.column_stack([low[:, :2] + PITCH, np.full(len(square), 20.0)])
    return ConnectorColumns(low, high, square, np.array([0.0, 0.0, PITCH]), SHAPE)


def level(lo, hi, z=10.0):
    """A level rectangle that faces down, as two triangles."""
    (x0, y0), (x1, y1) = lo, hi
    corners = np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]])
    return corners[[[0, 2, 1], [0, 3, 2]]]


def clipped(where, *rectangles):
    corners = np.concatenate([level(*each) for each in rectangles])
    return clip_to_columns(where, corners, np.arange(len(corners)), np.ones(len(where.lo), np.bool_))


def wide_area(patches, where):
    return float(areas_in_plan(patches)[0][find_wide(patches, where, LEAST)].sum())


def test_a_strip_that_crosses_into_a_row_of_squares_by_less_than_the_least_wall_is_left_out_there():
    """The squares of the second row have a base of their own, so a connector there would be a sheet of 0.1 mm."""
    where = columns(step=2)
    patches = clipped(where, ((0.0, 0.0), (4.1, 8.0)))
    assert wide_area(patches, where) == pytest.approx(4.0 * 8.0)


def test_a_strip_beside_wide_squares_with_the_same_base_is_kept_as_far_as_it_is_wide():
    where = columns()
    patches = clipped(where, ((0.0, 0.0), (4.1, 8.0)))
    assert wide_area(patches, where) == pytest.approx(4.1 * 8.0)


def test_a_band_of_the_least_wall_across_a_grid_line_is_kept():
    where = columns()
    patches = clipped(where, ((3.8, 1.0), (4.2, 7.0)))
    assert wide_area(patches, where) == pytest.approx(0.4 * 6.0)


def test_a_narrow_tail_of_a_wide_surface_ends_in_the_square_in_which_it_is_wide():
    where = columns()
    patches = clipped(where, ((0.0, 0.0), (4.0, 4.0)), ((4.0, 0.0), (10.0, 0.2)))
    owner = patches.owner[find_wide(patches, where, LEAST), 0]
    assert set(where.square[owner, 1]) == {0, 1}


def test_a_surface_that_is_narrow_everywhere_is_held_by_one_post_in_each_square():
    where = columns()
    patches = clipped(where, ((1.0, 3.0), (9.0, 3.1)))
    wide = find_wide(patches, where, LEAST)
    posts = find_posts(patches, wide, where, LEAST)
    assert not wide.any()
    assert sorted(where.square[posts.column].tolist()) == [[1, x] for x in range(5)]
    assert ((posts.hi - posts.lo) >= 0.3).all()
    assert posts.top == pytest.approx(10.0)
    assert (posts.lo >= where.lo[posts.column, :2]).all()
    assert (posts.hi <= where.hi[posts.column, :2]).all()


def test_there_is_no_post_where_a_narrow_surface_only_grazes_a_square():
    where = columns()
    patches = clipped(where, ((1.0, 3.0), (4.001, 3.1)))
    posts = find_posts(patches, find_wide(patches, where, LEAST), where, LEAST)
    assert sorted(where.square[posts.column, 1].tolist()) == [0, 1]


@examples(60)
@given(st.floats(0.0, 14.0), st.floats(0.0, 14.0), st.floats(0.02, 6.0), st.floats(0.02, 6.0))
def test_a_rectangle_is_kept_if_both_sides_are_as_wide_as_the_least_wall_and_else_gets_posts(
    x, y, wide, deep
):
    """The rectangle is inside the grid, and all squares have one base."""
    where = columns()
    patches = clipped(where, ((x, y), (min(x + wide, 16.0), min(y + deep, 16.0))))
    sides = min(x + wide, 16.0) - x, min(y + deep, 16.0) - y
    if abs(min(sides) - LEAST.width) < 0.01 or abs(np.prod(sides) - LEAST.area) < 0.005:
        return
    kept = find_wide(patches, where, LEAST)
    enough = min(sides) > LEAST.width and np.prod(sides) > LEAST.area
    assert bool(kept.any()) == enough
    assert bool(len(find_posts(patches, kept, where, LEAST).column)) != enough


def test_known_footprints_are_not_measured_again():
    """Of two footprints one is as before, and one has lost a square."""
    where = columns()
    patches = clipped(where, ((0.0, 0.0), (4.1, 8.0)), ((8.1, 0.0), (12.0, 8.0)))
    known: dict[bytes, np.ndarray] = {}
    before = find_wide(patches, where, LEAST, known)
    assert len(known) == 2
    assert (before == find_wide(patches, where, LEAST)).all()
    fewer = patches.chosen(patches.owner[:, 0] != patches.owner[-1, 0])
    assert (find_wide(fewer, where, LEAST, known) == find_wide(fewer, where, LEAST)).all()
    assert len(known) == 3
