"""The kernels of sets of pieces skip pairs by their boxes without changing an answer."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.convex import random_poses, random_sets
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.collision import relative_poses, work_array
from amprep.geometry.bounding.convex.prepared import prepare_pieces
from amprep.kernels.bounding.piece_sets import collide, directional_distance, distance


@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.2]))
@examples(20)
def test_a_set_answers_as_its_nearest_pair_of_pieces_does(seed, margin):
    a, b = random_sets(seed)
    pose = relative_poses(random_poses(seed, 1, 2.0), random_poses(seed + 1, 2, 2.0)[1:])[0]
    ray = np.array([0.6, 0.0, 0.8])
    pairs = [(prepare_pieces([p]), prepare_pieces([q])) for p in a.pieces for q in b.pieces]
    work = work_array(b)
    hits = [collide(p.arrays, q.arrays, pose, margin, work_array(q)) for p, q in pairs]
    assert collide(a.arrays, b.arrays, pose, margin, work) == any(hits)
    gaps = [distance(p.arrays, q.arrays, pose, 50.0, work_array(q)) for p, q in pairs]
    assert distance(a.arrays, b.arrays, pose, 50.0, work) == pytest.approx(min(gaps), abs=1e-9)
    ways = [
        directional_distance(p.arrays, q.arrays, pose, ray, margin, 50.0, work_array(q)) for p, q in pairs
    ]
    found = directional_distance(a.arrays, b.arrays, pose, ray, margin, 50.0, work)
    assert found == pytest.approx(min(ways), abs=1e-7)
