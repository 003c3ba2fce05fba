"""Bounds by geometry: scales never add up to more than 1, sets ruled out never fit, and the cover stays below."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.boxes import boxes_problem as problem
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.kernels.boxes.relations import IMPOSSIBLE, POSSIBLE, UNKNOWN, fit_together, relation_scratch
from amprep.model import Stop, silent
from amprep.plugins.packers.auto import pack_auto
from amprep.plugins.packers.auto.set_covering import Pool, choose_builds
from amprep.plugins.packers.bounds.combinatorial import builds_bound, relaxed_boxes
from amprep.plugins.packers.bounds.dual_feasible import greatest_scale, greatest_scales, measures
from amprep.plugins.packers.bounds.fractional_cover import CoveringBound
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.params import AutoParams
from amprep.testing.packing_instances import mpv_instance


def proved(task, work=50e6):
    instance = prepare(task)
    bound = CoveringBound(instance, builds_bound(instance))
    bound.prove(lambda: 10**9, work, Stop())
    return bound.builds


@examples(200)
@given(st.lists(st.integers(1, 60), min_size=1, max_size=12))
def test_lengths_that_fit_a_row_keep_fitting_under_every_measure(lengths):
    row = [n for n, total in zip(lengths, itertools.accumulate(lengths), strict=True) if total <= 60]
    assert (measures(np.array(row) / 60.0).sum(axis=1) <= 1.0 + 1e-9).all()


def fits_by_trial(sizes, room):
    """Whether small whole boxes fit: every position on the integer grid is tried."""
    taken = np.zeros(room, bool)

    def place(rest):
        if not len(rest):
            return True
        for at in itertools.product(*(range(r - s + 1) for r, s in zip(room, rest[0], strict=True))):
            where = tuple(slice(a, a + s) for a, s in zip(at, rest[0], strict=True))
            if not taken[where].any():
                taken[where] = True
                if place(rest[1:]):
                    return True
                taken[where] = False
        return False

    return place(sizes)


@examples(150)
@given(st.lists(st.tuples(*[st.integers(1, 4)] * 3), min_size=1, max_size=5))
def test_relations_agree_with_trying_every_position(sizes):
    room, scratch = (4, 4, 3), relation_scratch(5)
    boxes = np.array(sizes, float)
    verdict, _ = fit_together(len(boxes), boxes, np.array(room, float), 10**6, scratch)
    assert (verdict == POSSIBLE) == fits_by_trial(sizes, room)
    if verdict == POSSIBLE:
        position = scratch.head[len(boxes) * (len(boxes) - 1) // 2, :, : len(boxes)].T
        assert (position + boxes <= np.array(room)).all()
        for one, other in itertools.combinations(range(len(boxes)), 2):
            apart = (position[one] + boxes[one] <= position[other]) | (
                position[other] + boxes[other] <= position[one]
            )
            assert apart.any()


def test_a_search_that_is_cut_off_settles_nothing_and_three_long_boxes_do_not_share_a_small_room():
    long = np.array([[2.0, 2.0, 3.0], [2.0, 3.0, 2.0], [3.0, 2.0, 2.0]])
    assert fit_together(3, long, np.full(3, 3.5), 1000, relation_scratch(3))[0] == IMPOSSIBLE
    assert fit_together(3, long, np.full(3, 4.0), 0, relation_scratch(3))[0] == UNKNOWN


def test_nine_boxes_of_which_two_share_a_build_need_five_where_the_volume_says_two():
    # sides over half count 1, a side of half counts a half
    task = problem([(3, 3, 2)] * 9, (5, 5, 4))
    assert greatest_scale(np.array([[0.6, 0.6, 0.5]]), np.array([9])) == pytest.approx(4.5)
    assert builds_bound(prepare(task)) == 5


def test_the_first_scale_is_the_volume_and_no_two_are_alike():
    fraction = np.random.default_rng(1).uniform(0.1, 0.9, (20, 3))
    found = greatest_scales(fraction, np.ones(20, np.int64), 6)
    assert np.allclose(found[:, 0], fraction.prod(axis=1))
    for one, other in itertools.combinations(found.T, 2):
        assert np.abs(one - other).max() > 0.08


@examples(15)
@given(st.lists(st.tuples(*[st.integers(2, 8)] * 3), min_size=4, max_size=14))
def test_the_cover_never_proves_more_than_a_packing_needs(sizes):
    task = problem(sizes)
    found = pack_auto(
        task, params=AutoParams(work=2.0), rng=np.random.default_rng(0), stop=Stop(), progress=silent
    )
    assert builds_bound(prepare(task)) <= proved(task, 5e6) <= len(found.builds)


def test_the_cover_proves_what_scales_do_not():
    # class 1 of Martello, Pisinger, Vigo, n = 50, instance 8: 17 builds are needed
    task = mpv_instance(1, 50, 8).problem
    assert builds_bound(prepare(task)) == 16
    assert proved(task) == 17


def test_clearance_and_tolerance_are_relaxed_and_whole_lengths_stay_whole():
    exact = relaxed_boxes(prepare(problem([(5, 5, 5)] * 2)))
    assert (exact.size == 5.0).all()
    assert (exact.room == 10.0).all()
    spaced = relaxed_boxes(prepare(problem([(4, 4, 4)] * 2, clearance=1.0)))
    assert spaced.size[0, 0] < 4.0 + 1.0 / np.sqrt(3.0)
    # two diagonal neighbours at Euclidean distance 1 pass: the relaxation must let them
    assert proved(problem([(3, 3, 3)] * 8, clearance=1.0)) == 1


def test_builds_are_chosen_from_the_pool_or_not_at_all():
    # item types 0 to 3 once each; two builds hold them all, the first three take one build more
    pool = Pool(np.array([0, 1, 3, 4, 6, 8]), np.array([0, 1, 2, 3, 0, 1, 2, 3]))
    demand = np.ones(4, np.int64)
    chosen = choose_builds(pool, demand, np.array([0, 1, 2]), 2, Stop())
    assert sorted(present(chosen).tolist()) == [3, 4]
    assert choose_builds(pool, demand, np.array([0, 1, 2]), 1, Stop()) is None
