import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.shared.coverings import in_some_box
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.polygons import ConvexPolygons, outside, polygons_of

FLOATS = st.floats(0, 10, width=32)


def area(polygons):
    total = 0.0
    for start, end in zip(polygons.first[:-1], polygons.first[1:], strict=True):
        corners = polygons.points[polygons.corners[start:end]]
        fans = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0])
        total += float(np.linalg.norm(fans.sum(axis=0))) / 2
    return total


@given(
    triangle=arrays(float, (3, 3), elements=FLOATS),
    corners=arrays(float, (3, 2, 3), elements=FLOATS),
)
@examples(100)
def test_the_pieces_outside_boxes_are_what_samples_say(triangle, corners):
    boxes = np.hstack((corners.min(axis=1), corners.max(axis=1)))
    left = outside(polygons_of(triangle, np.array([[0, 1, 2]])), boxes)
    weights = np.random.default_rng(0).dirichlet(np.ones(3), 4000)
    share = 1 - in_some_box(weights @ triangle, boxes).mean()
    whole = np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])) / 2
    assert area(left) == pytest.approx(share * whole, abs=0.05 * whole + 1e-9)
    inner = boxes + np.array([1, 1, 1, -1, -1, -1]) * 1e-6  # no piece has a corner deeper inside a box
    assert not in_some_box(left.points, inner, -1e-9).any()


def test_vertices_of_no_triangle_do_not_count():
    polygons = polygons_of(np.array([[0.0, 0, 0], [99, 99, 99], [1, 0, 0], [0, 1, 0]]), np.array([[0, 2, 3]]))
    assert polygons.bounds.tolist() == [0, 0, 0, 1, 1, 0]


def test_nothing_has_no_bounds():
    empty = ConvexPolygons(np.empty((0, 3)), np.empty(0, np.int64), np.zeros(1, np.int64))
    assert empty.bounds.tolist() == [np.inf] * 3 + [-np.inf] * 3


def test_a_polygon_in_the_face_of_a_box_is_inside_it():
    polygons = polygons_of(np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1]]), np.array([[0, 1, 2]]))
    assert len(outside(polygons, np.array([[0.0, 0, 0, 1, 1, 1]])).first) == 1
    assert len(outside(polygons, np.array([[0.0, 0, 2, 1, 1, 3]])).first) == 2
