"""Rows, layers and builds of the kernel behind `sweep`: no overlap, nothing outside, known packings."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.kernels.boxes.rows import RowScratch, fill_rows

ROOM = np.array([10.0, 8.0, 6.0])


def packed(sizes, builds, *, flat=False):
    size, n = np.array(sizes, float), len(sizes)
    build, position = np.full(n, -1, np.int64), np.zeros((n, 3))
    scratch = RowScratch(np.zeros((n, 6)), np.zeros((n, 4)), np.zeros(n))
    fill_rows(np.arange(n), size, ROOM, flat, builds, build, position, scratch)
    return build, position, size


@examples(150)
@given(
    st.lists(st.tuples(st.integers(1, 10), st.integers(1, 8), st.integers(1, 6)), min_size=1, max_size=20),
    st.booleans(),
)
def test_boxes_are_inside_and_apart_and_all_placed_when_builds_suffice(sizes, flat):
    build, position, size = packed(sizes, len(sizes), flat=flat)
    assert (build >= 0).all()
    assert (position >= 0.0).all()
    assert (position + size <= ROOM + 1e-9).all()
    assert not flat or (position[:, 2] == 0.0).all()
    for one, other in itertools.combinations(range(len(sizes)), 2):
        if build[one] == build[other]:
            before = position[one] + size[one] <= position[other] + 1e-9
            behind = position[other] + size[other] <= position[one] + 1e-9
            assert (before | behind).any()


def test_a_box_goes_into_the_row_and_a_box_that_is_too_deep_starts_another():
    build, position, _ = packed([(5, 4, 3), (5, 4, 3), (5, 2, 3), (5, 5, 3)], 2)
    assert build.tolist() == [0, 0, 0, 0]
    assert position.tolist() == [[0, 0, 0], [5, 0, 0], [0, 4, 0], [0, 0, 3]]


def test_no_more_builds_are_opened_than_allowed():
    build, _, _ = packed([(10, 8, 6)] * 3, 2)
    assert build.tolist() == [0, 1, -1]
