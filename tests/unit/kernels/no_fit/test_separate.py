"""The guided search removes overlaps, stays in its room, repeats itself, and counts its work."""

import numpy as np
import pytest
from tests.shared.no_fit import box_shapes, boxes_overlap, in_box, layout_of, rules_for, state_for

from amprep.kernels.guided_search import MOVES, READ, ROUNDS, SCANS
from amprep.kernels.no_fit.records import PAIRS
from amprep.kernels.no_fit.separate import separate

SIZES = [[4, 4, 2], [2, 4, 4], [4, 2, 4], [2, 2, 2]]
ITEMS = [0, 0, 1, 1, 2, 2, 3, 3]


def two_at_once():
    return layout_of([0, 0], np.zeros((2, 3)))


def least_of(fields, within, rules, layout, best, state, rounds, work=10**12):
    """The total overlap of the best layout after some rounds."""
    separate(fields, within, rules, layout, best, state, rounds, work)
    return state.least[0]


def run(rounds=200, seed=7, room=(7.0, 7.0, 7.0), work=10**12):
    _, fields = box_shapes(SIZES, 0.5)
    rng = np.random.default_rng(seed)
    layout, best = layout_of(ITEMS, rng.uniform(0, 3, (8, 3))), layout_of(ITEMS, np.zeros((8, 3)))
    state = state_for(8, 8**3, seed)
    least = least_of(fields, in_box(SIZES, room), rules_for(ITEMS), layout, best, state, rounds, work)
    return least, best, state


def test_boxes_that_fill_two_thirds_of_a_room_are_separated():
    least, best, _ = run()
    assert least <= 1e-6
    pairs = [(i, j) for i in range(8) for j in range(i) if boxes_overlap(SIZES, best, i, j)]
    assert pairs == []
    assert (best.position >= 0.0).all()
    assert (best.position + np.array(SIZES)[best.shape] <= 7.0 + 1e-9).all()


def test_the_best_layout_has_the_overlap_that_is_returned():
    least, best, _ = run(rounds=2, room=(5.0, 5.0, 5.0))
    assert least > 0.0
    _, fields = box_shapes(SIZES, 0.5)
    state = state_for(8, 8**3)
    again = least_of(
        fields,
        in_box(SIZES, (5.0, 5.0, 5.0)),
        rules_for(ITEMS),
        best,
        layout_of(ITEMS, np.zeros((8, 3))),
        state,
        0,
    )
    assert again == pytest.approx(least)
    assert again == pytest.approx(state.overlap.sum() / 2.0)


def test_the_same_seed_gives_the_same_layout_and_another_one_another():
    assert (run(20)[1].position == run(20)[1].position).all()
    assert (run(20)[1].position != run(20, seed=8)[1].position).any()


def test_work_is_counted():
    _, _, state = run(3, room=(5.0, 5.0, 5.0))
    assert state.spent[ROUNDS] == 3
    assert 3 <= state.spent[MOVES] <= 24
    assert state.spent[READ] > state.spent[SCANS] > 0


def test_weights_grow_for_pairs_that_overlap_and_stay_one_for_others():
    _, fields = box_shapes([[4, 4, 4]], 0.5)
    layout = two_at_once()
    state = state_for(2, 8)
    least_of(
        fields,
        in_box([[4, 4, 4]], (4.0, 4.0, 4.0)),
        rules_for([0, 0]),
        layout,
        two_at_once(),
        state,
        5,
    )
    assert state.weight[0, 1] == state.weight[1, 0] == pytest.approx(1.5**5)
    assert state.weight[0, 0] == 1.0


def test_an_item_changes_its_shape_or_its_build_where_it_would_overlap():
    sizes = [[6, 2, 2], [2, 6, 2]]
    _, fields = box_shapes(sizes, 0.5)
    layout, best = two_at_once(), two_at_once()
    crossed = least_of(
        fields,
        in_box(sizes, (6.0, 6.0, 2.0)),
        rules_for([0, 0], ends=[2, 2]),
        layout,
        best,
        state_for(2, 64),
        50,
    )
    assert crossed <= 1e-6
    layout, best = two_at_once(), two_at_once()
    apart = least_of(
        fields,
        in_box(sizes, (6.0, 2.0, 2.0)),
        rules_for([0, 0], builds=2),
        layout,
        best,
        state_for(2, 64),
        50,
    )
    assert apart <= 1e-6
    assert sorted(best.build.tolist()) == [0, 1]


def test_a_call_ends_within_a_round_and_the_next_one_goes_on():
    _, fields = box_shapes(SIZES, 0.5)
    rng = np.random.default_rng(7)
    layout, best = layout_of(ITEMS, rng.uniform(0, 3, (8, 3))), layout_of(ITEMS, np.zeros((8, 3)))
    state, within = state_for(8, 8**3), in_box(SIZES, (5.0, 5.0, 5.0))
    done = calls = 0
    while done < 3:
        done += separate(fields, within, rules_for(ITEMS), layout, best, state, 3 - done, 1)
        calls += 1
    _, whole, state = run(3, room=(5.0, 5.0, 5.0))
    assert state.spent[ROUNDS] == 3
    assert calls > 3 * 3
    assert (best.position == whole.position).all()


@pytest.mark.parametrize("rounds", [1, 7, 40])
def test_overlaps_and_the_list_of_pairs_agree_with_the_layout(rounds):
    """The overlaps are kept up move by move; computed anew from the layout they are the same."""
    _, fields = box_shapes(SIZES, 0.5)
    rng, within = np.random.default_rng(1), in_box(SIZES, (5.0, 5.0, 5.0))
    layout, best = layout_of(ITEMS, rng.uniform(0, 3, (8, 3))), layout_of(ITEMS, np.zeros((8, 3)))
    state, fresh = state_for(8, 8**3), state_for(8, 8**3)
    separate(fields, within, rules_for(ITEMS), layout, best, state, rounds, 10**12)
    separate(fields, within, rules_for(ITEMS), layout, best, fresh, 0, 10**12)
    np.testing.assert_allclose(state.overlap, fresh.overlap, atol=1e-6)
    assert (state.touching == (state.overlap > 0.0).sum(axis=1)).all()
    listed = {tuple(pair) for pair in state.pairs[: state.progress[PAIRS]].tolist()}
    below = np.tril((state.overlap > 0.0) | (state.weight > 1.0), -1)
    assert listed == {tuple(pair) for pair in np.argwhere(below).tolist()}
