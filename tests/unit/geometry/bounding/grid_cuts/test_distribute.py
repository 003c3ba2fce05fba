"""Pieces are spent where they save most volume."""

from itertools import product

import numpy as np
import pytest

from amprep.geometry.bounding.grid_cuts.distribute import distribute_pieces


def test_each_solid_has_a_piece_even_if_there_are_too_few():
    curve = np.array([10.0, 5.0])
    assert distribute_pieces([curve, curve], [1, 1], 1, [0.0, 0.0]).tolist() == [1, 1]


def test_copies_count():
    curve = np.array([10.0, 5.0])
    assert distribute_pieces([curve, curve], [1, 3], 3, [0.0, 0.0]).tolist() == [1, 2]


def test_a_gain_that_needs_several_pieces_is_found():
    frame = np.array([10.0, 10.0, 10.0, 4.0])
    assert distribute_pieces([frame], [1], 4, [0.1]).tolist() == [4]


def test_pieces_that_save_less_than_the_least_gain_are_not_used():
    assert distribute_pieces([np.array([10.0, 9.0, 8.99])], [1], 9, [0.1]).tolist() == [2]


@pytest.mark.parametrize("seed", range(5))
def test_convex_functions_get_the_best_numbers(seed):
    rng = np.random.default_rng(seed)
    curves = [100.0 - np.cumsum(np.sort(rng.random(5))[::-1]) for _ in range(3)]
    copies = [1, 2, 3]
    found = distribute_pieces(curves, copies, 8, [0.0] * 3)

    def total(counts):
        return sum(n * curve[c - 1] for curve, n, c in zip(curves, copies, counts, strict=True))

    best = min(total(counts) for counts in product(range(1, 6), repeat=3) if sum(counts) <= 8)
    assert found.sum() <= 8
    assert total(found) == pytest.approx(best)
