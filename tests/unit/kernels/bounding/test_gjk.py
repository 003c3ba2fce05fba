"""The search of Gilbert, Johnson and Keerthi gives bounds that are valid however it ends."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.convex import random_poses, random_sets
from tests.shared.examples import examples
from tests.shared.kernels import plain

from amprep.kernels.bounding import gjk


@pytest.fixture(autouse=True)
def _uncompiled(monkeypatch):
    """Run the functions of the module as plain Python: only other kernels call them."""
    for name, value in vars(gjk).items():
        if hasattr(value, "py_func"):
            monkeypatch.setattr(gjk, name, plain(value))


def searched(pair, least=0.0, most=np.inf):
    a, b = pair
    pose = random_poses(7, 2, 5.0)[1]
    return gjk.pair_distance(a.arrays, 0, b.arrays, 0, pose, least, most, np.empty((4, 3)))


def test_the_vector_is_from_the_nearest_point_of_one_piece_to_that_of_the_other():
    distance, *vector = searched(random_sets(11, most=1))
    assert distance > 0.0
    assert np.linalg.norm(vector) == pytest.approx(distance)


def test_a_search_that_ends_early_returns_a_bound():
    pair = random_sets(11, most=1)
    exact = searched(pair)[0]
    assert exact / 2 <= searched(pair, most=exact / 2)[0] <= exact * (1 + 1e-12)
    assert exact <= searched(pair, least=exact * 1.5)[0] <= exact * 1.5


@given(st.integers(0, 10**6))
@examples(50)
def test_the_nearest_point_of_a_tetrahedron_is_the_least_of_many_samples(seed):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(4, 3)) + rng.normal(size=3)
    simplex = np.zeros((4, 3))
    simplex[:] = corners
    count, *vector = gjk._reduce(simplex, 4, 0.0, 0.0, 0.0)
    weights = rng.dirichlet([0.5] * 4, size=2000)
    sampled = np.linalg.norm(weights @ corners, axis=1).min()
    assert np.linalg.norm(vector) <= sampled + 1e-12
    inside = np.linalg.solve(np.vstack((corners.T, np.ones(4))), [0, 0, 0, 1.0]).min() > 0.0
    assert inside == (count == 4)


def test_a_piece_that_moves_away_travels_without_end():
    a, b = random_sets(11, most=1)
    pose = random_poses(7, 2, 5.0)[1]
    away = np.array(gjk._away(a.arrays, 0, b.arrays, 0, pose))
    away /= np.linalg.norm(away)
    simplex = np.empty((4, 3))
    assert gjk.pair_travel(a.arrays, 0, b.arrays, 0, pose, away, 0.1, 77.0, simplex) == 77.0
    assert 0.0 < gjk.pair_travel(a.arrays, 0, b.arrays, 0, pose, -away, 0.1, 77.0, simplex) < 77.0
