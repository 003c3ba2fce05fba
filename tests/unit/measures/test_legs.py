"""Legs of solids that are known by hand, and the same verdict as slices of manifold3d."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold, OpType
from tests.shared.examples import examples
from tests.shared.legs import sliced_legs
from tests.shared.solids import mesh_of

from amprep.measures.legs import legs_of, long_stretches


def block(low, size):
    return Manifold.cube([float(s) for s in size]).translate([float(x) for x in low])


def table(*more, height=30, length=20):
    """Two legs, 1 mm wide, from a plate to a board."""
    legs = block((0, 0, 1), (1, 1, height)) + block((length - 1, 0, 1), (1, 1, height))
    boards = block((0, 0, 0), (length, 1, 2)) + block((0, 0, height), (length, 1, 2))
    return Manifold.batch_boolean([legs, boards, *more], OpType.Add)


def worst(solid, *parts):
    found = legs_of(mesh_of(solid), 1.0, 10.0, parts).worst
    assert found is not None
    return found


def test_a_leg_is_as_long_as_the_height_between_its_ends_and_as_wide_as_its_hull():
    found = legs_of(mesh_of(table()), 1.0, 10.0)
    assert found.total == 2
    assert len(found.too_long) == 2
    _, length, width, (x, y, z) = worst(table())
    assert length == pytest.approx(28, abs=2)
    assert width == pytest.approx(1.0, rel=1e-3)
    assert min(abs(x - 0.5), abs(x - 19.5)) < 1e-6
    assert y == pytest.approx(0.5)
    assert z == pytest.approx(16, abs=1.5)


def test_a_brace_and_a_part_divide_a_leg_and_an_end_in_the_air_does_not():
    brace = block((0, 0, 15), (20, 1, 1))
    assert worst(table(brace)).length_mm == pytest.approx(14, abs=2)
    stub = block((0.5, 0, 15), (3, 1, 1)) + block((2.5, 0, 15), (1, 1, 2))
    assert worst(table(stub)).length_mm == pytest.approx(28, abs=2)
    part = mesh_of(block((2, -2, 16.5), (5, 5, 5)))
    held = legs_of(mesh_of(table(stub)), 1.0, 10.0, [part])
    assert held.total == 3
    assert len(held.too_long) == 3


def test_windows_do_not_divide_a_leg():
    windows = [block((0.4, -1, z + 0.2), (0.2, 3, 0.6)) for z in range(3, 28)]
    pierced = table() - Manifold.batch_boolean(windows, OpType.Add)
    assert worst(pierced).length_mm == pytest.approx(28, abs=2)


def test_a_wide_foot_does_not_excuse_a_narrow_top():
    foot = block((-2, -2, 0), (5, 5, 12))
    found = legs_of(mesh_of(table(foot)), 1.0, 10.0)
    assert found.total == 2
    assert len(found.too_long) == 2
    assert found.too_long[1].length_mm == pytest.approx(18, abs=2)


def test_a_bend_makes_no_leg_wider():
    bend = block((-1, 0, 14), (3, 3, 1.5))
    _, length, width, _ = worst(table(bend))
    assert (length, width) == pytest.approx((28, 1), abs=2)
    assert worst(table(bend)).ratio > 20


def test_a_limit_of_zero_is_none_and_a_solid_without_legs_has_no_worst():
    assert legs_of(mesh_of(table()), 1.0, 0.0).too_long == ()
    assert legs_of(mesh_of(block((0, 0, 0), (3, 3, 1.2))), 1.0, 10.0) == (0, None, ())


COLUMN = st.tuples(st.integers(0, 5), st.integers(0, 5), st.integers(0, 8), st.integers(1, 14))


@given(st.lists(COLUMN, min_size=1, max_size=7))
@examples(40)
def test_no_leg_of_slices_has_a_larger_ratio_than_the_worst_that_is_measured(columns):
    blocks = [block((3 * x, 3 * y, z), (3, 3, height)) for x, y, z, height in columns]
    solid = Manifold.batch_boolean(blocks, OpType.Add)
    measured = legs_of(mesh_of(solid), 1.0, 0.0)
    sliced = sliced_legs(solid, np.arange(0.31, 24, 1.0))
    largest = measured.worst.ratio if measured.worst else 1.0
    assert max(sliced, default=0.0) <= largest + 2 / 3 + 0.05, "slabs differ by at most one slice at each end"


def test_posts_that_touch_along_an_edge_only_are_legs_of_their_own():
    posts = block((0, 0, 0), (1, 1, 24)) + block((1, 1, 0), (1, 1, 24))
    slab = block((0, 0, 24), (20, 20, 2))
    found = legs_of(mesh_of(posts + slab), 1.0, 10.0)
    assert [round(leg.width_mm, 2) for leg in found.too_long] == [1.0, 1.0]


def test_boxes_around_long_stretches_contain_the_leg_and_nothing_else():
    (first, second) = long_stretches(mesh_of(table()), 1.0, 10.0, ())
    for boxes, low in zip(sorted([first, second], key=lambda each: each[0, 0, 0]), (0.0, 19.0), strict=True):
        np.testing.assert_allclose(boxes[:, 0, 0], low)
        np.testing.assert_allclose(boxes[:, 1, 0], low + 1.0)
        assert np.ptp(boxes[:, :, 2]) == pytest.approx(28, abs=2)
    assert long_stretches(mesh_of(table()), 1.0, 40.0, ()) == []
