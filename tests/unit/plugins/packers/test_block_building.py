"""The packer `block-building` fills the build, keeps to its work limit, and obeys the rules of the problem."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.boxes import boxes_problem, cut
from tests.shared.examples import examples
from tests.shared.grids import Late

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import BuildVolume, Orientations, PackingProblem, Placement, Stop, silent
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.block_building import fill_by_blocks, pack_block_building
from amprep.plugins.packers.block_building.blocks import build_blocks
from amprep.plugins.packers.block_building.integer_instance import integer_instance
from amprep.plugins.packers.instance.arrangement import value_of
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.params import BlockBuildingParams

TURNS = Orientations("list", axis_rotations())


def problem(sizes, room=(10, 10, 10), *, turns=False, **rules):
    """Return a problem of boxes that fill one container."""
    return boxes_problem(sizes, room, orientations=TURNS if turns else None, objective="fill", **rules)


def run(task, stop=None, **params):
    packing = pack_block_building(
        task,
        params=BlockBuildingParams(**params),
        rng=np.random.default_rng(0),
        stop=stop or Stop(),
        progress=silent,
    )
    assert check_packing(task, packing) == []
    return packing


def value(task, packing):
    return sum(task.items[p.item].value for build in packing.builds for p in build)


@pytest.mark.parametrize("count", [5, 12, 20])
def test_a_container_cut_into_boxes_is_filled_again_completely(count):
    packing = run(problem(cut(np.random.default_rng(count), (12, 10, 8), count), (12, 10, 8)))
    assert (packing.status, packing.stop_reason, packing.unplaced) == ("optimal", "bound met", ())


def test_a_thousand_equal_boxes_fill_the_container_within_little_work():
    task = problem([(1, 2, 3)] * 1000, (20, 20, 15), turns=True)
    assert run(task, work=20.0).status == "optimal"


def test_a_box_that_is_too_large_by_the_contact_tolerance_fits_and_by_more_does_not():
    assert len(run(problem([(10.001, 10, 10)])).builds[0]) == 1
    packing = run(problem([(10.002, 10, 10)]))
    assert packing.builds == ()
    assert [u.reason for u in packing.unplaced] == ["too large"]


def test_the_packing_of_greatest_value_wins_not_that_of_greatest_volume():
    task = problem([(10, 10, 10), (5, 10, 10), (4, 10, 10)], values=[5, 3, 3])
    packing = run(task)
    assert sorted(p.item for p in packing.builds[0]) == [1, 2]
    assert value(task, packing) == 6.0


def test_boxes_are_rotated_only_if_their_orientations_allow_it():
    sizes = [(10, 10, 5), (10, 5, 10)]
    assert len(run(problem(sizes)).builds[0]) == 1
    assert len(run(problem(sizes, turns=True)).builds[0]) == 2


def test_without_stacking_no_box_is_above_another():
    task = problem([(5, 5, 2)] * 8, turns=True, stacking=False)
    packing = run(task, work=20.0)
    assert len(packing.builds[0]) == 8  # on their sides


def test_boxes_keep_the_clearance_to_fixed_boxes_and_forbidden_zones():
    space = BuildVolume(np.full(3, 12.0), "box", np.array([[8.0, 0, 0]]), np.array([[12.0, 12, 3]]))
    items = problem(np.random.default_rng(3).integers(2, 6, (30, 3)).tolist(), turns=True).items
    fixed = (Placement(0, np.eye(3), np.array([3.0, 3.0, 0.0])),)
    packing = run(PackingProblem(items, space, "fill", fixed, clearance=0.5), work=10.0)
    assert packing.builds[0][0].item == 0


def test_fixed_items_count_in_the_value_of_a_packing():
    task = problem([(4, 4, 4)] * 5, fixed=(Placement(0, np.eye(3), np.zeros(3)),))
    instance = prepare(task)
    found = fill_by_blocks(instance, BlockBuildingParams(work=10.0), Stop(), silent)
    assert value_of(instance, found.arrangement) == 5 * 64.0


def test_a_single_box_is_pushed_into_the_lower_corner():
    corner = run(problem([(2, 3, 4)])).builds[0][0]
    assert corner.translation.tolist() == [0.0, 0.0, 0.0]


def test_the_same_work_limit_gives_the_same_packing_however_the_threads_run():
    task = problem(np.random.default_rng(7).integers(2, 6, (60, 3)).tolist(), turns=True)
    one, other = run(task, work=15.0), run(task, work=15.0)
    assert [p.matrix.tolist() for p in one.builds[0]] == [p.matrix.tolist() for p in other.builds[0]]
    assert one.stop_reason == "work used up"


def test_blocks_with_much_work_are_at_least_as_good_as_single_boxes_and_fill_93_percent():
    rng = np.random.default_rng(11)
    task = problem(np.repeat(rng.integers(3, 9, (12, 3)), 6, axis=0).tolist(), (25, 20, 18), turns=True)
    found = [
        value(task, run(task, blocks=blocks, work=work))
        for blocks, work in ((0, 1), (10_000, 1), (10_000, 60))
    ]
    assert found[0] <= found[2]
    assert found[1] <= found[2]
    assert found[2] / task.space.volume_mm3 > 0.93


def test_it_stops_at_a_request_made_during_a_search_over_thousands_of_boxes():
    task = problem(np.random.default_rng(8).uniform(0.5, 1.5, (1500, 3)).tolist())
    packing = run(task, Late(3))
    assert packing.stop_reason == "time limit"
    assert len(packing.builds[0]) > 100


def test_a_search_over_few_boxes_ends_without_a_limit():
    packing = run(problem([(6, 6, 6), (5, 5, 5), (7, 2, 2)]))
    assert packing.stop_reason == "no better one found"
    assert packing.status == "feasible"


def test_it_stops_at_once_and_accepts_problems_without_a_box_that_fits():
    task = problem(np.random.default_rng(7).integers(2, 6, (60, 3)).tolist())
    assert run(task, Stop.after(0.0)).stop_reason == "time limit"
    assert run(problem([])).builds == ()
    assert run(problem([(11, 1, 1)])).builds == ()


@examples(40)
@given(
    st.lists(st.tuples(*[st.integers(1, 6)] * 3), min_size=1, max_size=8), st.sampled_from([0.9, 0.98, 1.0])
)
def test_every_block_holds_disjoint_boxes_inside_it_within_the_demand(sizes, fill):
    instance = integer_instance(prepare(problem(sizes, turns=True)))
    known, demand = instance.boxes, instance.boxes.demand
    found = build_blocks(instance, 200, min_fill=fill, grids=0.3, exponents=(0.2, 0.0), flat=False)
    assert len(found.origin) <= max(200, len(known.size))
    for block in range(len(found.origin)):
        boxes = found.boxes(block, np.zeros(3, np.int64))
        lo = np.array([corner for _, corner in boxes])
        size = known.size[[box for box, _ in boxes]]
        assert (lo >= 0).all()
        assert (lo + size <= found.blocks.size[block]).all()
        overlap = np.minimum((lo + size)[:, None], (lo + size)[None]) - np.maximum(lo[:, None], lo[None])
        assert ((overlap > 0).all(axis=2).sum(axis=1) == 1).all()  # each box overlaps only itself
        taken = np.bincount(known.item_type[[box for box, _ in boxes]], minlength=len(demand))
        assert (taken <= demand).all()
        assert size.prod(axis=1).sum() >= fill * found.blocks.size[block].prod() - 1e-9


def test_parameters_out_of_bounds_are_refused():
    for params in ({"blocks": -1}, {"work": float("nan")}):
        with pytest.raises(ValueError, match=next(iter(params))):
            BlockBuildingParams(**params)
