"""The choice of a few among many orientations."""

import numpy as np
import pytest

from amprep.geometry.orientation.choice import apart, balanced, non_dominated, ranked


def test_a_row_that_another_one_beats_is_dominated():
    costs = np.array([[1, 5], [2, 2], [5, 1], [3, 3], [2, 4.0]])
    assert non_dominated(costs).tolist() == [True, True, True, False, False]


def test_of_equal_rows_the_first_is_kept():
    assert non_dominated(np.array([[1.0, 2.0], [1.0, 2.0]])).tolist() == [True, False]


@pytest.mark.parametrize("seed", range(5))
def test_no_kept_row_is_beaten_and_every_other_one_is(seed):
    costs = np.random.default_rng(seed).integers(0, 6, (40, 3)).astype(float)
    kept = non_dominated(costs)
    for row, own in enumerate(costs):
        beaten = any((other <= own).all() and (other < own).any() for other in costs)
        twice = any((other == own).all() for other in costs[:row])
        assert kept[row] == (not beaten and not twice)


def test_the_balance_is_the_mean_of_scaled_columns():
    costs = np.array([[0.0, 10.0], [1.0, 20.0], [2.0, 30.0]])
    assert balanced(costs).tolist() == [0.0, 1.0, 2.0]


def test_directions_too_near_to_an_earlier_one_and_those_not_allowed_are_left_out():
    directions = np.array([[0, 0, 1.0], [0, 0.01, 1.0], [1.0, 0, 0], [0, 1.0, 0]])
    asked = []

    def allowed(row):
        asked.append(row)
        return row != 2

    assert apart([0, 1, 2, 3], directions, 5, 5.0, allowed) == [0, 3]
    assert asked == [0, 2, 3]


def test_rows_that_differ_by_rounding_are_ordered_by_the_next_key():
    assert ranked(np.array([1.0, 1.0 + 1e-13, 0.5]), np.array([2.0, 1.0, 9.0])).tolist() == [2, 1, 0]
