"""No-fit solids against the intersection of convex solids by manifold3d, and closed forms for boxes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples

from amprep.geometry.no_fit.pieces import (
    MOST_SUMS,
    convex_piece,
    no_fit_piece,
    no_fit_solid,
    shape_set,
    sum_planes,
)


def cloud(seed, n, size=4.0):
    return np.random.default_rng(seed).uniform(0.0, size, (n, 3))


def box(lo, hi):
    return np.array(
        [[x, y, z] for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])], float
    )


def planes_of_sum(resting, moving):
    return sum_planes(convex_piece(resting), convex_piece(moving))


def polyhedron(resting, moving, clearance):
    return no_fit_piece(convex_piece(resting), convex_piece(moving), clearance)


def inside(planes, offset):
    return bool((planes[:, :3] @ offset < planes[:, 3] - 1e-7).all())


@examples(60)
@given(st.integers(0, 10**6), st.integers(4, 12), st.integers(4, 12))
def test_an_offset_is_inside_the_sum_if_and_only_if_the_moved_pieces_overlap(seed, n, m):
    resting, moving = cloud(seed, n), cloud(seed + 1, m)
    planes = planes_of_sum(resting, moving)
    for offset in np.random.default_rng(seed).uniform(-4.0, 4.0, (6, 3)):
        shared = Manifold.hull_points(resting) ^ Manifold.hull_points(moving + offset)
        depth = (planes[:, 3] - planes[:, :3] @ offset).min()
        if abs(depth) > 0.01:  # slivers are left to rounding
            assert (shared.volume() > 0.0) == (depth > 0.0)


def test_the_sum_of_two_boxes_has_the_six_planes_of_the_box_of_their_offsets():
    planes = planes_of_sum(box((0, 0, 0), (2, 3, 4)), box((0, 0, 0), (1, 1, 6)))
    found = sorted((*np.round(plane[:3]).astype(int).tolist(), round(float(plane[3]), 9)) for plane in planes)
    assert found == [
        (-1, 0, 0, 1), (0, -1, 0, 1), (0, 0, -1, 6), (0, 0, 1, 4), (0, 1, 0, 3), (1, 0, 0, 2)
    ]  # fmt: skip


def test_the_sum_of_pieces_of_many_corners_contains_the_exact_one_closely():
    ball = cloud(1, 4000, 2.0) - 1.0
    ball = ball[:: 1 + len(ball) // 150] / np.linalg.norm(ball[:: 1 + len(ball) // 150], axis=1)[:, None]
    other = ball * 2.0
    assert len(ball) * len(other) > MOST_SUMS
    planes = planes_of_sum(ball, other)
    sums = (ball[:, None] - other[None]).reshape(-1, 3)
    depth = planes[:, 3] - sums @ planes[:, :3].T
    assert depth.min() > -1e-9
    directions = cloud(2, 300, 2.0) - 1.0
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reach = (planes[:, 3] / np.maximum(directions @ planes[:, :3].T, 1e-9)).min(axis=1)
    assert reach.mean() < 3.2  # the sum of balls with radii 1 and 2 has radius 3
    assert reach.max() < 4.0


@examples(40)
@given(st.integers(0, 10**6), st.sampled_from([0.5, 3.0]))
def test_pieces_nearer_than_the_clearance_have_an_offset_inside_the_polyhedron(seed, clearance):
    resting, moving = cloud(seed, 6), cloud(seed + 1, 6)
    planes, limits = polyhedron(resting, moving, clearance)
    for offset in np.random.default_rng(seed).uniform(-9.0, 9.0, (8, 3)):
        solids = Manifold.hull_points(resting), Manifold.hull_points(moving + offset)
        if solids[0].min_gap(solids[1], 20.0) < clearance - 1e-6:
            assert inside(planes, offset)
            assert (offset >= limits[:3]).all()
            assert (offset <= limits[3:]).all()


def test_the_bevels_let_boxes_come_nearer_diagonally_than_the_clearance_in_each_axis():
    cube = box((0, 0, 0), (1, 1, 1))
    planes, _ = polyhedron(cube, cube, 1.0)
    assert inside(planes, np.array([1.95, 1.0, 0.0]))
    assert not inside(planes, np.array([1.75, 1.75, 0.0]))  # their edges are 1.06 apart


def test_the_solid_of_two_shapes_has_a_polyhedron_for_each_pair_of_pieces():
    shapes = shape_set(
        [[box((0, 0, 0), (2, 1, 1)), box((0, 0, 0), (1, 1, 3))]], [[box((0, 0, 0), (5, 5, 5))]], [1.0, 0.0]
    )
    solid = no_fit_solid(shapes.shapes[1], shapes.shapes[0], float(shapes.clearance[1]))
    assert solid.box.tolist() == [[-2, -1, -1, 5, 5, 5], [-1, -1, -3, 5, 5, 5]]
    assert solid.first_plane.tolist() == [0, 6, 12]


def test_a_piece_knows_the_normals_of_its_slanted_faces_and_the_directions_of_its_edges():
    wedge = convex_piece(np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [4, 0, 4], [0, 4, 4]]))
    assert np.abs(wedge.normals) == pytest.approx(np.array([[0.5**0.5, 0.5**0.5, 0.0]]))
    assert len(wedge.edges) == 4
