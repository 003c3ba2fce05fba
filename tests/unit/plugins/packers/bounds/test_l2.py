"""Bounds: against the published means of L2, by hand, and with clearance, zones and round plates."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.boxes import boxes_problem
from tests.shared.examples import examples

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, Orientations, Packing, PackingProblem, Placement
from amprep.plugins.packers.bounds import l2
from amprep.plugins.packers.bounds.combinatorial import builds_bound, fill_bound
from amprep.plugins.packers.bounds.l2 import l2_bound
from amprep.plugins.packers.instance.prepare import prepare

# mean L2 of ten instances each, n = 50, 100, 150, 200 (Martello, Pisinger, Vigo; see docs/algorithms.md)
PUBLISHED = {
    4: (28.7, 57.6, 85.2, 116.3),
    5: (7.3, 12.9, 17.4, 24.4),
    6: (8.7, 17.5, 26.9, 35.0),
    8: (8.0, 17.5, 21.3, 26.7),
}
SIDE = {4: 100, 5: 100, 6: 10, 8: 100}


def martello_pisinger_vigo(kind, n, index):
    """Sizes ``(n, 3)`` of an instance: 48-bit linear congruential draws, in the authors' order."""
    state, side = ((index + n) << 16) + 0x330E, SIDE[kind]

    def draw(first, last):
        nonlocal state
        state = (0x5DEECE66D * state + 0xB) % 2**48
        return first + (state >> 17) % (last - first + 1)

    short, long = (1, side // 2), (2 * side // 3, side)
    ranges = {
        1: (short, long, long),
        2: (long, short, long),
        3: (long, long, short),
        4: ((side // 2, side),) * 3,
        5: (short,) * 3,
        6: ((1, 10),) * 3,
        8: ((1, 100),) * 3,
    }
    sizes = []
    for _ in range(n):
        other = draw(1, 10) if kind <= 5 else kind
        sizes.append([draw(*r) for r in ranges[other if other <= 5 else kind]])
    return np.array(sizes, dtype=float)


@pytest.mark.parametrize("kind", sorted(PUBLISHED))
def test_l2_reproduces_the_published_means(kind):
    room = np.full(3, float(SIDE[kind]))
    for n, mean in zip((50, 100, 150, 200), PUBLISHED[kind], strict=True):
        bounds = [l2_bound(martello_pisinger_vigo(kind, n, index), room, 0.0) for index in range(1, 11)]
        assert np.mean(bounds) == pytest.approx(mean)


def test_l2_of_thousands_of_different_sizes_tries_few_thresholds():
    sizes, room = np.random.default_rng(0).uniform(10.0, 60.0, (20_000, 3)), np.full(3, 100.0)
    for count in (2_000, 10_000, 20_000):
        tried = len(l2._thresholds(sizes[:count, 0]))
        assert tried * count <= l2.MOST_THRESHOLDS * l2.MANY
        assert tried >= l2.FEWEST_THRESHOLDS
    assert l2_bound(sizes, room, 0.0) >= sizes.prod(axis=1).sum() / room.prod()


def problem(
    sizes, size=(100, 100, 100), *, shape="box", zones=((), ()), value=1.0, orientations=None, **rules
):
    space = BuildVolume(np.array(size, float), shape, *(np.array(z, float).reshape(-1, 3) for z in zones))
    turns = orientations or Orientations()
    items = [
        Item(i, 0, Boxes(np.zeros((1, 3)), np.array([s], float)), value, turns) for i, s in enumerate(sizes)
    ]
    return PackingProblem(tuple(items), space, **rules)


def bound(*args, **rules):
    return builds_bound(prepare(problem(*args, **rules)))


def test_boxes_over_half_in_every_direction_need_a_build_each():
    assert bound([(51, 51, 51)] * 5) == 5
    assert bound([(50, 50, 50)] * 8) == 1


def test_clearance_makes_two_boxes_conflict_that_would_touch():
    assert bound([(50, 90, 90)] * 2) == 1
    # between walls 100 - 2 = 98 are left: 2 * 48 + 1 = 97 fit, 2 * 49 + 1 = 99 do not
    assert bound([(48, 90, 90)] * 2, clearance=1.0) == 1
    assert bound([(49, 90, 90)] * 2, clearance=1.0) == 2


def test_without_stacking_the_plate_counts():
    flat = [(50, 50, 10)] * 9
    assert bound(flat) == 1
    assert bound(flat, stacking=False) == 3


def test_zones_count_as_lost():
    zones = [(0, 0, 0)], [(100, 100, 50)]
    assert bound([(50, 100, 50)] * 4) == 1
    assert bound([(50, 100, 50)] * 4, zones=zones) == 2


def test_a_cylinder_holds_less_than_its_box():
    # three squares of 50 are 7500 mm2, the circle of diameter 100 is 7854 mm2, four are 10000 mm2
    assert bound([(50, 50, 100)] * 3, shape="cylinder") == 1
    assert bound([(50, 50, 100)] * 4, shape="cylinder") == 2


def test_a_box_that_may_be_turned_counts_with_its_least_sides():
    turn = Orientations(matrices=np.array([np.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]]]))
    assert bound([(51, 90, 100)] * 2) == 2
    assert bound([(40, 60, 100), (40, 60, 100)], orientations=turn) == 1


def test_too_large_items_count_for_nothing():
    assert bound([(101, 1, 1)]) == 0
    assert fill_bound(prepare(problem([(101, 1, 1), (1, 1, 1)], objective="fill"))) == 1.0


def test_the_fill_bound_is_the_fractional_knapsack():
    # room for one and a half of the boxes of 100 x 100 x 60, worth 1 each; the tolerance adds a little
    assert fill_bound(prepare(problem([(100, 100, 60)] * 3, objective="fill"))) == pytest.approx(
        100 / 60, rel=1e-3
    )


@examples(80)
@given(st.data())
def test_boxes_cut_from_whole_rooms_never_have_a_bound_above_the_number_of_rooms(data):
    # cutting with the clearance as saw width gives a packing of known size
    gap = data.draw(st.sampled_from([0.0, 2.0]))
    rooms, boxes = data.draw(st.integers(1, 3)), []

    def cut(size, depth):
        axis = data.draw(st.integers(0, 2))
        if depth == 0 or size[axis] < 4 + gap:
            boxes.append(tuple(size))
            return
        at = data.draw(st.floats(1.0, size[axis] - gap - 1.0))
        near, far = list(size), list(size)
        near[axis], far[axis] = at, size[axis] - gap - at
        cut(near, depth - 1)
        cut(far, depth - 1)

    for _ in range(rooms):
        cut([100.0 - 2 * gap, 100.0 - 2 * gap, 100.0 - gap], 3)
    assert bound(boxes, clearance=gap) <= rooms


@pytest.mark.parametrize("objective", ["builds", "fill"])
@pytest.mark.parametrize("places", [((0, 0, 0), (0, 0, 0)), ((0, 0, 0), (-5, 0, 8))])
def test_fixed_items_that_stand_within_one_another_or_outside_prove_nothing(objective, places):
    from amprep.checks.packing.volumes_placed import check_packing
    from amprep.model import Placement, Stop, silent
    from amprep.plugins.packers.auto import pack_auto
    from amprep.plugins.packers.params import AutoParams

    fixed = tuple(Placement(i, np.eye(3), np.array(at, float)) for i, at in enumerate(places))
    sizes = [(10, 10, 8), (10, 10, 8), (10, 10, 6)]
    task = problem(sizes, size=(10, 10, 15), value=600.0, objective=objective, fixed=fixed)
    packing = pack_auto(
        task, params=AutoParams(work=1.0), rng=np.random.default_rng(0), stop=Stop(), progress=silent
    )
    assert check_packing(task, packing) == []


def test_fixed_items_that_keep_the_rules_count():
    from amprep.model import Placement

    fixed = (Placement(0, np.eye(3), np.zeros(3)),)
    assert bound([(51, 51, 51)] * 3, fixed=fixed) == 3
    assert fill_bound(prepare(problem([(100, 100, 60)] * 2, value=6.0, fixed=fixed))) < 10.1


@pytest.mark.parametrize("height", [0.0, 1e-4])
def test_boxes_too_thin_to_be_apart_take_no_plate_area(height):
    # without clearance the judge accepts all of them in one place
    task = boxes_problem([(60, 60, height)] * 5, 100, stacking=False)
    in_one_place = tuple(Placement(i, np.eye(3), np.zeros(3)) for i in range(5))
    assert check_packing(task, Packing((in_one_place,), bound=float(builds_bound(prepare(task))))) == []
    assert builds_bound(prepare(replace(task, clearance=1.0))) == 5
