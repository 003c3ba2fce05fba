"""Contacts of boxes in closed form."""

import numpy as np
import pytest
from tests.shared.no_fit import box_shapes, layout_of

from amprep.geometry.no_fit.contacts import contact_shapes
from amprep.kernels.no_fit.contacts import WORK, find_contacts


def contacts(pieces, layout, reach, rows=10):
    pairs, planes = np.zeros((rows, 2), np.int64), np.zeros((rows, 4))
    shapes = contact_shapes(pieces)
    count, apart = find_contacts(shapes, layout, len(layout.shape), reach, pairs, planes, np.empty(WORK))
    return count, apart, pairs[:count], planes[:count]


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_the_plane_between_two_boxes_is_that_of_greatest_separation(order):
    sizes = [[2, 2, 2], [3, 1, 1]]
    pieces, _ = box_shapes(sizes, 0.5)
    places = np.array([[0.0, 0, 0], [2.5, 0.5, 0.5]])
    layout = layout_of(order, places[order])
    count, apart, pairs, planes = contacts(pieces, layout, 1.0)
    assert (count, apart) == (1, pytest.approx(0.5))
    assert pairs.tolist() == [[1, 0]]
    offset = layout.position[1] - layout.position[0]
    assert planes[0, :3] @ offset - planes[0, 3] == pytest.approx(0.5)
    assert abs(planes[0, 0]) == pytest.approx(1.0)


def test_an_overlap_is_a_negative_separation():
    pieces, _ = box_shapes([[2, 2, 2]], 0.5)
    assert contacts(pieces, layout_of([0, 0], [[0, 0, 0], [1.75, 0, 0]]), 1.0)[1] == pytest.approx(-0.25)


def test_boxes_beyond_the_reach_have_no_contact():
    pieces, _ = box_shapes([[2, 2, 2]], 0.5)
    assert contacts(pieces, layout_of([0, 0], [[0, 0, 0], [5, 0, 0]]), 1.0)[:2] == (0, np.inf)


def test_too_few_rows_are_counted():
    pieces, _ = box_shapes([[2, 2, 2]], 0.5)
    layout = layout_of([0] * 4, [[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0]])
    count, _, pairs, _ = contacts(pieces, layout, 0.5, rows=1)
    assert count == 6
    assert len(pairs) == 1
