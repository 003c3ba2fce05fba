"""Planes between convex pieces against the distances that manifold3d finds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.no_fit import layout_of

from amprep.geometry.no_fit.contacts import contact_shapes
from amprep.geometry.no_fit.pieces import shape_set, sum_planes
from amprep.kernels.no_fit.contacts import WORK, find_contacts


def cloud(seed, n, size=4.0):
    return np.random.default_rng(seed).uniform(0.0, size, (n, 3))


def contact(one, other, offset, clearance, reach=100.0):
    """Number of planes, least gap and the first plane of two pieces, the first one moved."""
    shapes = contact_shapes(shape_set([[one], [other]], [], [clearance]))
    layout = layout_of([1, 0], [np.zeros(3), offset])
    pairs, planes = np.zeros((4, 2), np.int64), np.zeros((4, 4))
    count, gap = find_contacts(shapes, layout, 2, reach, pairs, planes, np.empty(WORK))
    return count, gap, planes[0]


@examples(60)
@given(st.integers(0, 10**6), st.sampled_from([4, 9, 40]), st.sampled_from([0.0, 0.5, 3.0]))
def test_every_plane_separates_and_pieces_as_far_apart_as_the_clearance_have_one_without_overlap(
    seed, corners, clearance
):
    one, other = cloud(seed, corners), cloud(seed + 1, corners)
    for offset in np.random.default_rng(seed).uniform(-9.0, 9.0, (6, 3)):
        _, gap, plane = contact(one, other, offset, clearance)
        normal = plane[:3]
        assert np.linalg.norm(normal) == pytest.approx(1.0)
        between = ((one + offset) @ normal).min() - (other @ normal).max()
        assert normal @ offset - plane[3] == pytest.approx(between - clearance, abs=1e-9)
        assert gap == pytest.approx(between - clearance, abs=1e-9)
        distance = Manifold.hull_points(one + offset).min_gap(Manifold.hull_points(other), 30.0)
        assert gap <= distance - clearance + 1e-6
        if distance > 0.0:
            assert (gap >= -1e-6) == (distance >= clearance - 1e-6)


@examples(40)
@given(st.integers(0, 10**6))
def test_the_depth_of_overlapping_tetrahedra_is_the_least_distance_to_a_face_of_their_sum(seed):
    one, other = cloud(seed, 4), cloud(seed + 1, 4)
    offset = other.mean(axis=0) - one.mean(axis=0) + np.random.default_rng(seed).normal(0.0, 0.3, 3)
    shapes = shape_set([[one], [other]], [], [0.0]).shapes
    planes = sum_planes(shapes[1][0], shapes[0][0])
    depth = (planes[:, 3] - planes[:, :3] @ offset).min()
    if depth > 1e-6:
        assert contact(one, other, offset, 0.0)[1] == pytest.approx(-depth, abs=1e-6)


def test_pieces_beyond_the_reach_have_no_contact():
    assert contact(cloud(1, 8), cloud(2, 8), np.array([9.0, 0, 0]), 1.0, reach=2.0)[0] == 0
