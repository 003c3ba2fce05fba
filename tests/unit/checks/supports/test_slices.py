"""Widths of contours, and the contours above them."""

import numpy as np
import pytest
from tests.shared.solids import mesh_of
from tests.shared.supported import box

from amprep.checks.supports.slices import slices_of
from amprep.geometry.slicing.contours import SlicedMesh


def slices(solid, heights):
    return slices_of(SlicedMesh(*mesh_of(solid).arrays), np.array(heights))


def test_widths_are_those_of_the_hull():
    bar = slices(box((7, 2, 5), (0, 0, 0)).rotate((0, 0, 30)), [1.0, 2.0])
    assert bar.widths_of(np.arange(2)) == pytest.approx([2.0, 2.0], rel=0.01)


def test_a_contour_follows_another_only_where_neither_forks():
    fork = box((10, 2, 4), (0, 0, 0)) + box((2, 2, 8), (0, 0, 0)) + box((2, 2, 8), (8, 0, 0))
    found = slices(fork, [1.0, 3.0, 5.0, 7.0])
    plane = found.contours.plane
    chains = {(int(plane[c]), int(plane[a])) for c, a in enumerate(found.above) if a >= 0}
    assert chains == {(0, 1), (2, 3)}


def test_steep_thin_walls_are_followed_although_their_sections_do_not_overlap():
    leaning = slices(box((10, 0.2, 12), (0, 0, 0)).rotate((-50, 0, 0)), np.arange(1.0, 7.0, 0.5))
    assert (leaning.above >= 0).sum() == 11


def test_points_are_at_the_height_of_their_plane():
    found = slices(box((1, 2, 5), (0, 0, 0)), [1.5, 3.0])
    assert [set(found.points_of(c)[:, 2]) for c in range(2)] == [{1.5}, {3.0}]
