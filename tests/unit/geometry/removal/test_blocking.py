"""Boxes in the way of others, against sampled motions."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.removal.blocking import SLIDING, boxes_met
from amprep.geometry.removal.order import DIRECTIONS


@examples(60)
@given(st.integers(0, 10**6))
def test_boxes_in_the_way_are_those_that_a_sampled_motion_meets(seed):
    rng = np.random.default_rng(seed)
    low = rng.integers(0, 6, 3).astype(float)
    high = low + rng.integers(1, 4, 3)
    other_low = rng.integers(0, 8, (20, 3)).astype(float)
    other_high = other_low + rng.integers(1, 4, (20, 3))
    direction = DIRECTIONS[rng.integers(len(DIRECTIONS))]
    travel = np.arange(0.0, 30.0, 0.05)[:, None, None] * direction
    inside = (low + travel < other_high - 2 * SLIDING) & (high + travel > other_low + 2 * SLIDING)
    sampled = inside.all(axis=2).any(axis=0)
    met = boxes_met(low, high, other_low, other_high, direction)
    assert not (sampled & ~met).any()
    near = ((low + travel < other_high + 0.1) & (high + travel > other_low - 0.1)).all(axis=2).any(axis=0)
    assert not (met & ~near).any()


def test_boxes_that_touch_pass_each_other():
    low, high = np.zeros(3), np.ones(3)
    beside = np.array([[1.0, 0.0, 0.5]])
    assert not boxes_met(low, high, beside, beside + 1.0, DIRECTIONS[0]).any()
    assert boxes_met(low, high, beside - [[0.5, 0.0, 0.0]], beside + 1.0, DIRECTIONS[0]).all()
