"""Merged groups hold every cell once, and their hulls add little volume."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.cells import hull_volume
from amprep.geometry.bounding.convex.merge import merge_cells

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def go_on():
    return False


def total(cells, groups):
    return sum(hull_volume(np.concatenate([cells[k] for k in group])) for group in groups)


@given(st.integers(0, 10**6), st.integers(1, 12))
@examples(25)
def test_groups_are_a_partition_into_at_most_the_number_asked_for(seed, most):
    rng = np.random.default_rng(seed)
    cells = [rng.normal(size=(6, 3)) + 3 * rng.normal(size=3) for _ in range(12)]
    groups = merge_cells(cells, most, 0.0, go_on)
    assert sorted(cell for group in groups for cell in group) == list(range(12))
    assert len(groups) <= most


def test_the_eight_octants_of_a_cube_become_the_cube():
    octants = [CUBE + corner for corner in CUBE]
    assert merge_cells(octants, 8, 8.0, go_on) == [list(range(8))]


def test_a_stack_beside_another_stays_two_groups():
    cells = [CUBE + [x, 0, z] for x in (0, 5) for z in range(4)]
    assert merge_cells(cells, 2, 8.0, go_on) == [[0, 1, 2, 3], [4, 5, 6, 7]]


def test_fewer_groups_are_preferred_within_the_volume():
    cells = [CUBE, CUBE + [1, 0, 0], CUBE + [0, 0, 1]]
    assert len(merge_cells(cells, 3, 3.0, go_on)) == 2
    assert len(merge_cells(cells, 3, 4.0, go_on)) == 1


def test_distant_cells_are_merged_if_the_number_demands_it():
    cells = [CUBE, CUBE + [10, 0, 0], CUBE + [0, 30, 0]]
    assert merge_cells(cells, 2, 0.0, go_on) == [[2], [0, 1]]


def greedily_merged(cells, most):
    """Return groups after the pair whose common hull adds least volume was joined, again and again."""
    groups = [[cell] for cell in range(len(cells))]
    while len(groups) > 1:
        pairs = list(combinations(range(len(groups)), 2))
        growth = [
            total(cells, [groups[i] + groups[j]]) - total(cells, [groups[i], groups[j]]) for i, j in pairs
        ]
        i, j = pairs[int(np.argmin(growth))]
        if len(groups) <= most and min(growth) > 0.0:
            break
        groups = [group for k, group in enumerate(groups) if k not in (i, j)] + [groups[i] + groups[j]]
    return groups


def test_moves_between_groups_reduce_the_volume_that_greedy_merging_leaves():
    gains = []
    for seed in range(8):
        heights = np.random.default_rng(seed).uniform(1.0, 3.0, (3, 3))
        cells = [CUBE * [1, 1, heights[i, j]] + [i, j, 0] for i in range(3) for j in range(3)]
        greedy = total(cells, greedily_merged(cells, 3))
        gains.append(1.0 - total(cells, merge_cells(cells, 3, 0.0, go_on)) / greedy)
    assert min(gains) >= -1e-9
    assert max(gains) > 0.03


def test_a_stopped_search_leaves_the_cells_as_they_are():
    cells = [CUBE + [x, 0, 0] for x in range(4)]
    assert merge_cells(cells, 1, 99.0, lambda: True) == [[0], [1], [2], [3]]


def test_the_volume_of_a_hull_is_that_of_its_polyhedron():
    assert hull_volume(CUBE * [2, 3, 4]) == pytest.approx(24.0)
