"""Known shapes: only contours that keep the limits for certain are left out, also where they repeat."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, OpType
from tests.shared.examples import examples

from amprep.checks.supports.shapes import KnownShapes

WALL, CONTACT = 0.3, 0.09


def shapes():
    return KnownShapes(WALL, CONTACT, 2.0 * WALL)


def bar(width, length=3.0, corner=(0.0, 0.0)):
    return CrossSection.square((width, length)).translate(corner)


@given(st.floats(0.05, 1.0), st.floats(0, 90))
@examples(40)
def test_bars_are_left_out_only_if_they_are_wide_enough(width, turn):
    left = shapes().undecided(bar(width).rotate(turn)).region
    if width < WALL:
        assert not left.is_empty()
    elif width > WALL + 0.05:
        assert left.is_empty()


def test_a_shape_that_was_right_is_not_taken_for_a_thinner_one():
    known = shapes()
    widths = np.linspace(0.5, 0.2, 61)
    verdicts = [known.undecided(bar(width, corner=(7.0, width))).region.is_empty() for width in widths]
    assert verdicts[0]
    assert not any(right for right, width in zip(verdicts, widths, strict=True) if width < WALL)


@pytest.mark.parametrize("thickness", [0.05, 0.2])
def test_fins_and_contours_with_holes_are_left_to_the_judge(thickness):
    fin = bar(2.0) + CrossSection.square((2.0, thickness)).translate((1.9, 1.0))
    assert not shapes().undecided(fin).region.is_empty()
    tube = bar(3.0) - bar(1.0, 1.0, (1.0, 1.0))
    assert shapes().undecided(tube).region.area() == pytest.approx(tube.area())


def test_thin_contours_among_many_right_ones_are_found_with_their_neighbours():
    right = [bar(1.0, 1.0, (2.0 * i, 2.0 * j)) for i in range(12) for j in range(12)]
    needle = bar(0.1, 1.0, (9.2, 8.0))
    found = shapes().undecided(CrossSection.batch_boolean([*right, needle], OpType.Add))
    assert found.region.area() == pytest.approx(0.1)
    assert found.around.num_contour() == 3


def test_small_contours_are_left_to_the_judge():
    assert not KnownShapes(WALL, 0.5, 0.6).undecided(bar(0.6, 0.6)).region.is_empty()
