"""Outlines contain the region, and lose only what nothing can enter at the clearance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, JoinType
from tests.shared.examples import examples
from tests.shared.plates import region_of, star

from amprep.geometry.plates.outline import closed, outline_of, rectangle, signed_area


def bounds_of(region):
    x0, y0, x1, y1 = region.bounds()
    return np.array([x0, y0]), np.array([x1, y1])


def outlined(region, clearance, tolerance=0.01):
    low, high = bounds_of(region)
    return outline_of(region, low, high, clearance, tolerance)


@examples(30)
@given(seed=st.integers(0, 10**6), clearance=st.sampled_from([0.0, 0.5, 2.0]))
def test_points_at_the_clearance_are_the_same_before_and_after(seed, clearance):
    region = CrossSection([star(np.random.default_rng(seed), 12, 10.0)])
    filled = closed(region, clearance)
    assert (region - filled).area() < 1e-6
    wider = [each.offset(clearance, JoinType.Round, 2.0, 256).area() for each in (region, filled)]
    assert wider[1] == pytest.approx(wider[0], rel=1e-3)


def test_a_hole_that_a_part_can_enter_stays_and_a_small_one_is_filled():
    plate = CrossSection.square((30.0, 30.0))
    holes = CrossSection.circle(5.0, 64).translate((10.0, 10.0)) + CrossSection.circle(1.0, 64).translate(
        (22.0, 22.0)
    )
    found = outlined(plate - holes, 2.0)
    assert sorted(signed_area(loop) > 0.0 for loop in found.loops) == [False, True]
    assert found.area == pytest.approx(900.0 - np.pi * 25.0, rel=1e-2)


def test_an_outline_is_around_its_centre_and_contains_the_region():
    region = CrossSection([star(np.random.default_rng(3), 30, 10.0)]).translate((40.0, -7.0))
    found, (low, high) = outlined(region, 0.5), bounds_of(region)
    assert np.allclose(found.half, (high - low) / 2.0)
    assert (region - region_of(found, (low + high) / 2.0)).area() < 1e-4
    assert found.is_connected
    assert CrossSection([found.hull]).area() == pytest.approx(region_of(found).hull().area(), rel=1e-6)


def test_two_components_are_not_connected():
    assert not outlined(
        CrossSection.square((1.0, 1.0)) + CrossSection.square((1.0, 1.0)).translate((5, 0)), 0.1
    ).is_connected


def test_a_rectangle_has_its_area():
    assert rectangle(np.zeros(2), np.array([3.0, 4.0])).area == pytest.approx(12.0)
