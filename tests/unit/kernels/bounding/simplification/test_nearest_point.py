"""The nearest point of a polyhedron equals that of enumerating all sets of up to three planes."""

from itertools import combinations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numba import njit
from tests.shared.examples import examples

from amprep.kernels.bounding.simplification.nearest_point import nearest_point


@njit
def _nearest(normals, offsets, q):
    return nearest_point(normals, offsets, len(offsets), (q[0], q[1], q[2]))


def enumerated(normals, offsets, q):
    """Return the nearest feasible point among the projections to all sets of up to three planes, or None."""
    best = None
    for size in range(4):
        for chosen in combinations(range(len(offsets)), size):
            n, d = normals[list(chosen)], offsets[list(chosen)]
            if size and np.linalg.matrix_rank(n, tol=1e-6) < size:
                continue
            point = q + np.linalg.pinv(n) @ (d - n @ q) if size else q
            feasible = (normals @ point >= offsets - 1e-9).all()
            if feasible and (best is None or np.linalg.norm(point - q) < np.linalg.norm(best - q) - 1e-12):
                best = point
    return best


@given(st.integers(0, 10**6), st.integers(1, 9), st.booleans())
@examples(200)
def test_the_point_is_the_nearest_of_all_candidates(seed, count, feasible):
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    inside = rng.normal(size=3)
    offsets = normals @ inside - rng.uniform(0, 1, count) if feasible else rng.normal(size=count)
    q = 3 * rng.normal(size=3)
    found, point = _nearest(normals, offsets, q)
    expected = enumerated(normals, offsets, q)
    assert found == (expected is not None)
    if found:
        assert np.allclose(point, expected, atol=1e-7)


def test_half_spaces_without_a_common_point_are_recognised():
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    assert not _nearest(normals, np.array([1.0, 0.0]), np.zeros(3))[0]
    assert _nearest(normals, np.array([1.0, -1.0]), np.zeros(3)) == (True, (0.0, 0.0, 1.0))
