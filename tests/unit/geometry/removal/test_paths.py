"""Paths of several motions."""

import numpy as np
from tests.shared.removal import bayonet, blocking_of, hook_in_ring

from amprep.geometry.removal.paths import find_path

AXES = np.concatenate([np.eye(3), -np.eye(3)])


def test_a_path_leaves_by_motions_of_which_only_the_last_has_no_end():
    solids = bayonet()
    path = find_path(blocking_of(solids), 1, [0], lambda: False)
    assert path is not None
    lengths = [length for _, length in path]
    assert np.isfinite(lengths[:-1]).all()
    assert np.isinf(lengths[-1])
    offset = np.zeros(3)
    for direction, length in path:
        for travel in np.arange(0.0, min(length, 60.0), 0.5):
            moved = solids[1].translate((offset + travel * np.array(direction)).tolist())
            assert (moved ^ solids[0]).volume() < 1e-2
        offset += min(length, 60.0) * np.array(direction)


def test_locked_bodies_and_a_stopped_search_have_no_path():
    assert find_path(blocking_of(hook_in_ring()), 0, [1], lambda: False) is None
    assert find_path(blocking_of(bayonet()), 1, [0], lambda: True) is None
