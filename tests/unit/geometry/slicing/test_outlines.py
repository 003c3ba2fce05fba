"""Outlines: corners stay, points on straight lines go, and holes know their borders."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection
from tests.shared.examples import examples
from tests.shared.solids import arrays, random_solid

from amprep.geometry.slicing.contours import SlicedMesh
from amprep.geometry.slicing.outlines import outlines_of


def outlines(solid, heights, tolerance=1e-4):
    return outlines_of(SlicedMesh(*arrays(solid)).contours(np.array(heights)), tolerance)


def square(side, corner=(0.0, 0.0)):
    return CrossSection.square((side, side)).translate(corner)


@given(st.integers(0, 10_000), st.floats(1e-5, 0.05))
@examples(25)
def test_no_border_moves_by_more_than_the_tolerance(seed, tolerance):
    solid = random_solid(seed)
    low, high = solid.bounding_box()[2], solid.bounding_box()[5]
    heights = low + (high - low) * np.array([0.21, 0.543, 0.87])
    found = outlines(solid, heights, tolerance)
    for plane, height in enumerate(heights):
        region, expected = found.region_of(np.flatnonzero(found.plane == plane)), solid.slice(height)
        for a, b in ((region, expected), (expected, region)):
            assert (a - b.offset(2.0 * tolerance)).area() < 1e-6


def test_only_the_corners_of_a_wall_stay_however_it_is_triangulated():
    tower = square(3).extrude(1.0) + square(3).extrude(2.0).translate((0, 0, 1)) - square(1).extrude(1.0)
    refined = tower.refine(4)
    assert np.diff(outlines(refined, [0.55, 2.45]).first).tolist() == [6, 4]


def test_boxes_areas_and_lengths_are_those_of_the_contours():
    tube = (square(4) - square(2, (1, 1))).extrude(2.0)
    found = outlines(tube, [1.0])
    outer, hole = np.argsort(-found.area)
    assert found.area[[outer, hole]] == pytest.approx([16.0, -4.0])
    assert found.length[[outer, hole]] == pytest.approx([16.0, 8.0])
    assert found.low[hole] == pytest.approx([1.0, 1.0])
    assert found.high[hole] == pytest.approx([3.0, 3.0])
    assert found.border.tolist() == [outer, outer]


def test_a_hole_belongs_to_the_smallest_border_around_it():
    nested = square(9) - square(7, (1, 1)) + square(5, (2, 2)) - square(1, (3, 3))
    found = outlines(nested.extrude(1.0), [0.5])
    area = dict(zip(found.area.round().astype(int).tolist(), found.border, strict=True))
    assert found.area[area[-49]] == pytest.approx(81.0)
    assert found.area[area[-1]] == pytest.approx(25.0)
