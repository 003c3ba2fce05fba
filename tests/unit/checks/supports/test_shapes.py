"""Known shapes: only pieces that keep the limits for certain are left out, also where they repeat."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, OpType
from tests.shared.examples import examples
from tests.shared.solids import arrays

from amprep.checks.supports.shapes import STRAIGHT, KnownShapes
from amprep.geometry.slicing.contours import PlaneContours, SlicedMesh
from amprep.geometry.slicing.outlines import outlines_of

WALL, CONTACT = 0.3, 0.09


def shapes():
    return KnownShapes(WALL, CONTACT, 2.0 * WALL)


def judged(known, region):
    """The contours that need an exact judge, as a region, and the number of those around it."""
    sliced = SlicedMesh(*arrays(region.extrude(1.0)))
    return parts_of(known, outlines_of(sliced.contours(np.array([0.5])), STRAIGHT))


def parts_of(known, outlines):
    own, around = known.undecided(outlines)
    return outlines.region_of(np.flatnonzero(own)), int(around.sum())


def left_of(region, known=None):
    return judged(known or shapes(), region)[0]


def bar(width, length=3.0, corner=(0.0, 0.0)):
    return CrossSection.square((width, length)).translate(corner)


@given(st.floats(0.05, 1.0), st.floats(0, 90))
@examples(40)
def test_bars_are_left_out_only_if_they_are_wide_enough(width, turn):
    left = left_of(bar(width).rotate(turn))
    if width < WALL:
        assert not left.is_empty()
    elif width > WALL + 0.05:
        assert left.is_empty()


@given(st.floats(0.05, 1.0), st.floats(0, 90))
@examples(40)
def test_tubes_are_left_out_only_if_their_walls_are_thick_enough(wall, turn):
    tube = (bar(2.0 + 2.0 * wall, 3.0 + 2.0 * wall) - bar(2.0, 3.0, (wall, wall))).rotate(turn)
    left = left_of(tube)
    if wall < WALL:
        assert left.area() == pytest.approx(tube.area())
    elif wall > WALL + 0.05:
        assert left.is_empty()


def test_a_shape_that_was_right_is_not_taken_for_a_thinner_one():
    known = shapes()
    widths = np.linspace(0.5, 0.2, 61)
    verdicts = [left_of(bar(width, corner=(7.0, width)), known).is_empty() for width in widths]
    assert verdicts[0]
    assert not any(right for right, width in zip(verdicts, widths, strict=True) if width < WALL)


def test_a_tube_is_not_taken_for_one_with_a_hole_at_another_place():
    known = shapes()
    middle = bar(3.0) - bar(1.0, 1.0, (1.0, 1.0))
    beside = bar(3.0) - bar(1.0, 1.0, (1.95, 1.0))
    assert left_of(middle, known).is_empty()
    assert left_of(beside, known).area() == pytest.approx(beside.area())
    assert left_of(middle.translate((40.0, 3.0)), known).is_empty()


@pytest.mark.parametrize("thickness", [0.05, 0.2])
def test_fins_are_left_to_the_judge(thickness):
    fin = bar(2.0) + CrossSection.square((2.0, thickness)).translate((1.9, 1.0))
    assert not left_of(fin).is_empty()


def test_a_post_inside_a_tube_is_judged_on_its_own():
    tube = bar(6.0, 6.0) - bar(5.0, 5.0, (0.5, 0.5))
    assert left_of(tube + bar(1.0, 1.0, (2.0, 2.0))).is_empty()
    assert left_of(tube + bar(0.1, 1.0, (2.0, 2.0))).area() == pytest.approx(0.1)


def test_thin_contours_among_many_right_ones_are_found_with_their_neighbours():
    right = [bar(1.0, 1.0, (2.0 * i, 2.0 * j)) for i in range(12) for j in range(12)]
    needle = bar(0.1, 1.0, (9.2, 8.0))
    region, around = judged(shapes(), CrossSection.batch_boolean([*right, needle], OpType.Add))
    assert region.area() == pytest.approx(0.1)
    assert around == 3


def test_small_contours_are_left_to_the_judge():
    assert not left_of(bar(0.6, 0.6), KnownShapes(WALL, 0.5, 0.6)).is_empty()


def contours_of(*polygons):
    """Contours of one plane, as points in order."""
    points = [np.asarray(each, float) for each in polygons]
    area = [
        0.5 * float(each[:, 0] @ np.roll(each[:, 1], -1) - each[:, 1] @ np.roll(each[:, 0], -1))
        for each in points
    ]
    zeros = np.zeros(len(points), np.int64)
    first = np.cumsum([0, *map(len, points)])
    return PlaneContours(np.zeros(1), zeros, zeros, np.array(area), np.concatenate(points), first)


SQUARE = np.array([(0, 0), (4, 0), (4, 4), (0, 4)])


@pytest.mark.parametrize(
    "other",
    [
        [(1, 1), (1, 5), (3, 5), (3, 1)],  # a hole that the square does not contain
        [(3, 1), (9, 1), (9, 4), (6, 4), (6, 0.5), (3, 0.5)],  # crosses itself inside the square
    ],
    ids=["hole in nothing", "crosses itself"],
)
def test_right_pieces_below_contours_that_take_something_away_are_left_to_the_judge(other):
    known = shapes()
    assert parts_of(known, outlines_of(contours_of(SQUARE), STRAIGHT))[0].is_empty()
    left, _ = parts_of(known, outlines_of(contours_of(SQUARE, other), STRAIGHT))
    assert left.area() >= 8.0
