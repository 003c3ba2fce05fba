"""The prepared instance: item types, orientations, obstacles, and the restriction to some items."""

import numpy as np
import pytest

from amprep.errors import AmprepError
from amprep.kernels.boxes.records import Arrangement
from amprep.model import Boxes, BuildVolume, Item, Orientations, PackingProblem, Placement
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import prepare, restrict

ZONE = BuildVolume(np.full(3, 10.0), "box", np.array([[8.0, 8, 0]]), np.array([[10.0, 10, 10]]))


def item(number, size, value=1.0, orientations=None):
    volume = Boxes(np.zeros((1, 3)), np.array([size], float))
    return Item(number, 0, volume, value, orientations or Orientations())


def test_items_with_equal_volume_and_rotations_are_one_type():
    turns = Orientations("list", axis_rotations())
    items = (
        item(0, (1, 2, 3)),
        item(1, (1, 2, 3)),
        item(2, (1, 2, 3), 1.0, turns),
        item(3, (2, 2, 2), 1.0, turns),
    )
    instance = prepare(PackingProblem(items, ZONE))
    assert instance.type_of.tolist() == [0, 0, 1, 2]
    # a box of three different sides has six orientations, a cube one
    assert np.diff(instance.first_orientation).tolist() == [1, 6, 1]
    assert instance.demand.tolist() == [2, 1, 1]


def test_fixed_and_too_large_items_are_not_free_and_obstacles_include_clearance():
    items = (item(0, (2, 2, 2)), item(1, (3, 3, 3)), item(2, (11, 1, 1)))
    fixed = (Placement(0, np.eye(3), np.array([1.0, 1, 0])),)
    instance = prepare(PackingProblem(items, ZONE, fixed=fixed, clearance=0.5))
    assert instance.free.tolist() == [False, True, False]
    assert instance.too_large.tolist() == [False, False, True]
    assert instance.boxes.zones == 1
    assert instance.boxes.obstacles.tolist() == [[8.5, 8.5, 0.5, 10, 10, 10], [1, 1, 0, 3.5, 3.5, 2.5]]


def test_a_restricted_instance_equals_the_instance_prepared_from_its_items():
    turns = Orientations("list", axis_rotations())
    sizes = [(5, 5, 5), (1, 2, 3), (9, 9, 9), (1, 2, 3), (5, 5, 5)]
    problem = PackingProblem(tuple(item(i, s, 1.0, turns) for i, s in enumerate(sizes)), ZONE, "builds")
    kept, values = np.array([1, 3, 4]), np.array([2.0, 3.0, 4.0])
    part = restrict(prepare(problem), kept, "fill", values)
    again = prepare(part.problem)
    assert [one.value for one in part.problem.items] == [3.0, 3.0, 2.0]
    assert part.type_of.tolist() == again.type_of.tolist() == [0, 0, 1]
    for one, other in zip(part.boxes, again.boxes, strict=True):
        assert np.array_equal(one, other, equal_nan=True)


def test_an_arrangement_becomes_placements_and_reasons():
    turns = Orientations("list", axis_rotations())
    items = (item(0, (1, 2, 3), 1.0, turns), item(1, (4, 4, 4)), item(2, (11, 1, 1)))
    instance = prepare(PackingProblem(items, ZONE, "fill"))
    found = Arrangement.unassigned(3)
    found.build[0], found.orientation[0], found.position[0] = 0, 2, (1.0, 2.0, 3.0)
    packing = as_packing(instance, PackerResult(found, 2.0, "finished"))
    (placement,) = packing.builds[0]
    corners = np.array([[0.0, 0, 0], [1, 2, 3]]) @ placement.rotation.T + placement.translation
    assert corners.min(axis=0).tolist() == [1.0, 2.0, 3.0]
    assert [(u.item, u.reason) for u in packing.unplaced] == [(1, "no room left"), (2, "too large")]
    assert packing.status == "feasible"


def test_a_negative_value_is_refused_with_the_rule_and_the_value():
    with pytest.raises(AmprepError, match=r"part 1: the value must be between 0 and 1e\+15, got -1"):
        prepare(PackingProblem((item(0, (1, 1, 1), -1.0),), ZONE))
