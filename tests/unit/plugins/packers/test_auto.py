"""The packer `auto` beats its own start, ends with the bound, and keeps what stands where it is."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.boxes import boxes_problem as problem
from tests.shared.boxes import cut
from tests.shared.grids import Late
from tests.shared.optional import present

from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import JobError
from amprep.kernels.boxes.records import Arrangement
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Placement, Stop, silent
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers import extreme_points
from amprep.plugins.packers.auto import fill, pack_auto
from amprep.plugins.packers.auto.enclosing_boxes import enclosing_instance, with_own_boxes
from amprep.plugins.packers.auto.ruin_and_recreate import no_builds
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.instance.arrangement import PackerResult
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.params import AutoParams, ExtremePointsParams


def run(task, stop=None, **params):
    packing = pack_auto(
        task, params=AutoParams(**params), rng=np.random.default_rng(0), stop=stop or Stop(), progress=silent
    )
    assert check_packing(task, packing) == []
    return packing


def test_three_rooms_cut_up_without_waste_are_put_together_again():
    rng = np.random.default_rng(1)
    task = problem([box for _ in range(3) for box in cut(rng, (10, 10, 10), 6)])
    packing = run(task)
    assert len(packing.builds) == 3
    assert (packing.status, packing.stop_reason) == ("optimal", "bound met")


def test_the_search_saves_builds_that_the_orderings_do_not():
    # class 1 of Martello, Pisinger, Vigo, n = 50, instances 2 and 3: orderings alone need one build more
    from amprep.testing.packing_instances import mpv_instance

    for index, builds in ((2, 14), (3, 14)):
        task = mpv_instance(1, 50, index).problem
        start = pack_extreme_points(
            task, params=ExtremePointsParams(), rng=np.random.default_rng(0), stop=Stop(), progress=silent
        )
        assert len(start.builds) == builds + 1
        assert len(run(task, work=40.0).builds) == builds


def test_boxes_may_be_turned_to_save_a_build():
    sizes = [(10, 10, 5), (10, 5, 10), (5, 10, 10), (5, 10, 10)]
    assert len(run(problem(sizes)).builds) == 3
    assert len(run(problem(sizes, orientations=Orientations("list", axis_rotations()))).builds) == 2


def test_what_is_fixed_stays_in_the_first_build_and_is_never_dissolved():
    sizes = [(4, 4, 4), *np.random.default_rng(3).integers(2, 7, (25, 3)).tolist()]
    fixed = (Placement(0, np.eye(3), np.array([3.0, 3.0, 0.0])),)
    packing = run(problem(sizes, fixed=fixed), work=10.0)
    assert packing.builds[0][0].item == 0


@pytest.mark.parametrize("rules", [{"stacking": False}, {"clearance": 0.5}, {"lift": 1.0}])
def test_the_rules_of_the_job_hold(rules):
    run(problem(np.random.default_rng(4).integers(2, 6, (25, 3)).tolist(), **rules), work=10.0)


def test_a_round_plate_holds_what_it_can():
    items = problem(np.random.default_rng(5).integers(2, 6, (20, 3)).tolist()).items
    run(PackingProblem(items, BuildVolume(np.full(3, 12.0), "cylinder")), work=10.0)


def test_filling_ends_when_all_is_placed():
    packing = run(problem([(5, 5, 5)] * 8, objective="fill"))
    assert (packing.status, packing.stop_reason, packing.bound) == ("optimal", "bound met", 1000.0)


@pytest.mark.compiled
def test_filling_is_never_worse_than_by_the_orderings():
    task = problem(np.random.default_rng(6).integers(2, 7, (40, 3)).tolist(), objective="fill")
    start = pack_extreme_points(
        task, params=ExtremePointsParams(), rng=np.random.default_rng(0), stop=Stop(), progress=silent
    )
    found = [sum(task.items[p.item].value for p in packing.builds[0]) for packing in (start, run(task))]
    assert found[1] >= found[0]


@pytest.mark.compiled
def test_the_budget_of_work_ends_the_search_at_the_same_place_every_time():
    task = problem(np.random.default_rng(7).integers(2, 8, (40, 3)).tolist())
    one, other = run(task, work=5.0), run(task, work=5.0)
    assert [[p.item for p in b] for b in one.builds] == [[p.item for p in b] for b in other.builds]


@pytest.mark.compiled
def test_a_proof_that_ends_after_the_search_is_the_reason_too():
    from amprep.testing.packing_instances import mpv_instance

    packing = run(mpv_instance(1, 50, 1).problem, work=0.001, proof=400.0)
    assert (packing.status == "optimal") == (packing.stop_reason == "bound met")


def test_many_small_boxes_in_few_builds_need_no_memory_for_every_build_met():
    held = no_builds(200_000, 100_000)
    assert held.item.size == 8_000_000


def test_stopped_at_once_it_says_so_and_nothing_to_pack_is_packed():
    from amprep.testing.packing_instances import mpv_instance

    packing = run(mpv_instance(5, 50, 1).problem, Stop.after(0.0))
    assert packing.stop_reason == "time limit"
    assert run(problem([(6, 6, 6)] * 5), Stop.after(0.0)).stop_reason == "bound met"
    assert run(problem([])).builds == ()


def test_parameters_out_of_bounds_are_refused():
    for params in ({"ruin_size": 0}, {"temperature": -1.0}, {"patience": -1}, {"work": float("nan")}):
        with pytest.raises(ValueError, match=next(iter(params))):
            AutoParams(**params)


def test_the_first_passes_pack_a_thousand_sizes_on_plates_into_as_few_builds_as_the_bound():
    sizes = np.random.default_rng(8).integers(3, 15, (900, 3)).tolist()
    stop = Late(10)
    packing = run(problem(sizes, room=(100, 100, 20), stacking=False, clearance=1.0), stop)
    assert (packing.stop_reason, stop.asked <= 10) == ("bound met", True)


@pytest.mark.parametrize("seed", range(4))
def test_a_round_build_is_filled_as_well_as_by_the_orderings_that_the_search_begins_with(seed):
    rng = np.random.default_rng(seed)
    room = BuildVolume((20.0, 20.0, 12.0), "cylinder")
    task = problem(rng.integers(3, 9, (40, 3)).tolist(), room, objective="fill")

    def value(packing):
        return sum(task.items[placed.item].value for placed in packing.builds[0])

    ordered = pack_extreme_points(
        task, params=ExtremePointsParams(), rng=np.random.default_rng(0), stop=Stop(), progress=silent
    )
    assert value(run(task, work=20.0, patience=2)) >= value(ordered)


def test_items_are_out_of_time_only_when_the_search_was_stopped(monkeypatch):
    # the early limit of the orderings ends the first of them; the blocks then end by themselves
    task = problem(np.random.default_rng(4).integers(2, 5, (60, 3)).tolist(), objective="fill")
    monkeypatch.setattr(extreme_points, "PAUSE", 1)
    monkeypatch.setattr(fill, "ORDERINGS_FRACTION", 0.0)
    nothing = PackerResult(Arrangement.unassigned(60), 1000.0, "work used up")
    monkeypatch.setattr(fill, "fill_by_blocks", lambda *_: nothing)
    packing = run(task, Stop.after(60.0))
    assert packing.stop_reason == "work used up"
    assert {unplaced.reason for unplaced in packing.unplaced} == {"no room left"}


@pytest.mark.parametrize("packer", [pack_auto, pack_extreme_points])
@pytest.mark.parametrize("value", [np.inf, np.nan, -1.0, 1e16])
def test_a_value_that_is_no_amount_is_refused(packer, value):
    task = problem([(5, 5, 5)] * 2, values=[1.0, value], objective="fill")
    params = AutoParams() if packer is pack_auto else ExtremePointsParams()
    with pytest.raises(JobError, match="part 2: the value must be between 0 and 1e"):
        packer(task, params=params, rng=np.random.default_rng(0), stop=Stop(), progress=silent)


def forks(count, seed):
    """Items like a U, of three boxes each, with little room between the arms."""
    rng = np.random.default_rng(seed)
    items = []
    for number in range(count):
        x, y, arm = rng.integers(12, 20), rng.integers(12, 20), rng.integers(4, 6)
        lo = np.array([[0, 0, 0], [0, 0, 0], [x - arm, 0, 0]], float)
        hi = np.array([[x, arm, 5], [arm, y, 5], [x, y, 5]], float)
        items.append(Item(number, 0, Boxes(lo, hi), float(x * arm + 2 * y * arm), Orientations()))
    return PackingProblem(tuple(items), BuildVolume(np.array([50.0, 50, 10])), "fill")


@pytest.mark.parametrize("seed", [1, 2])
def test_items_of_several_boxes_are_filled_in_as_well_as_their_enclosing_boxes(seed):
    task = forks(24, seed)
    enclosed = replace(
        task,
        items=tuple(replace(i, volume=Boxes(*(c[None] for c in i.volume.enclosing()))) for i in task.items),
    )
    values = [
        sum(t.items[placed.item].value for placed in run(t, work=5.0).builds[0]) for t in (task, enclosed)
    ]
    assert values[0] >= 0.99 * values[1]  # the enclosing boxes alone get twice the work


def test_the_arrangement_of_enclosing_boxes_keeps_positions_and_rotations():
    lo, hi = np.zeros((2, 3)), np.array([[9.0, 2, 3], [2, 5, 3]])
    turns = Orientations("list", axis_rotations())
    item = Item(0, 0, Boxes(lo, hi), 1.0, turns)
    instance = prepare(PackingProblem((item,), BuildVolume(np.full(3, 20.0)), "fill"))
    enclosed = present(enclosing_instance(instance))
    for number, orientation in enumerate(enclosed.orientations):
        packed = Arrangement(np.zeros(1, np.int64), np.array([number]), np.ones((1, 3)))
        found = with_own_boxes(instance, enclosed, packed)
        own = instance.orientations[found.orientation[0]]
        assert own.rotation.tolist() == orientation.rotation.tolist()
        assert own.size.tolist() == orientation.size.tolist()
    assert len(enclosed.orientations) < len(instance.orientations)


def test_items_of_several_boxes_are_not_enclosed_around_fixed_ones():
    task = replace(forks(2, 1), fixed=(Placement(0, np.eye(3), np.zeros(3)),))
    assert enclosing_instance(prepare(task)) is None
