"""Tips and perforation have the sections, heights and volumes that their rules say."""

import numpy as np
import pytest

from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.perforation import LINTEL, ROOF, SILL, WIDEST, perforations
from amprep.geometry.connectors.sites import Sites
from amprep.geometry.connectors.tips import ROUND_SIDES, TipProfile, grid_prisms, make_tips
from amprep.geometry.merging.union import union

SIDE = 2.0


def sites(count=2, lowest=8.0, width=0.4):
    """Return one site in the centre of each of `count` x `count` cells of one square."""
    y, x = np.divmod(np.arange(count * count), count)
    cell = SIDE / count
    lo = np.column_stack([x, y]) * cell
    level = np.full(len(x), lowest)
    one = np.ones(len(x))
    column, square = np.zeros(len(x), np.int64), np.column_stack([y, x])
    middle, every = lo + cell / 2, np.ones(len(x), np.bool_)
    return Sites(column, square, lo, lo + cell, middle, level, level, one, width * one, one, every, every)


def tips(profile, count=2, lowest=8.0):
    own = sites(count, lowest, profile.width)
    level = own.lowest - profile.height
    return make_tips(own, profile, level, np.zeros(count * count), level, 0.1)


def areas(solid, height):
    return sorted(abs(each.area()) for each in solid.slice(height).decompose())


def test_teeth_are_squares_of_the_width_at_the_part_and_taper_below_it():
    teeth = tips(TipProfile(0.4, 1.0, 0.0, 0.3, False))
    assert areas(teeth, 8.0) == pytest.approx([0.16] * 4, rel=1e-3)
    middle = (0.4 + 0.9 - 4e-4 * 0.9) / 2  # half way up, between the root and the width at the part
    assert areas(teeth, 7.5) == pytest.approx([middle**2] * 4, rel=0.07)
    assert areas(teeth, 3.0) == pytest.approx([SIDE**2], rel=2e-3), "below the shoulder the square is full"


def test_points_are_round_with_the_diameter_of_the_rule():
    area = ROUND_SIDES / 2 * 0.25**2 * np.sin(2 * np.pi / ROUND_SIDES)
    points = tips(TipProfile(0.5, 1.0, 0.0, 0.3, True))
    assert areas(points, 8.05) == pytest.approx([area] * 4, rel=1e-3)


def test_a_neck_is_below_the_contact_and_halfway_up_in_short_tips():
    assert areas(tips(TipProfile(0.6, 1.0, 0.2, 0.3, False)), 7.7) == pytest.approx([0.04] * 4, rel=1e-2)
    assert areas(tips(TipProfile(0.6, 0.4, 0.2, 0.3, False)), 7.8) == pytest.approx([0.04] * 4, rel=1e-2)


def test_no_sites_give_an_empty_solid():
    own, none = Sites(*(each[:0] for each in sites())), np.empty(0)
    assert make_tips(own, TipProfile(0.4, 1.0, 0.0, 0.3, False), none, none, none, 0.1).is_empty()


def test_prisms_over_a_grid_have_the_sum_of_their_volumes():
    own = sites(3)
    top = np.arange(9) + 1.0
    solid = grid_prisms(own.square, own.lo, own.hi, np.zeros(9), top)
    assert solid.volume() == pytest.approx((SIDE / 3) ** 2 * top.sum())


@pytest.mark.parametrize("wider", [0.0, 2e-3])
def test_prisms_of_equal_height_in_a_row_become_one(wider):
    """Five squares in two rows, with a gap in one of them; `wider` prisms overlap."""
    square = np.array([[0, 0], [0, 1], [0, 3], [1, 0], [1, 1]])
    lo = square[:, ::-1] * 1.0
    top = np.array([2.0, 2.0, 2.0, 2.0, 3.0])
    solid = grid_prisms(square, lo - wider, lo + 1.0 + wider, np.zeros(5), top)
    assert solid.volume() == pytest.approx(top.sum(), rel=8.0 * wider + 1e-9)
    assert [solid.slice(height).area() for height in (1.0, 2.5)] == pytest.approx(
        [5.0, 1.0], rel=8.0 * wider + 1e-9
    )
    flat = grid_prisms(square, lo - wider, lo + 1.0 + wider, np.zeros(5), np.full(5, 2.0))
    assert flat.num_tri() <= 36, "three boxes: two of two squares, and one of one"


def columns(count):
    x = np.arange(count)
    lo = np.column_stack([x * SIDE, 0 * x, 0 * x]).astype(float)
    square = np.column_stack([0 * x, x])
    return ConnectorColumns(lo, lo + (SIDE, SIDE, 9.0), square, np.array([0.0, 0.0, SIDE]), (1, count))


@pytest.mark.parametrize("width", [0.5, 0.8, 5.0])
def test_openings_are_as_many_as_fit_and_join_along_a_row(width):
    height, used = 4.0, min(width, WIDEST * SIDE)
    along, across = perforations(columns(3), np.full(3, height), width)
    rows = int((height - LINTEL) / (used * ROOF + SILL))
    diamond = used * used * ROOF / 2
    assert len(along.decompose()) == rows, "three squares form one channel per row"
    assert along.volume() == pytest.approx(rows * diamond * 3 * SIDE, rel=0.01)
    assert len(across.decompose()) == 3 * rows
    assert along.bounding_box()[2] == pytest.approx(SILL)
    assert along.bounding_box()[5] <= height - LINTEL + 1e-9


def test_squares_without_room_have_no_openings():
    assert list(perforations(columns(2), np.zeros(2), 0.5)) == []
    along, _ = perforations(columns(3), np.array([4.0, 0.0, 4.0]), 0.8)
    assert len({each.bounding_box()[0] for each in along.decompose()}) == 2
    assert not union([along]).is_empty()
