"""A tree does not change the distance of two sets of triangles: it is that of the nearest pair."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.meshes.distance import triangle_distance

LIMIT = 2.0


def sampled(one, other):
    """Return the least distance of points on a grid over two triangles, an upper bound of their distance."""
    steps = np.linspace(0, 1, 15)
    weights = np.array([(a, b, 1 - a - b) for a in steps for b in steps if a + b <= 1 + 1e-12])
    apart = (weights @ one)[:, None] - (weights @ other)[None]
    return float(np.linalg.norm(apart, axis=2).min())


@examples(20)
@given(st.integers(0, 10**6), st.integers(1, 20), st.floats(0.0, 4.0))
def test_the_least_distance_of_two_sets_is_that_of_the_nearest_pair(seed, count, shift):
    rng = np.random.default_rng(seed)
    one = rng.uniform(0, 3, (count, 1, 3)) + rng.uniform(-0.4, 0.4, (count, 3, 3))
    other = rng.uniform(0, 3, (11, 1, 3)) + rng.uniform(-0.4, 0.4, (11, 3, 3)) + (shift, 0.0, 0.0)
    pairs = [triangle_distance(a[None], b[None], LIMIT) for a in one for b in other]
    found = triangle_distance(one, other, LIMIT)
    assert found == pytest.approx(min(pairs), abs=1e-12)
    upper = min(sampled(a, b) for a in one for b in other)
    assert found <= upper + 1e-12
    if found > 0.0:
        assert upper <= found + 0.12 or found == LIMIT, (
            "a point of the grid is near every point of a triangle"
        )
