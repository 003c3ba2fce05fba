"""Sorting and skipping triangles does not change their least distance: it is the least of all pairs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.kernels.meshes.distance import least_distance

LIMIT = 2.0


def sampled(one, other):
    """Return the least distance of points on a grid over two triangles, an upper bound of their distance."""
    steps = np.linspace(0, 1, 15)
    weights = np.array([(a, b, 1 - a - b) for a in steps for b in steps if a + b <= 1 + 1e-12])
    apart = (weights @ one)[:, None] - (weights @ other)[None]
    return float(np.linalg.norm(apart, axis=2).min())


@examples(30)
@given(st.integers(0, 10**6), st.floats(0.0, 4.0))
def test_the_least_distance_of_two_sets_is_that_of_the_nearest_pair(seed, shift):
    rng = np.random.default_rng(seed)
    one = rng.uniform(0, 3, (6, 1, 3)) + rng.uniform(-0.4, 0.4, (6, 3, 3))
    other = rng.uniform(0, 3, (7, 1, 3)) + rng.uniform(-0.4, 0.4, (7, 3, 3)) + (shift, 0.0, 0.0)
    other = other[np.argsort(other[:, :, 0].min(axis=1))]
    widest = float(np.ptp(other[:, :, 0], axis=1).max())
    pairs = [least_distance(a[None], b[None], widest, LIMIT) for a in one for b in other]
    found = least_distance(one, other, widest, LIMIT)
    assert found == pytest.approx(min(pairs), abs=1e-12)
    upper = min(sampled(a, b) for a in one for b in other)
    assert found <= upper + 1e-12
    if found > 0.0:
        assert upper <= found + 0.12 or found == LIMIT, (
            "a point of the grid is near every point of a triangle"
        )
