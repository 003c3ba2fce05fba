import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.shared.coverings import (
    as_points,
    best_partition,
    box_of,
    boxes_volume,
    dense_points,
    in_some_box,
    polygons_of_part,
    solid_of,
)
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.polygons import polygons_of
from amprep.geometry.bounding.boxes.two_boxes import TwoBoxSearch, flat_coordinates, two_boxes

OBJECTIVES = ["union", "larger"]

# as points are: no plane holds more than a few, some coordinates are equal
SETS = st.integers(2, 9).flatmap(lambda n: arrays(float, (n, 3), elements=st.integers(0, 12).map(float)))


def measured(boxes, objective):
    return max(boxes_volume([b]) for b in boxes) if objective == "larger" else boxes_volume(boxes)


@pytest.mark.parametrize("objective", OBJECTIVES)
@given(points=SETS)
@examples(100)
def test_two_boxes_of_points_are_as_good_as_the_best_of_all_partitions(objective, points):
    boxes, value = two_boxes(as_points(points), TwoBoxSearch(objective))
    assert in_some_box(points, boxes).all()
    assert value == pytest.approx(measured(boxes, objective), abs=1e-6)
    assert value == pytest.approx(best_partition(points[:, None], objective), abs=1e-6)


@pytest.mark.parametrize("objective", OBJECTIVES)
@given(corners=arrays(float, (5, 3, 3), elements=st.integers(0, 9).map(float)))
@examples(40)
def test_two_boxes_of_triangles_cover_them_and_are_no_worse_than_the_best_partition(objective, corners):
    polygons = polygons_of(corners.reshape(-1, 3), np.arange(15).reshape(5, 3))
    boxes, value = two_boxes(polygons, TwoBoxSearch(objective))
    weights = np.random.default_rng(1).dirichlet(np.ones(3), 500)
    points = np.concatenate((corners.reshape(-1, 3), (weights @ corners).reshape(-1, 3)))
    assert in_some_box(points, boxes).all()
    assert value <= best_partition(corners, objective) + 1e-6


def clipped(corners, axis, side, at):
    """Enclosing box of what triangles have beyond a plane, corner by corner in plain Python."""
    kept = []
    for triangle in corners:
        for a, b in zip(triangle, np.roll(triangle, 1, axis=0), strict=True):
            kept += [p for p in (a, b) if side * (p[axis] - at) > 0]
            if (a[axis] - at) * (b[axis] - at) < 0:
                kept.append(a + (b - a) * (at - a[axis]) / (b[axis] - a[axis]))
            elif (a[axis] == at) and side * (b[axis] - at) > 0:
                kept.append(a)
            elif (b[axis] == at) and side * (a[axis] - at) > 0:
                kept.append(b)
    return np.array(kept).reshape(-1, 3)


@given(corners=arrays(float, (3, 3, 3), elements=st.integers(0, 3).map(float)))
@examples(10)
def test_no_first_box_with_faces_at_corners_of_triangles_gives_a_smaller_union(corners):
    grid = range(4)
    beyond = {(a, s, at): clipped(corners, a, s, at) for a in range(3) for s in (-1, 1) for at in grid}
    spans = [(low, high) for low in grid for high in grid if low <= high]
    least = np.inf
    for x in spans:
        for y in spans:
            for z in spans:
                one = np.array([x[0], y[0], z[0], x[1], y[1], z[1]], float)
                rest = np.concatenate(
                    [beyond[axis, side, one[axis + 3 * (side > 0)]] for axis in range(3) for side in (-1, 1)]
                )
                pair = [one, box_of(rest)] if len(rest) else [one]
                least = min(least, boxes_volume(pair))
    _, value = two_boxes(polygons_of(corners.reshape(-1, 3), np.arange(9).reshape(3, 3)), TwoBoxSearch())
    assert value <= least + 1e-9


KNOWN = {
    "L": ([[0, 0, 0, 30, 10, 10], [0, 0, 0, 10, 10, 40]], 30 * 100 + 30 * 100),
    "T": ([[0, 0, 20, 50, 10, 30], [20, 0, 0, 30, 10, 20]], 5000 + 2000),
    "cross": ([[0, 20, 0, 50, 30, 10], [20, 0, 0, 30, 50, 10]], 5000 + 4000),
    "crossing rods": ([[0, 20, 20, 50, 30, 30], [20, 20, 0, 30, 30, 50]], 5000 + 4000),
    "apart": ([[0, 0, 0, 5, 5, 5], [90, 70, 50, 95, 75, 55]], 250),
}


@pytest.mark.parametrize("name", KNOWN)
def test_a_solid_of_two_boxes_is_covered_by_them(name):
    boxes, volume = KNOWN[name]
    part = solid_of(boxes)
    found, value = two_boxes(polygons_of_part(part), TwoBoxSearch())
    assert value == pytest.approx(volume, rel=1e-9)
    assert in_some_box(dense_points(part), found).all()


def test_a_bar_is_cut_in_halves_where_the_larger_box_counts():
    _, value = two_boxes(polygons_of_part(solid_of([[0, 0, 0, 10, 1, 1]])), TwoBoxSearch("larger"))
    assert value == pytest.approx(5, rel=1e-3)


def test_a_triangle_from_one_box_to_the_other_is_covered_where_a_covering_of_its_corners_is_not():
    """The corners of this triangle fit in two boxes of no volume, its middle in none of them."""
    corners = np.array([[0.0, 0, 0], [10, 10, 10], [0, 0, 1]])
    assert best_partition(corners[:, None], "union") == 0
    _, value = two_boxes(polygons_of(corners, np.array([[0, 1, 2]])), TwoBoxSearch())
    assert value == pytest.approx(2 * 5 * 5 * 5.5, rel=0.2)


def test_volume_that_is_covered_already_does_not_count():
    part = solid_of([[0, 0, 0, 30, 10, 10], [0, 0, 0, 10, 10, 40]])
    _, value = two_boxes(polygons_of_part(part), TwoBoxSearch(), covered=np.array([[0.0, 0, 0, 40, 40, 10]]))
    assert value == pytest.approx(10 * 10 * 30)


def test_flat_triangles_are_found_the_largest_first():
    part = solid_of([[0, 0, 0, 30, 10, 10], [0, 0, 0, 10, 10, 40]])
    x, y, z = flat_coordinates(part.mesh.vertices, part.mesh.triangles)
    assert x.tolist() == [0, 10, 30]  # 400, 300 and 100 mm2
    assert sorted(y) == [0, 10]
    assert z.tolist() == [0, 10, 40]  # 300, 200 and 100 mm2
