"""Helpers for arrays."""

import numpy as np

from amprep.arrays import starts_of


def test_starts_of_groups_divide_the_rows_of_all():
    groups = [np.zeros((2, 3)), np.zeros((0, 3)), np.zeros((1, 3))]
    assert starts_of(groups).tolist() == [0, 2, 2, 3]
    assert starts_of(iter([])).tolist() == [0]
