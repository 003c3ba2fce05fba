"""Boxes in one build, as low as possible: known optima, ceilings, and what has no room."""

from typing import Any

import numpy as np
import pytest

from amprep.checks.packing.volumes_placed import check_packing
from amprep.measures.objective import objective_reached
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Placement, Stop, silent
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.auto import pack_auto
from amprep.plugins.packers.block_building import pack_block_building
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.params import AutoParams, BlockBuildingParams, ExtremePointsParams

PACKERS: dict[str, tuple[Any, Any]] = {
    "extreme-points": (pack_extreme_points, ExtremePointsParams()),
    "block-building": (pack_block_building, BlockBuildingParams(work=40.0)),
    "auto": (pack_auto, AutoParams(work=40.0)),
}
ONE = Orientations()
TURNS = Orientations(matrices=axis_rotations())


def problem(sizes, room, *, turns=ONE, **rules):
    """A height problem of single boxes."""
    items = tuple(
        Item(number, 0, Boxes(np.zeros((1, 3)), np.array([size], float)), 1.0, turns)
        for number, size in enumerate(sizes)
    )
    return PackingProblem(items, BuildVolume(np.array(room, float)), "height", **rules)


def packed(packer, given):
    """The packing, judged, and its height."""
    pack, params = PACKERS[packer]
    packing = pack(given, params=params, rng=np.random.default_rng(1), stop=Stop(), progress=silent)
    assert check_packing(given, packing) == []
    return packing, objective_reached(given, packing)


@pytest.mark.parametrize("packer", sorted(PACKERS))
def test_cubes_that_fill_their_base_reach_the_bound_by_volume(packer):
    packing, height = packed(packer, problem([(10, 10, 10)] * 27, (30, 30, 200)))
    assert height == pytest.approx(30.0)
    assert packing.bound == pytest.approx(30.0, abs=0.02)  # contacts may be penetrated a little


@pytest.mark.parametrize("packer", sorted(PACKERS))
def test_without_stacking_each_part_lies_down_where_there_is_room(packer):
    given = problem([(10, 10, 80), (60, 20, 30)], (200, 200, 100), turns=TURNS, stacking=False, lift=3.0)
    packing, height = packed(packer, given)
    assert height == pytest.approx(23.0)
    assert packing.status == "optimal"


@pytest.mark.parametrize("packer", sorted(PACKERS))
def test_without_stacking_a_part_stands_where_there_is_no_room_for_all_to_lie(packer):
    given = problem([(40, 10, 10)] * 5, (40, 44, 100), turns=TURNS, stacking=False)
    _, height = packed(packer, given)
    # four lie side by side and leave 4 mm: one more needs the room of one that stands
    assert height == pytest.approx(40.0)


@pytest.mark.parametrize("packer", sorted(PACKERS))
def test_parts_around_a_fixed_one_are_no_higher_than_needed(packer):
    given = problem([(20, 20, 50), (20, 20, 10), (20, 20, 10)], (40, 20, 100))
    fixed = (Placement(0, np.eye(3), np.zeros(3)),)
    given = PackingProblem(given.items, given.space, "height", fixed)
    packing, height = packed(packer, given)
    assert height == pytest.approx(50.0)
    assert packing.status == "optimal"


@pytest.mark.parametrize("packer", sorted(PACKERS))
def test_what_has_no_room_in_one_build_is_left_with_a_reason(packer):
    packing, height = packed(packer, problem([(20, 20, 20)] * 3, (20, 20, 50)))
    assert height == pytest.approx(40.0)
    assert [each.reason for each in packing.unplaced] == ["no room left"]
    assert len(packing.builds) == 1


@pytest.mark.parametrize("packer", sorted(PACKERS))
def test_real_sizes_are_packed_far_lower_than_one_above_another(packer):
    sizes = np.random.default_rng(7).uniform(5, 40, (40, 3))
    packing, height = packed(packer, problem(sizes, (100, 100, 400), turns=TURNS, clearance=1.0))
    assert packing.unplaced == ()
    volume = sizes.prod(axis=1).sum() / 98**2
    assert height < 1.5 * volume
    assert packing.bound <= height


def test_blocks_and_auto_are_at_least_as_low_as_orderings_alone():
    sizes = np.random.default_rng(3).uniform(5, 40, (60, 3))
    heights = [packed(name, problem(sizes, (100, 100, 400)))[1] for name in PACKERS]
    assert min(heights[1:]) < heights[0]
    assert max(heights[1:]) <= heights[0]


def test_a_round_plate_and_items_of_several_boxes_are_packed_low_too():
    ell = Boxes(np.zeros((2, 3)), np.array([[30.0, 10, 20], [10, 30, 20]]))
    items = tuple(Item(0, copy, ell, 1.0, TURNS) for copy in range(6))
    given = PackingProblem(items, BuildVolume(np.array([90.0, 90.0, 300.0]), "cylinder"), "height")
    for packer in ("extreme-points", "auto"):
        packing, height = packed(packer, given)
        assert packing.unplaced == ()
        assert height <= 60.0
