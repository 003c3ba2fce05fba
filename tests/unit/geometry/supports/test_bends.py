"""Places of a leg that are wider for a short stretch do not count, longer ones do."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.supports.bends import without_bends


@pytest.mark.parametrize(
    ("widths", "expected"),
    [
        ([1, 1, 5, 1, 1], [1, 1, 1, 1, 1]),
        ([1, 1, 5, 4, 1, 1], [1, 1, 1, 1, 1, 1]),
        ([1, 5, 4, 6, 1], [1, 4, 4, 4, 1]),
        ([5, 1, 1, 6], [5, 1, 1, 6]),
        ([2], [2]),
        ([], []),
    ],
)
def test_one_or_two_wider_pieces_are_left_out_but_not_three_nor_those_at_the_ends(widths, expected):
    assert without_bends(widths) == expected


@given(st.lists(st.integers(1, 6), max_size=12))
@examples(100)
def test_a_piece_is_as_wide_as_the_narrowest_of_the_best_three_neighbours_that_contain_it(widths):
    def width(i):
        return math.inf if not 0 <= i < len(widths) else widths[i]

    runs = [range(first, first + 3) for first in range(-2, len(widths))]
    best = [max(min(map(width, run)) for run in runs if i in run) for i in range(len(widths))]
    assert without_bends(widths) == best
