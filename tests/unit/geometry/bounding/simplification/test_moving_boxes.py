"""The tree of boxes finds the triangles that plain comparison finds, also after triangles have moved."""

import numpy as np
import pytest
from numba import njit
from tests.shared.solids import arrays, gear

from amprep.geometry.bounding.simplification.half_edges import make_half_edges
from amprep.geometry.bounding.simplification.moving_boxes import make_tree, morton_codes
from amprep.kernels.bounding.simplification.box_tree import find_boxes, refit

pytestmark = pytest.mark.compiled


@njit
def _find(tree, lo, hi, found):
    return find_boxes(tree, lo, hi, found)


@njit
def _refit(tree, surface, triangle):
    refit(tree, surface, triangle)


def assert_same(surface, tree, rng):
    corners = surface.points[surface.start].reshape(-1, 3, 3)
    lo, hi = rng.uniform(-12, 12, (2, 3))
    lo, hi = np.minimum(lo, hi), np.maximum(lo, hi)
    found = np.empty(len(corners), np.int32)
    count = _find(tree, lo, hi, found)
    meets = ((corners.min(axis=1) <= hi) & (corners.max(axis=1) >= lo)).all(axis=1)
    assert set(found[:count]) == set(np.flatnonzero(meets))


def test_the_tree_finds_the_boxes_that_meet_a_box():
    rng = np.random.default_rng(2)
    surface = make_half_edges(*arrays(gear()))
    tree = make_tree(surface)
    for _ in range(20):
        assert_same(surface, tree, rng)
    for vertex in range(0, len(surface.points), 7):
        surface.points[vertex] += rng.uniform(-3, 3, 3)
        for triangle in np.flatnonzero((surface.start.reshape(-1, 3) == vertex).any(axis=1)):
            _refit(tree, surface, triangle)
        assert_same(surface, tree, rng)


def test_neighbours_on_the_curve_are_neighbours_in_space():
    points = np.random.default_rng(1).uniform(0, 1, (4000, 3))
    along = points[np.argsort(morton_codes(points))]
    assert np.linalg.norm(np.diff(along, axis=0), axis=1).mean() < 0.15
