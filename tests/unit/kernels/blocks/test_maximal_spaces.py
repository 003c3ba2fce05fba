"""The kernels of block building agree with brute force on small containers; they run as plain Python here."""

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.kernels import plain

from amprep.kernels.blocks import maximal_spaces
from amprep.kernels.blocks.push import push

SIDE = 5
CONTAINER = np.array([0, 0, 0, SIDE, SIDE, SIDE])
ANY_BOX = np.ones((1, 3), np.int64)
"""A unit box: no space is too small for it."""

boxes = st.tuples(*[st.tuples(st.integers(0, SIDE - 1), st.integers(1, 3)) for _ in range(3)]).map(
    lambda rows: [*(at for at, _ in rows), *(min(at + size, SIDE) for at, size in rows)]
)


def cut_all(placed, monkeypatch):
    """Return the maximal spaces that the kernels keep after the boxes are placed."""
    for name in ("anchor", "_is_within", "_holds_any", "_copy_row", "_split_off", "_add_if_maximal"):
        monkeypatch.setattr(maximal_spaces, name, plain(getattr(maximal_spaces, name)))
    spaces, count = np.zeros((500, 8), np.int64), 1
    spaces[0, :6] = CONTAINER
    fresh, touching = np.zeros((1001, 8), np.int64), np.zeros(500, np.int64)
    for box in placed:
        count = plain(maximal_spaces.cut)(
            spaces, count, np.array(box), CONTAINER, ANY_BOX, 1, False, fresh, touching
        )
    return sorted(map(tuple, spaces[:count, :6].tolist()))


def brute_force(placed):
    """Return the boxes of free unit cells that no one-cell extension leaves free."""
    free = np.ones((SIDE, SIDE, SIDE), bool)
    for x0, y0, z0, x1, y1, z1 in placed:
        free[x0:x1, y0:y1, z0:z1] = False
    ranges = list(itertools.combinations(range(SIDE + 1), 2))
    empty = {
        (x0, y0, z0, x1, y1, z1)
        for (x0, x1), (y0, y1), (z0, z1) in itertools.product(ranges, repeat=3)
        if free[x0:x1, y0:y1, z0:z1].all()
    }
    steps = [tuple(sign * (i == side) for i in range(6)) for side, sign in enumerate((-1, -1, -1, 1, 1, 1))]
    return sorted(
        box
        for box in empty
        if not any(tuple(map(sum, zip(box, step, strict=True))) in empty for step in steps)
    )


@examples(40)  # brute force looks at thousands of boxes
@given(st.lists(boxes, min_size=1, max_size=4))
def test_the_spaces_after_several_cuts_are_all_maximal_empty_boxes(placed):
    with pytest.MonkeyPatch.context() as monkeypatch:
        assert cut_all(placed, monkeypatch) == brute_force(placed)


@given(st.lists(st.tuples(st.integers(1, 90), st.integers(0, 4)), min_size=1, max_size=4))
def test_usable_lengths_are_the_greatest_sums_of_sides(rows):
    sides = np.array([(number, side) for number, (side, _) in enumerate(rows)])
    demand = np.array([count for _, count in rows])
    length = 200
    usable, words = np.zeros((3, length), np.int64), np.zeros(length // 64 + 1, np.uint64)
    starts = np.array([0, len(rows), len(rows), len(rows)])  # no box may be oriented along y or z
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(maximal_spaces, "_or_shifted", plain(maximal_spaces._or_shifted))
        plain(maximal_spaces.usable_lengths)(usable, words, sides, starts, demand)
    sums = {
        sum(n * side for n, (side, _) in zip(counts, rows, strict=True))
        for counts in itertools.product(*[range(count + 1) for _, count in rows])
    }
    assert usable[0].tolist() == [max(each for each in sums if each <= limit) for limit in range(length)]
    assert not usable[1:].any()


def test_the_nearest_space_is_that_with_the_smallest_distance_then_the_largest():
    spaces = np.array([[0, 0, 0, 2, 2, 2, 3, 0], [0, 0, 0, 1, 1, 1, 1, 0], [0, 0, 0, 1, 1, 2, 1, 0]])
    assert plain(maximal_spaces.nearest)(spaces, 3) == 2
    assert plain(maximal_spaces.nearest)(spaces, 2) == 1


def test_a_box_in_the_corner_touches_with_half_its_surface():
    arguments = (CONTAINER, np.zeros((0, 7), np.int64), np.zeros(0, np.int64), 0, np.zeros(3, np.int64))
    assert plain(maximal_spaces.touching_fraction)(np.array([0, 0, 0, 2, 2, 2]), *arguments) == 0.5
    assert plain(maximal_spaces.touching_fraction)(CONTAINER, *arguments) == 1.0


@given(st.lists(boxes, min_size=1, max_size=6))
def test_pushed_boxes_rest_on_the_floor_or_on_a_box_below_and_do_not_overlap(candidates):
    placed: list[Any] = []
    for box in candidates:
        if not any(overlap(box, other) for other in placed):
            placed.append(box)
    moved = np.array(placed, np.int64)
    push(moved, np.argsort(moved[:, 2], kind="stable"), np.zeros((0, 6), np.int64), 2)
    for i, box in enumerate(moved):
        others = [other for j, other in enumerate(moved) if j != i]
        assert not any(overlap(box, other) for other in others)
        below = box.copy()
        below[[2, 5]] -= 1
        assert box[2] == 0 or any(overlap(below, other) for other in others)


def overlap(one, other):
    return all(one[a] < other[3 + a] and other[a] < one[3 + a] for a in range(3))
