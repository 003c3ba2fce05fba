"""Regions for the supports of a part, and the columns of voxels in them, beside areas by manifold3d."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection
from tests.shared.examples import examples

from amprep.geometry.supports.territory import columns_of, territory_region
from amprep.geometry.voxels.grid import Grid

SQUARE = CrossSection.square((10.0, 10.0)).translate((10.0, 10.0))


def test_a_region_is_the_shadow_grown_by_the_margin_with_round_corners():
    region = territory_region(SQUARE, [], [], 2.0)
    assert region.area() == pytest.approx(100 + 80 + np.pi * 4, rel=0.01)


def test_without_a_margin_the_region_is_the_shadow_itself():
    assert territory_region(SQUARE, [], [], 0.0).area() == pytest.approx(100)


def test_shadows_of_others_are_left_out_where_they_are_not_in_the_own_shadow():
    other = CrossSection.square((10.0, 10.0)).translate((19.0, 10.0))
    region = territory_region(SQUARE, [other], [], 2.0)
    assert region.bounds()[2] == pytest.approx(20.0, abs=2.1)
    assert (region ^ other).area() == pytest.approx(10.0)  # the part of the own shadow below both


def test_boxes_are_left_out_even_in_the_own_shadow():
    box = CrossSection.square((3.0, 3.0)).translate((12.0, 12.0))
    assert territory_region(SQUARE, [], [box], 0.0).area() == pytest.approx(91)


@given(seed=st.integers(0, 2**32))
@examples(25)
def test_columns_are_whole_touched_or_centred_as_their_areas_and_axes_say(seed):
    rng = np.random.default_rng(seed)
    discs = [
        CrossSection.circle(r, 16).translate(c)
        for r, c in zip(rng.uniform(1, 4, 3), rng.uniform(0, 12, (3, 2)), strict=True)
    ]
    region = territory_region(discs[0] + discs[1], [discs[2]], [], float(rng.uniform(0, 2)))
    pitch = float(rng.uniform(0.7, 1.5))
    grid = Grid(np.array([*rng.uniform(-1, 1, 2), 0.0]), pitch, 1.0, (4, 9, 11))
    columns = columns_of(region, grid)
    for y, x in np.ndindex(9, 11):
        corner = grid.origin[:2] + np.array([x, y]) * pitch
        square = CrossSection.square((pitch, pitch)).translate(corner.tolist())
        share = (square ^ region).area() / pitch**2
        axis = (
            CrossSection.square((1e-4, 1e-4), center=True).translate((corner + pitch / 2).tolist()) ^ region
        )
        assert not columns.whole[y, x] or share > 0.99
        assert columns.whole[y, x] or share < 1.0 - 1e-9
        assert columns.touched[y, x] or share < 0.01
        assert not columns.touched[y, x] or share > 0.0
        assert columns.centred[y, x] == (axis.area() > 0.5e-8) or 0.01e-8 < axis.area() < 0.99e-8


def test_no_column_is_in_an_empty_region_or_beside_the_grid():
    grid = Grid(np.zeros(3), 1.0, 1.0, (4, 5, 6))
    assert not any(each.any() for each in columns_of(CrossSection(), grid))
    assert not any(each.any() for each in columns_of(SQUARE.translate((100.0, 0.0)), grid))
