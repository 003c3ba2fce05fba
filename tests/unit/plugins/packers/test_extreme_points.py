"""The packer `extreme-points` on problems whose answer is known by hand or by brute force."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.boxes import boxes_problem
from tests.shared.examples import examples

from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import AmprepError
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Mesh,
    Orientations,
    PackingProblem,
    Placement,
    Solid,
    Stop,
    silent,
)
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.params import ExtremePointsParams

QUARTER_TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
Z90 = Orientations(matrices=np.array([np.eye(3), QUARTER_TURN]))


def pack(problem, *, params=None, stop=None, progress=silent):
    """Pack and have the answer judged."""
    packing = pack_extreme_points(
        problem,
        params=params or ExtremePointsParams(),
        rng=np.random.default_rng(0),
        stop=stop or Stop(),
        progress=progress,
    )
    assert check_packing(problem, packing) == []
    return packing


@pytest.mark.parametrize(
    ("size", "count"), [(50.0, 8), (100 / 3, 27), (0.1 + 0.2, 1000), (33.3334, 27), (100.0009, 1)]
)
def test_cubes_that_fill_a_cube_exactly_fit(size, count):
    side = {1000: 3.0}.get(count, 100.0)
    packing = pack(boxes_problem([(size,) * 3] * count, (side,) * 3))
    assert len(packing.builds) == 1
    assert packing.status == "optimal"


def test_the_tolerance_is_for_the_walls_once_not_for_every_contact():
    # ten of 10.0001 are 0.001 too long together, which fits; of 10.0002 they are 0.002 too long, and nine fit
    assert len(pack(boxes_problem([(10.0001, 100.0, 100.0)] * 10, (100,) * 3)).builds) == 1
    assert [
        len(build) for build in pack(boxes_problem([(10.0002, 100.0, 100.0)] * 10, (100,) * 3)).builds
    ] == [9, 1]


def test_a_box_larger_than_the_room_by_more_than_the_tolerance_is_too_large():
    packing = pack(boxes_problem([(100.002, 1, 1), (1, 1, 1)], (100,) * 3))
    assert [(u.item, u.reason) for u in packing.unplaced] == [(0, "too large")]
    assert packing.status == "infeasible"
    assert len(packing.builds) == 1


def test_nothing_to_pack_gives_no_builds():
    packing = pack(PackingProblem((), BuildVolume(np.ones(3))))
    assert packing.builds == ()
    assert packing.status == "optimal"


def test_clearance_is_kept_between_parts_and_to_walls_and_lid_but_not_to_the_plate():
    # 2 + 40 + 2 + 40 + 2 = 86 along x, 44 along y, 42 in height
    sizes = [(40, 40, 40)] * 2
    assert len(pack(boxes_problem(sizes, (86, 44, 42), clearance=2.0)).builds) == 1
    assert len(pack(boxes_problem(sizes, (85.99, 44, 42), clearance=2.0)).builds) == 2
    assert len(pack(boxes_problem(sizes, (86, 44, 41.99), clearance=2.0)).unplaced) == 2


def test_lift_raises_the_lowest_parts():
    packing = pack(boxes_problem([(10, 10, 10)], (10, 10, 15), lift=5.0))
    assert packing.builds[0][0].translation[2] == 5.0
    assert pack(boxes_problem([(10, 10, 10)], (10, 10, 14.9), lift=5.0)).unplaced[0].reason == "too large"


def test_without_stacking_all_parts_stand_on_the_plate():
    sizes = [(50, 50, 10)] * 8
    assert len(pack(boxes_problem(sizes, (100, 100, 100), stacking=True)).builds) == 1
    packing = pack(boxes_problem(sizes, (100, 100, 100), stacking=False, lift=3.0))
    assert [len(build) for build in packing.builds] == [4, 4]
    assert packing.status == "optimal"


def test_a_part_is_turned_when_only_that_makes_it_fit():
    problem = boxes_problem([(30, 90, 5)], (90, 30, 5), orientations=Z90)
    assert np.array_equal(pack(problem).builds[0][0].rotation, QUARTER_TURN)
    assert pack(boxes_problem([(30, 90, 5)], (90, 30, 5))).unplaced[0].reason == "too large"


def test_a_listed_rotation_by_45_degrees_takes_the_box_around_the_turned_box():
    c = np.sqrt(0.5)
    turn = Orientations(matrices=np.array([[[c, -c, 0.0], [c, c, 0.0], [0.0, 0.0, 1.0]]]))
    side = 20.0 * c * 2.0
    assert len(pack(boxes_problem([(20, 20, 5)], (side, side, 5), orientations=turn)).builds) == 1
    assert pack(boxes_problem([(20, 20, 5)], (side - 0.01, side, 5), orientations=turn)).unplaced


def test_two_interlocking_items_of_two_boxes_share_a_build():
    # an L of 2 x 2 with one quarter missing, and the same turned by half: together 3 x 2
    corner = Boxes(np.array([[0, 0, 0], [0, 1, 0]], float), np.array([[2, 1, 1], [1, 2, 1]], float))
    opposite = Boxes(np.array([[0, 1, 0], [1, 0, 0]], float), np.array([[2, 2, 1], [2, 1, 1]], float))
    items = (Item(0, 0, corner, 3.0), Item(1, 0, opposite, 3.0))
    packing = pack(PackingProblem(items, BuildVolume(np.array([3.0, 2.0, 1.0]))))
    assert len(packing.builds) == 1


def test_forbidden_zones_are_left_out_and_need_no_clearance():
    # around a pillar of 10 in the middle of 30 x 30 there is room for eight boxes of 10
    space = BuildVolume(np.array([30.0, 30.0, 10.0]), zone_lo=[[10, 10, 0]], zone_hi=[[20, 20, 10]])
    assert len(pack(boxes_problem([(10, 10, 10)] * 8, space)).builds) == 1
    assert len(pack(boxes_problem([(10, 10, 10)] * 9, space)).builds) == 2
    assert len(pack(boxes_problem([(9, 9, 9)], space, clearance=1.0)).builds) == 1


def test_an_item_that_fits_only_behind_a_zone_is_found():
    space = BuildVolume(np.array([30.0, 10.0, 10.0]), zone_lo=[[2, 0, 0]], zone_hi=[[12.5, 10, 10]])
    packing = pack(boxes_problem([(17.5, 10, 10)], space))
    assert packing.builds[0][0].translation[0] == 12.5


def test_fixed_placements_stay_in_the_first_build_and_others_keep_away():
    sizes = [(50, 100, 100)] * 3
    fixed = (Placement(1, np.eye(3), np.array([50.0, 0.0, 0.0])),)
    packing = pack(boxes_problem(sizes, (100,) * 3, fixed=fixed))
    assert packing.builds[0][0] is fixed[0]
    assert [len(build) for build in packing.builds] == [2, 1]


def test_a_fixed_item_off_by_float_noise_still_leaves_room_for_its_neighbour():
    fixed = (Placement(0, np.eye(3), np.array([50.00002, 0.0, 0.0])),)
    packing = pack(boxes_problem([(50, 100, 100), (50.0002, 100, 100)], (100,) * 3, fixed=fixed))
    assert len(packing.builds) == 1


def test_fill_takes_the_greatest_value_not_the_greatest_volume():
    packing = pack(
        boxes_problem([(10, 10, 10), (9, 9, 9)], (10, 10, 10), values=[1.0, 5.0], objective="fill")
    )
    assert [p.item for p in packing.builds[0]] == [1]
    assert [(u.item, u.reason) for u in packing.unplaced] == [(0, "no room left")]


def test_fill_that_places_everything_is_optimal():
    packing = pack(boxes_problem([(5, 5, 5)] * 8, (10, 10, 10), objective="fill"))
    assert packing.status == "optimal"
    assert packing.bound == 8 * 125.0


def test_a_cylinder_takes_what_fits_its_circle():
    def cylinder(diameter, height=100.0):
        return BuildVolume(np.array([diameter, diameter, height]), "cylinder")

    # four squares of 35 reach 35 * sqrt(2) = 49.5 from the axis; in height 100 two layers of two cubes of 40
    assert len(pack(boxes_problem([(35, 35, 35)] * 4, cylinder(100.0), stacking=False)).builds) == 1
    assert len(pack(boxes_problem([(40, 40, 40)] * 4, cylinder(100.0))).builds) == 1
    assert pack(boxes_problem([(71, 71, 5)], cylinder(100.0))).unplaced[0].reason == "too large"
    assert len(pack(boxes_problem([(60, 80, 5)], cylinder(104.0), clearance=2.0)).builds) == 1


def test_a_cylinder_is_filled_with_small_squares_as_well_as_rows_can():
    # rows of squares of 10 centred on the axis of a circle of 100: 9 + 2 (9 + 8 + 7 + 4) = 65
    space = BuildVolume(np.array([100.0, 100.0, 10.0]), "cylinder")
    packing = pack(boxes_problem([(10, 10, 10)] * 80, space, objective="fill", stacking=False))
    assert len(packing.builds[0]) >= 65


def test_identical_parts_stand_in_rows():
    packing = pack(boxes_problem([(20, 15, 10)] * 20, (100, 100, 50), stacking=False))
    places = np.array([p.translation for p in packing.builds[0]])
    assert sorted(set(places[:, 1].tolist())) == [0.0, 15.0, 30.0, 45.0]
    assert sorted(set(places[:, 0].tolist())) == [0.0, 20.0, 40.0, 60.0, 80.0]


def test_among_packings_of_as_many_builds_the_lower_one_is_kept():
    # two plates of 10 x 10 x 1 side by side, not one upon the other
    packing = pack(boxes_problem([(10, 10, 1)] * 2, (20, 10, 10)))
    assert max(p.translation[2] for p in packing.builds[0]) == 0.0


def test_the_same_problem_gives_the_same_packing():
    rng = np.random.default_rng(5)
    problem = boxes_problem(rng.integers(5, 60, (40, 3)).tolist(), (100,) * 3)
    one, other = (pack(problem, params=ExtremePointsParams(restarts=20)) for _ in range(2))
    assert [[p.matrix.tolist() for p in b] for b in one.builds] == [
        [p.matrix.tolist() for p in b] for b in other.builds
    ]


def test_more_restarts_are_never_worse():
    rng = np.random.default_rng(6)
    problem = boxes_problem(rng.integers(10, 60, (60, 3)).tolist(), (100,) * 3)
    few = pack(problem, params=ExtremePointsParams(orderings=1))
    many = pack(problem, params=ExtremePointsParams(orderings=1, restarts=50))
    assert len(many.builds) <= len(few.builds)


def test_a_stop_gives_the_best_so_far_and_says_why():
    rng = np.random.default_rng(7)
    problem = boxes_problem(rng.integers(5, 60, (40, 3)).tolist(), (100,) * 3)
    packing = pack(problem, stop=Stop.after(0.0))
    assert packing.stop_reason == "time limit"
    assert all(u.reason == "out of time" for u in packing.unplaced)


def test_the_work_limit_ends_the_search_and_is_named():
    rng = np.random.default_rng(8)
    problem = boxes_problem(rng.integers(5, 60, (40, 3)).tolist(), (100,) * 3)
    assert pack(problem, params=ExtremePointsParams(work=0)).stop_reason == "work used up"


def test_progress_rises_and_stays_below_one():
    seen = []
    pack(
        boxes_problem([(10, 20, 30), (7, 6, 5)], (100,) * 3), progress=lambda share, words: seen.append(share)
    )
    assert seen == sorted(seen)
    assert 0.0 < seen[-1] < 1.0


@pytest.mark.parametrize(
    ("bad", "value"), [("orderings", -1), ("restarts", -1), ("disturbance", 0.0), ("work", float("nan"))]
)
def test_a_parameter_out_of_bounds_is_refused_with_rule_and_value(bad, value):
    with pytest.raises(ValueError, match=rf"{bad} must be .*{value}"):
        ExtremePointsParams(**{bad: value})


def test_a_volume_that_is_not_boxes_is_refused():
    tetrahedron = Mesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    )
    problem = PackingProblem((Item(0, 0, Solid(tetrahedron), 1.0),), BuildVolume(np.ones(3) * 9))
    with pytest.raises(AmprepError, match="packs boxes, got Solid"):
        pack(problem)


def test_a_negative_value_is_refused():
    with pytest.raises(AmprepError, match=r"between 0 and 1e\+15, got -1"):
        pack(boxes_problem([(1, 1, 1)], (9, 9, 9), values=[-1.0], objective="fill"))


# brute force: integer boxes have an integer packing whenever they have any


def fits_one_build(sizes, room, placed=()):
    """Whether integer boxes fit an integer room, by trying all integer places."""
    if not sizes:
        return True
    size = sizes[0]
    for position in itertools.product(*(range(r - s + 1) for r, s in zip(room, size, strict=True))):
        clear = all(
            any(position[a] >= p[a] + s[a] or p[a] >= position[a] + size[a] for a in range(3))
            for p, s in placed
        )
        if clear and fits_one_build(sizes[1:], room, (*placed, (position, size))):
            return True
    return False


def fewest_builds(sizes, room):
    """The least number of groups that each fit one build."""
    n = len(sizes)
    fits = {
        group: fits_one_build([s for i, s in enumerate(sizes) if group >> i & 1], room)
        for group in range(1, 1 << n)
    }
    best = {0: 0}
    for group in range(1, 1 << n):
        parts = (p for p in range(1, group + 1) if p & group == p and fits[p])
        best[group] = min(best[group ^ p] + 1 for p in parts)
    return best[(1 << n) - 1]


ROOM = (4, 3, 3)
tiny_sizes = st.lists(st.tuples(*(st.integers(1, r) for r in ROOM)), min_size=1, max_size=4)


@examples(60)
@given(tiny_sizes)
def test_bound_and_packing_enclose_the_brute_force_optimum(sizes):
    packing, best = pack(boxes_problem(sizes, ROOM)), fewest_builds(sizes, ROOM)
    assert packing.bound <= best <= len(packing.builds)
    assert len(packing.builds) == best or packing.status != "optimal"


@examples(60)
@given(tiny_sizes.filter(lambda sizes: len(sizes) <= 2))
def test_two_boxes_are_packed_optimally(sizes):
    assert len(pack(boxes_problem(sizes, ROOM)).builds) == fewest_builds(sizes, ROOM)


@examples(60)
@given(tiny_sizes, st.data())
def test_the_fill_bound_is_no_less_than_the_brute_force_optimum(sizes, data):
    values = [float(data.draw(st.integers(0, 9))) for _ in sizes]
    packing = pack(boxes_problem(sizes, ROOM, values=values, objective="fill"))
    groups = itertools.chain.from_iterable(
        itertools.combinations(range(len(sizes)), k) for k in range(len(sizes) + 1)
    )
    best = max(sum(values[i] for i in g) for g in groups if fits_one_build([sizes[i] for i in g], ROOM))
    reached = sum(values[p.item] for build in packing.builds for p in build)
    assert reached <= best <= packing.bound + 1e-9
    assert reached == best or packing.status != "optimal"


def test_with_many_boxes_the_slow_passes_come_last():
    from amprep.kernels.boxes.records import MERIT_OF, TOUCHING
    from amprep.plugins.packers.extreme_points import constructive_passes
    from amprep.plugins.packers.instance.prepare import prepare

    sizes = np.random.default_rng(0).integers(1, 9, (600, 3)).tolist()
    instance = prepare(boxes_problem(sizes, (100, 100, 100)))
    slow = [each.rule[MERIT_OF] == TOUCHING for each in constructive_passes(instance)]
    assert slow == sorted(slow)
    assert any(slow)
