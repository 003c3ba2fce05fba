"""Cutting away thin rests of supports, judged by volumes."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.geometry.connectors.least_width import LeastSection
from amprep.supports.solids.thin_rests import without_thin_rests

LEAST = LeastSection(0.3, 0.09)


def box(lo, hi):
    return Manifold.cube(np.subtract(hi, lo).tolist()).translate(list(lo))


def cut(solid, parts=(), tip_height=0.0):
    return without_thin_rests(solid, parts, LEAST, tip_height)


BLOCK = box((0, 0, 0), (3, 3, 10))


def test_a_support_that_is_thick_everywhere_stays_as_it_is():
    assert cut(BLOCK) is BLOCK


@pytest.mark.parametrize("turn", [0.0, 33.0])
def test_an_upright_fin_is_cut_away_and_the_block_beside_it_stays(turn):
    fin = box((2.9, 1, 0), (6, 1.1, 10))
    left = cut((BLOCK + fin).rotate((0.0, 0.0, turn)))
    beyond = left - BLOCK.rotate((0.0, 0.0, turn))
    assert left.volume() >= BLOCK.volume() - 0.05
    assert beyond.volume() < 0.2 * fin.volume()


def test_an_oblique_needle_is_cut_away_along_its_whole_length():
    needle = box((4, 1, 0), (4.15, 1.15, 9)).transform([[1, 0, 0.8, 0], [0, 1, 0, 0], [0, 0, 1, 0]])
    left = cut(BLOCK + needle)
    assert (left - BLOCK).volume() < 0.01 * needle.volume()


def test_a_short_thin_end_between_the_even_sections_is_found():
    end = box((5, 0, 0), (7, 2, 3)) + box((5.5, 0.5, 2.9), (5.6, 1.5, 3.25))
    left = cut(BLOCK + end)
    assert left.bounding_box()[5] == 10.0
    assert (left ^ box((5.4, 0.4, 3.02), (5.7, 1.6, 3.3))).volume() < 0.005


def test_a_thin_place_so_low_that_the_sections_around_it_miss_it_is_cut_away():
    crumb = box((2.9, 1, 4.6), (6, 1.1, 4.64))
    left = cut(BLOCK + crumb)
    assert (left - BLOCK).volume() < 0.2 * (crumb - BLOCK).volume()


def test_what_touches_a_part_stays():
    part = box((5.1, 0, 0), (8, 3, 10))
    sliver = box((5, 0, 0), (5.11, 3, 10))
    assert cut(BLOCK + sliver, [part]).volume() == pytest.approx((BLOCK + sliver).volume())


@pytest.mark.parametrize(("width", "stays"), [(0.15, True), (0.05, False)])
def test_tips_below_a_part_may_be_thinner_but_not_below_a_tenth(width, stays):
    tip = box((1, 1, 9.9), (1 + width, 1 + width, 10.5))
    part = box((0, 0, 10.5), (3, 3, 12))
    left = cut(BLOCK + tip, [part], tip_height=0.6)
    rest = (left ^ box((0, 0, 10.1), (3, 3, 10.4))).volume()
    assert rest == pytest.approx(0.3 * width**2 if stays else 0.0, abs=1e-6)


def test_nothing_is_left_of_a_support_that_is_thin_everywhere():
    assert cut(box((0, 0, 0), (0.1, 4, 10))).is_empty()
