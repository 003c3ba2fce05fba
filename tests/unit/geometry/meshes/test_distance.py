"""Distances of boxes, solids and triangles agree with manifold3d and with sampling."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples

from amprep.geometry.meshes.distance import (
    box_distance,
    box_solids,
    near_pairs,
    solid_distance,
    thickness,
    triangle_distance,
)


def triangles(solid):
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3])[mesh.tri_verts.astype(int)]


def test_near_pairs_are_those_whose_boxes_come_close_along_every_axis():
    lo = np.array([[0, 0, 0], [11, 0, 0], [0, 13, 0], [30, 30, 30]], float)
    assert near_pairs(lo, lo + 10, 2.0) == [(0, 1)]
    assert near_pairs(lo, lo + 10, 0.0) == []
    assert near_pairs(lo, lo + 12, 0.0) == [(0, 1)]
    assert near_pairs(lo, lo + 12, -1.5) == []


def test_the_distance_of_boxes_is_euclidean_and_minus_the_depth_if_they_overlap():
    one = np.zeros((1, 3)), np.ones((1, 3))
    assert box_distance(*one, np.full((1, 3), 2.0), np.full((1, 3), 3.0)) == pytest.approx(np.sqrt(3))
    assert box_distance(*one, np.array([[0.75, 0.5, 0.0]]), np.full((1, 3), 3.0)) == pytest.approx(-0.25)
    assert box_distance(*one, np.array([[1.0, 0.0, 0.0]]), np.full((1, 3), 3.0)) == 0.0


def test_the_thickness_of_a_slab_is_its_height():
    assert thickness(Manifold.cube([100, 100, 0.01])) == pytest.approx(0.01, rel=1e-3)
    assert thickness(Manifold()) == 0.0


def test_solids_are_as_far_apart_as_known():
    ball = Manifold.sphere(5, 128)
    assert solid_distance(ball, ball.translate([12, 0, 0]), 5.0) == pytest.approx(2.0, abs=0.02)
    assert solid_distance(ball, ball.translate([12, 0, 0]), 1.0) == 1.0
    assert solid_distance(ball, ball.translate([9, 0, 0]), 1.0) < -0.1


@examples(40)
@given(st.integers(0, 10**6))
def test_triangle_distance_agrees_with_manifold3d_on_solids_that_are_apart(seed):
    rng = np.random.default_rng(seed)
    one = Manifold.hull_points(rng.uniform(0, 1, (8, 3)))
    other = Manifold.hull_points(rng.uniform(0, 1, (8, 3)) + rng.uniform(-1.5, 1.5, 3))
    gap = triangle_distance(triangles(one), triangles(other), 2.0)
    if (one ^ other).is_empty():
        assert gap == pytest.approx(min(one.min_gap(other, 2.0), 2.0), abs=1e-6)
    else:
        assert gap <= 0.0 or thickness(one ^ other) > 0.0


def test_an_edge_through_a_triangle_crosses_it_by_the_lesser_depth():
    floor = np.array([[[-5, -5, 0], [5, -5, 0], [0, 5, 0]]], float)
    spike = np.array([[[0, 0, -0.25], [0, 0, 3], [0.1, 0, 3]]], float)
    assert triangle_distance(floor, spike, 1.0) == pytest.approx(-0.25)
    up = np.array([0.0, 0.0, 1.0])
    assert triangle_distance(floor, spike + 0.25 * up, 1.0) == pytest.approx(0.0, abs=1e-12)
    assert triangle_distance(floor, spike + 0.75 * up, 1.0) == pytest.approx(0.5)
    assert triangle_distance(floor, spike + 9.0 * up, 1.0) == 1.0


def test_a_union_of_boxes_has_its_own_volume():
    union = box_solids(np.array([[0, 0, 0], [1, 0, 0]], float), np.array([[2, 1, 1], [3, 1, 1]], float))
    assert union.volume() == pytest.approx(3.0)
