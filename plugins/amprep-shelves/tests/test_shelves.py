"""The shelf packer: the promises on sample problems, and a few problems with answers known by hand."""

import numpy as np
import pytest

from amprep.host import Host
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop, silent
from amprep.testing.conformance import try_plugin

HUNDRED = BuildVolume(np.full(3, 100.0))


@pytest.fixture(scope="module")
def host():
    return Host.load(modules=["amprep_shelves"], env={"AMPREP_LOAD_PLUGINS": ""})


def packed(host, sizes, values=None, order="height", **rules):
    items = tuple(
        Item(part, 0, Boxes([[0, 0, 0]], [size]), value)
        for part, (size, value) in enumerate(zip(sizes, values or [1.0] * len(sizes), strict=True))
    )
    listed = host.choose("packer", "shelves")
    problem = PackingProblem(items, rules.pop("space", HUNDRED), **rules)
    host.refuse_mismatch(listed, problem)
    params = host.params(listed, {"order": order})
    return host.call(
        listed, problem, params=params, rng=np.random.default_rng(0), stop=Stop(), progress=silent
    )


def corners(build):
    return {placement.item: placement.translation.tolist() for placement in build}


def test_every_promise_holds_on_the_sample_problems():
    (trial,) = try_plugin("amprep_shelves")
    assert trial.name == "shelves"
    assert trial.violations == ()


def test_four_quarters_fill_one_layer(host):
    packing = packed(host, [(50, 50, 50)] * 4, stacking=False)
    assert corners(packing.builds[0]) == {0: [0, 0, 0], 1: [50, 0, 0], 2: [0, 50, 0], 3: [50, 50, 0]}


def test_eight_eighths_fill_one_build_and_the_ninth_opens_another(host):
    packing = packed(host, [(50, 50, 50)] * 9)
    assert [len(build) for build in packing.builds] == [8, 1]


def test_without_stacking_nothing_lies_above_another(host):
    packing = packed(host, [(50, 50, 10)] * 5, stacking=False, lift=3.0)
    assert [len(build) for build in packing.builds] == [4, 1]
    assert {corner[2] for build in packing.builds for corner in corners(build).values()} == {3.0}


def test_the_clearance_counts_between_parts_and_to_the_walls(host):
    # 2 + 47 + 2 + 47 + 2 = 100
    packing = packed(host, [(47, 96, 20)] * 2, clearance=2.0, stacking=False)
    assert corners(packing.builds[0]) == {0: [2, 2, 0], 1: [51, 2, 0]}
    assert len(packed(host, [(47.1, 96, 20)] * 2, clearance=2.0, stacking=False).builds) == 2


def test_the_most_valuable_for_its_box_comes_first_in_a_fill_problem(host):
    packing = packed(host, [(100, 100, 60), (100, 100, 50), (100, 100, 50)], [10, 9, 8], objective="fill")
    # 9 / 50 is more than 10 / 60 and 8 / 50; after it there is room for 50 mm, not for 60
    assert sorted(corners(packing.builds[0])) == [1, 2]
    assert [(entry.item, entry.reason) for entry in packing.unplaced] == [(0, "no room left")]


def test_what_fits_no_build_is_too_large(host):
    packing = packed(host, [(101, 1, 1), (1, 1, 1)])
    assert [(entry.item, entry.reason) for entry in packing.unplaced] == [(0, "too large")]


@pytest.mark.parametrize(("order", "first"), [("height", 0), ("depth", 1), ("volume", 2)])
def test_the_order_says_who_comes_first(host, order, first):
    packing = packed(host, [(1, 1, 30), (1, 30, 1), (25, 25, 25)], order=order)
    assert packing.builds[0][0].item == first
