"""Thin rests of sections, against shapes of known width."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from manifold3d import CrossSection, JoinType, OpType
from tests.shared.examples import examples

from amprep.geometry.supports.narrow_ends import narrow_ends
from amprep.geometry.supports.outlines import contours_of
from amprep.geometry.supports.thin_rests import find_thin_rests

WIDTH, AREA = 0.28, 0.07


def nowhere(points):
    return np.zeros(len(points), np.bool_)


def rests(region, is_kept=lambda _: False, are_held=nowhere):
    """The rests, which may overlap, as one region."""
    contours = contours_of(region)
    ends = narrow_ends(contours, WIDTH, AREA)
    ends = ends[~are_held(ends)]
    return CrossSection.batch_boolean(
        find_thin_rests(contours, ends, WIDTH, AREA, is_kept, are_held), OpType.Add
    )


def rectangle(width, length, turn=0.0, at=(0.0, 0.0)):
    return CrossSection.square((length, width)).rotate(turn).translate(at)


@given(
    width=st.floats(0.02, 1.0).filter(lambda width: abs(width - WIDTH) > 0.02),
    length=st.floats(1.5, 12.0),
    turn=st.floats(0.0, 360.0),
)
@examples(40)
def test_a_strip_is_a_rest_exactly_if_it_is_narrower_than_the_width(width, length, turn):
    found = rests(rectangle(width, length, turn))
    assert found.area() == pytest.approx(width * length if width < WIDTH else 0.0, rel=0.05)


@given(width=st.floats(0.03, 0.2), length=st.floats(1.0, 9.0), turn=st.floats(0.0, 360.0))
@examples(30)
def test_of_a_block_with_a_fin_only_the_fin_is_a_rest(width, length, turn):
    block = CrossSection.square((3.0, 3.0)).translate((-3.0, -1.0))
    fin = rectangle(width, length + 0.1, at=(-0.1, 0.0))
    left = (block + fin).rotate(turn)
    left -= rests(left)
    assert left.area() >= 9.0 - 1e-3
    assert left.area() <= 9.0 + width * 2.0 * WIDTH + 1e-2


@given(width=st.floats(0.03, 0.9).filter(lambda width: abs(width - WIDTH) > 0.02), turn=st.floats(0.0, 360.0))
@examples(30)
def test_a_waist_between_two_blocks_is_a_rest_exactly_if_it_is_narrower_than_the_width(width, turn):
    blocks = CrossSection.square((3.0, 3.0)).translate((-3.0, -1.0)) + CrossSection.square(
        (3.0, 3.0)
    ).translate((4.0, -1.0))
    waist = rectangle(width, 4.2, at=(-0.1, 0.0))
    left = (blocks + waist).rotate(turn)
    left -= rests(left)
    kept = 18.0 + (width * 4.0 if width > WIDTH else 0.0)
    assert kept - 1e-2 <= left.area() <= kept + (width < WIDTH) * width * 4.0 * WIDTH + 1e-2


def test_a_bridge_that_tapers_to_a_waist_is_a_rest():
    block = CrossSection.square((2.0, 2.0))
    sliver = CrossSection([np.array([[-2.0, 0.0], [0.1, 0.0], [0.1, 0.02], [-0.4, 0.04], [-2.0, 0.5]])])
    left = block + sliver
    left -= rests(left).offset(1e-3)
    assert len(left.decompose()) == 2


@pytest.mark.parametrize("sides", [3, 4, 6, 40])
def test_wide_shapes_with_and_without_holes_have_no_rests(sides):
    region = CrossSection.circle(2.0, sides) - CrossSection.circle(0.4, sides)
    assert rests(region).is_empty()


def test_a_piece_that_is_wide_enough_but_too_small_is_a_rest():
    region = contours_of(CrossSection.square((0.29, 0.29)) + rectangle(1.0, 1.0, at=(2.0, 0.0)))
    ends = narrow_ends(region, WIDTH, 0.09)
    (found,) = find_thin_rests(region, ends, WIDTH, 0.09, lambda _: False, nowhere)
    assert found.area() == pytest.approx(0.29**2)


def test_rests_that_may_stay_are_left_out():
    strips = rectangle(0.1, 2.0) + rectangle(0.1, 2.0, at=(0.0, 5.0))
    found = rests(strips, lambda piece: piece.bounds()[1] > 4.0)
    assert found.area() == pytest.approx(0.2)
    assert found.bounds()[3] < 1.0


def test_thin_pieces_with_all_ends_where_they_may_stay_are_left_out():
    strips = rectangle(0.1, 2.0) + rectangle(0.1, 2.0, at=(0.0, 5.0))
    upper = contours_of(rectangle(1.0, 3.0, at=(-0.5, 4.5)))
    found = rests(strips, are_held=upper.cover)
    assert found.area() == pytest.approx(0.2)
    assert found.bounds()[3] < 1.0


@given(x=st.floats(-3.0, 3.0), y=st.floats(-3.0, 3.0))
@examples(40)
def test_a_ring_covers_the_points_between_its_circles(x, y):
    ring = contours_of(CrossSection.circle(2.0, 400) - CrossSection.circle(1.0, 400))
    radius = float(np.hypot(x, y))
    assume(min(abs(radius - 1.0), abs(radius - 2.0)) > 0.01)
    assert ring.cover(np.array([[x, y]])).tolist() == [1.0 < radius < 2.0]


@pytest.mark.parametrize(
    ("kept", "is_rest"), [(0.15, True), (0.23, True), (0.26, True), (0.32, False), (0.46, False)]
)
def test_what_a_border_leaves_of_a_round_pin_is_a_rest_if_it_is_thinner_than_the_width(kept, is_rest):
    half = 0.23
    pin = CrossSection.circle(half / np.cos(np.pi / 8), 8).rotate(22.5)
    left = pin ^ rectangle(1.0, kept, at=(half - kept, -0.5))
    assert (left - rests(left)).is_empty() == is_rest


@pytest.mark.parametrize("neck", [0.3, 0.6, 0.8, 1.0, 1.5, 4.0])
@pytest.mark.parametrize("thickness", [0.05, 0.15, 0.25])
def test_necks_are_rests_as_far_as_discs_at_their_ends_do_not_cover_them(neck, thickness):
    region = rectangle(2.0, 2.0) + rectangle(thickness, neck + 1.0, at=(1.5, 0.7))
    region += rectangle(2.0, 2.0, at=(2.0 + neck, 0.0))
    discs = region.offset(-WIDTH / 2.0)
    expected = region - discs.offset(1.8 * WIDTH, JoinType.Round, 2.0, 64)
    assert rests(region).area() == pytest.approx(expected.area(), rel=0.05, abs=0.02)


def test_a_thin_piece_beside_a_wide_one_is_a_rest():
    strip = rectangle(0.1, 1.5, at=(0.0, 2.1))
    assert rests(rectangle(2.0, 2.0) + strip).area() == pytest.approx(strip.area())


def test_pins_beside_many_fins_stay_whole():
    pads = [rectangle(1.0, 1.0, at=(x, 0.0)) for x in np.arange(0.0, 40.0, 2.0)]
    fins = [
        rectangle(3.1, 0.05, at=(x + 0.3, 0.9)) + rectangle(0.15, 0.4, at=(x + 0.3, 2.9))
        for x in np.arange(0.0, 40.0, 2.0)
    ]
    pins = [
        rectangle(0.5, 0.5, at=(x, y + 0.37 * x % 0.63))
        for x in np.arange(0.0, 40.0, 0.8)
        for y in np.arange(-7.0, -2.0, 0.63)
    ]
    region = CrossSection.batch_boolean(pads + fins + pins, OpType.Add)
    left = region - rests(region)
    assert (left ^ CrossSection.batch_boolean(pins, OpType.Add)).area() == pytest.approx(0.25 * len(pins))
    assert left.area() < 0.25 * len(pins) + 20.0 * (1.0 + 0.05 * 2.0 * WIDTH)
