import numpy as np
from tests.shared.coverings import boxes_volume, dense_points, in_some_box, polygons_of_part, solid_of

from amprep.geometry.bounding.boxes.fit import MARGIN, all_covered, enlarged, merged, seal, shrink
from amprep.kernels.boxes.records import PAIR_SLACK

L_SHAPE = [[0, 0, 0, 30, 10, 10], [0, 0, 0, 10, 10, 40]]


def test_boxes_are_shrunk_to_what_only_they_must_cover():
    polygons = polygons_of_part(solid_of(L_SHAPE))
    loose = np.array([[-1.0, -2, -3, 35, 12, 11], [-5, -5, 5, 10, 20, 50]])
    boxes = shrink(polygons, loose)
    assert boxes_volume(boxes) == 6000
    assert all_covered(polygons, boxes)


def test_a_box_that_others_replace_is_dropped():
    polygons = polygons_of_part(solid_of(L_SHAPE))
    boxes = shrink(polygons, np.array([*L_SHAPE, [1, 1, 1, 5, 5, 30]], float))
    assert len(boxes) == 2
    assert boxes_volume(boxes) == 6000


def test_boxes_that_leave_out_a_part_of_a_triangle_do_not_cover():
    part = solid_of(L_SHAPE)
    leaving = np.array([[0.0, 0, 0, 30, 10, 9.999], [0, 0, 0, 9.999, 10, 40]])
    assert not all_covered(polygons_of_part(part), leaving)
    assert not in_some_box(dense_points(part), leaving).all()


def test_sealed_boxes_overlap_by_less_than_packers_call_contact():
    boxes = np.array([[0.0, 0, 0, 5, 1, 1], [5, 0, 0, 9, 1, 1]])
    sealed = seal(boxes)
    assert np.isclose(sealed[0, 3] - sealed[1, 0], 2 * MARGIN, rtol=1e-6)
    assert 4 * MARGIN < PAIR_SLACK
    assert (sealed[:, :3] < boxes[:, :3]).all()
    assert (sealed[:, 3:] > boxes[:, 3:]).all()


def test_boxes_are_enlarged_only_inside_their_union():
    boxes = np.array([[0.0, 0, 0, 30, 10, 10], [0, 0, 10, 10, 10, 40], [50, 0, 0, 60, 10, 10]])
    larger = enlarged(boxes, range(3))
    assert larger[1].tolist() == [0, 0, 0, 10, 10, 40]
    assert larger[[0, 2]].tolist() == boxes[[0, 2]].tolist()


def test_two_halves_of_a_bar_that_a_third_box_crosses_are_merged():
    halves = np.array([[0.0, 0, 20, 20, 10, 30], [20, 0, 0, 30, 10, 30], [30, 0, 20, 50, 10, 30]])
    polygons = polygons_of_part(solid_of(halves))
    boxes = merged(polygons, halves)
    assert len(boxes) == 2
    assert boxes_volume(boxes) == 7000
    assert all_covered(polygons, boxes)


def test_boxes_that_are_all_needed_are_not_merged():
    boxes = np.array(L_SHAPE, float)
    assert merged(polygons_of_part(solid_of(L_SHAPE)), boxes) is boxes
