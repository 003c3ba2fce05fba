"""The shelf packer keeps its promises, and finds the packings that are known for a few small problems."""

import numpy as np
import pytest

from amprep.model import Boxes, BuildVolume, Item, PackingProblem
from amprep.testing import load_offer, try_plugin

HUNDRED = BuildVolume(np.full(3, 100.0))


def packed(sizes, values=None, order="height", **rules):
    items = tuple(
        Item(part, 0, Boxes([[0, 0, 0]], [size]), value)
        for part, (size, value) in enumerate(zip(sizes, values or [1.0] * len(sizes), strict=True))
    )
    shelves = load_offer("packer", "shelves", plugin="amprep_shelves", params={"order": order})
    return shelves.run(PackingProblem(items, rules.pop("space", HUNDRED), **rules))


def corners(build):
    return {placement.item: placement.translation.tolist() for placement in build}


def test_every_promise_holds_on_the_sample_problems():
    (report,) = try_plugin("amprep_shelves")
    assert (report.name, report.violations) == ("shelves", ())


def test_four_quarters_fill_one_layer():
    packing = packed([(50, 50, 50)] * 4, stacking=False)
    assert corners(packing.builds[0]) == {0: [0, 0, 0], 1: [50, 0, 0], 2: [0, 50, 0], 3: [50, 50, 0]}


def test_eight_eighths_fill_one_build_and_the_ninth_opens_another():
    packing = packed([(50, 50, 50)] * 9)
    assert [len(build) for build in packing.builds] == [8, 1]


def test_without_stacking_no_part_is_above_another():
    packing = packed([(50, 50, 10)] * 5, stacking=False, lift=3.0)
    assert [len(build) for build in packing.builds] == [4, 1]
    assert {corner[2] for build in packing.builds for corner in corners(build).values()} == {3.0}


def test_the_clearance_counts_between_parts_and_to_the_walls():
    # 2 + 47 + 2 + 47 + 2 = 100
    packing = packed([(47, 96, 20)] * 2, clearance=2.0, stacking=False)
    assert corners(packing.builds[0]) == {0: [2, 2, 0], 1: [51, 2, 0]}
    assert len(packed([(47.1, 96, 20)] * 2, clearance=2.0, stacking=False).builds) == 2


def test_the_most_valuable_for_its_box_comes_first_in_a_fill_problem():
    packing = packed([(100, 100, 60), (100, 100, 50), (100, 100, 50)], [10, 9, 8], objective="fill")
    # 9 / 50 is more than 10 / 60 and 8 / 50; 50 mm then remain, which is too little for 60 mm
    assert sorted(corners(packing.builds[0])) == [1, 2]
    assert [(entry.item, entry.reason) for entry in packing.unplaced] == [(0, "no room left")]


def test_a_part_that_fits_no_build_is_too_large():
    packing = packed([(101, 1, 1), (1, 1, 1)])
    assert [(entry.item, entry.reason) for entry in packing.unplaced] == [(0, "too large")]


@pytest.mark.parametrize(("order", "first"), [("height", 0), ("depth", 1), ("volume", 2)])
def test_the_order_decides_which_part_is_placed_first(order, first):
    packing = packed([(1, 1, 30), (1, 30, 1), (25, 25, 25)], order=order)
    assert packing.builds[0][0].item == first
