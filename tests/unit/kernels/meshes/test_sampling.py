"""Lattice points on triangles: as many as a plain test of every node, at the heights of the planes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.meshes.sampling import sample_triangles
from amprep.kernels.meshes.sampling import lattice_points


@examples(50)
@given(st.integers(0, 10**6), st.floats(0.1, 0.9))
def test_each_node_above_a_triangle_gives_one_point(seed, spacing):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-2, 2, (3, 3))
    triangles = np.array([[0, 1, 2]])
    count = lattice_points(corners, triangles, spacing, np.empty((0, 3)), np.empty(0, np.int64))
    points, owner = np.empty((count, 3)), np.empty(count, np.int64)
    assert lattice_points(corners, triangles, spacing, points, owner) == count
    nodes = np.arange(-25, 26) * spacing
    expected = set()
    inverse = np.linalg.inv(np.vstack([corners[:, :2].T, np.ones(3)]))
    for i, x in enumerate(nodes):
        for j, y in enumerate(nodes):
            weights = inverse @ (x, y, 1.0)
            if (weights > 0).all():
                expected.add((i, j))
                row = np.flatnonzero(np.abs(points[:, :2] - (x, y)).max(axis=1) < 1e-9)
                assert len(row) == 1
                assert abs(points[row[0], 2] - weights @ corners[:, 2]) < 1e-6
    assert count == len(expected)


def test_a_square_of_two_triangles_has_each_node_once():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    assert lattice_points(corners, triangles, 0.125, np.empty((0, 3)), np.empty(0, np.int64)) == 64


@examples(30)
@given(st.integers(0, 10**6), st.floats(0.1, 1.0))
def test_every_point_of_a_triangle_has_a_sample_within_the_spacing(seed, spacing):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (1, 3, 3))
    samples = sample_triangles(corners, spacing)
    weights = rng.dirichlet(np.ones(3), 100)
    points = weights @ corners[0]
    away = np.linalg.norm(points[:, None] - samples[None], axis=2).min(axis=1)
    assert away.max() <= spacing
