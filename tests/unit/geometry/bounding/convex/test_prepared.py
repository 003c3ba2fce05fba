"""Prepared pieces keep the corners of hulls, and their planes and boxes contain them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from tests.shared.convex import random_sets
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.prepared import extreme_points, planes_of, prepare_pieces


@given(st.integers(0, 10**6))
@examples(30)
def test_planes_and_boxes_contain_every_vertex(seed):
    for pieces in random_sets(seed):
        for piece, planes in zip(pieces.pieces, pieces.planes, strict=True):
            assert (piece @ planes[:, :3].T <= planes[:, 3]).all()
        for i, piece in enumerate(pieces.pieces):
            assert (np.abs(piece - pieces.arrays.centre[i]) <= pieces.arrays.half[i] + 1e-15).all()
        assert (np.abs(pieces.vertices - pieces.arrays.centre[-1]) <= pieces.arrays.half[-1] + 1e-15).all()


def test_points_inside_a_hull_are_dropped_and_the_hull_stays():
    points = np.random.default_rng(1).normal(size=(200, 3))
    kept = extreme_points(points)
    assert len(kept) < 100
    assert ConvexHull(kept).volume == pytest.approx(ConvexHull(points).volume)


def test_points_in_a_plane_are_kept_and_bounded_by_their_box():
    flat = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [1, 0.5, 0]])
    assert extreme_points(flat).tolist() == flat.tolist()
    assert sorted(planes_of(flat)[:, 3].tolist()) == [0, 0, 0, 0, 1, 2]


def test_shrinking_moves_no_point_farther_than_asked():
    pieces = random_sets(5)[0]
    shrunk = prepare_pieces(pieces.pieces, shrink=0.01)
    moved = np.linalg.norm(shrunk.vertices - pieces.vertices, axis=1)
    assert 0.0 < moved.max() <= 0.01 + 1e-12
