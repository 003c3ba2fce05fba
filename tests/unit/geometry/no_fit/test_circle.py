"""Outlines in circles, against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.no_fit.circle import Circle, circle_sides, find_inside_circle, outline_of


@examples(30)
@given(st.floats(1.0, 300.0), st.floats(1e-4, 1e-2))
def test_the_polygon_contains_the_circle_and_is_hardly_larger(radius, tolerance):
    circle = Circle(np.array([3.0, -2.0]), radius)
    sides = circle_sides(circle, tolerance)
    assert np.abs(sides[:, :2] @ circle.centre + radius - sides[:, 2]).max() < 1e-9
    corner = radius / np.cos(np.pi / len(sides))
    assert corner <= radius + tolerance or len(sides) == 2000


def test_a_rectangle_fits_the_circle_around_it_and_no_smaller_one():
    outline = np.array([[1.0, 1], [7, 1], [7, 9], [1, 9]])
    found = find_inside_circle(outline, Circle(np.array([10.0, 20.0]), 5.0), 1e-3)
    assert found == pytest.approx([6.0, 15.0], abs=1e-2)
    assert find_inside_circle(outline, Circle(np.array([10.0, 20.0]), 4.99), 1e-3) is None


def test_an_outline_is_the_hull_of_the_points_and_a_line_stays():
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 1]])
    assert sorted(map(tuple, outline_of(square))) == [(0, 0), (0, 2), (2, 0), (2, 2)]
    assert len(outline_of(np.array([[0.0, 0], [1, 1], [2, 2]]))) == 3
