"""Footprints: the outline equals scipy's hull, the circle is the smallest of all through two or three points."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from tests.shared.examples import examples

from amprep.geometry.boxes.footprint import convex_outline, enclosing_radius, flush_angles

coordinates = st.lists(st.tuples(*[st.integers(-50, 50)] * 2), min_size=1, max_size=20)


def circle(points):
    """Centre and radius of the circle with two points as its diameter, or through three."""
    if len(points) == 2:
        return points.mean(axis=0), np.linalg.norm(points[0] - points[1]) / 2
    matrix = 2 * (points[1:] - points[0])
    if abs(np.linalg.det(matrix)) < 1e-9:
        return None
    centre = np.linalg.solve(matrix, (points[1:] ** 2).sum(axis=1) - (points[0] ** 2).sum())
    return centre, np.linalg.norm(points[0] - centre)


def smallest_radius(points):
    """Brute force over all pairs and triples."""
    if len(points) == 1:
        return 0.0
    found = []
    for size in (2, 3):
        for chosen in combinations(points, size):
            made = circle(np.array(chosen))
            if made is not None and np.linalg.norm(points - made[0], axis=1).max() <= made[1] + 1e-9:
                found.append(made[1])
    return min(found)


@given(coordinates)
@examples(60)
def test_the_enclosing_circle_is_the_smallest(rows):
    points = np.unique(np.array(rows, np.float64), axis=0)
    assert enclosing_radius(convex_outline(points)) == pytest.approx(smallest_radius(points), abs=1e-9)


@given(coordinates)
@examples(60)
def test_the_outline_has_the_area_of_the_convex_hull_and_turns_left_only(rows):
    points = np.array(rows, np.float64)
    if np.linalg.matrix_rank(points - points[0]) < 2:
        return
    outline = convex_outline(points)
    assert ConvexHull(outline).volume == pytest.approx(ConvexHull(points).volume)
    side = np.roll(outline, -1, axis=0) - outline
    following = np.roll(side, -1, axis=0)
    assert (side[:, 0] * following[:, 1] - side[:, 1] * following[:, 0] > 0).all()


def test_a_flush_angle_turns_its_side_parallel_to_x_longest_first():
    outline = np.array([[0.0, 0], [4, 3], [1, 7]])
    angle = flush_angles(outline)[0]
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    longest = turn @ (outline[0] - outline[2])
    assert longest[1] == pytest.approx(0.0, abs=1e-12)
    assert longest[0] == pytest.approx(np.hypot(1, 7))


@pytest.mark.parametrize("shape", ["disc", "square", "line", "point"])
def test_of_many_points_the_outline_is_the_same_as_of_the_hull(shape):
    rng = np.random.default_rng(5)
    points = rng.normal(size=(3000, 2))
    if shape == "square":
        points = np.round(rng.uniform(0, 50, (3000, 2)))
    elif shape != "disc":
        points = np.outer(rng.integers(0, 9, 3000) * (shape == "line"), [2.0, 3.0])
    outline = convex_outline(points)
    assert {tuple(each) for each in outline.tolist()} == {tuple(each) for each in hull_of(points)}


def hull_of(points):
    """The corners by Qhull; the ends of points on a line."""
    if np.linalg.matrix_rank(points - points[0]) < 2:
        return [points.min(axis=0).tolist(), points.max(axis=0).tolist()]
    return points[ConvexHull(points).vertices].tolist()
