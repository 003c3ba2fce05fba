"""Layouts of inexact fields become exact, whatever has to be moved."""

import numpy as np
import pytest

from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.no_fit import prepare_no_fit
from amprep.plugins.packers.separation.programs import is_exact
from amprep.plugins.packers.separation.repair import repaired
from amprep.plugins.packers.separation.shapes import prepare_shapes
from amprep.plugins.packers.separation.state import Placed, Scene, WorkBudget


def scene_of(count, room, zones=()):
    corners = np.array(zones, float).reshape(-1, 6)
    items = tuple(Item(k, 0, Boxes(np.zeros(3), np.full(3, 4.0)), 1.0) for k in range(count))
    space = BuildVolume(np.array(room, float), "box", corners[:, :3], corners[:, 3:])
    problem = PackingProblem(items, space, "height")
    instance = prepare_shapes(problem, Stop())
    no_fit = prepare_no_fit(instance, SeparationParams(), Stop())
    return Scene(instance, no_fit, SeparationParams(), np.random.default_rng(0), WorkBudget(Stop(), 1e9))


def placed(*positions):
    n = len(positions)
    return Placed(np.arange(n), np.zeros(n, np.int64), np.zeros(n, np.int64), np.array(positions, float))


def mend(scene, start, height, most_builds=1):
    found = repaired(scene, start, scene.instance.positions(height), most_builds)
    assert is_exact(scene, found)
    return found


def test_small_overlaps_are_removed_on_the_spot():
    scene = scene_of(2, (9, 9, 20))
    found = mend(scene, placed((0, 0, 0), (3.9, 0.5, 0)), 20.0)
    assert found.position[:, 2] == pytest.approx([0.0, 0.0])


def test_an_item_that_overlaps_several_others_is_put_on_top():
    scene = scene_of(3, (8, 4, 20))
    found = mend(scene, placed((0, 0, 0), (4, 0, 0), (2, 0, 0)), 20.0)
    assert found.items.tolist() == [0, 1, 2]
    assert found.position[2, 2] == pytest.approx(4.0)


def test_without_height_it_gets_a_build_of_its_own_or_is_left_out():
    scene = scene_of(3, (8, 4, 4))
    start = placed((0, 0, 0), (4, 0, 0), (2, 0, 0))
    assert mend(scene, start, 4.0, most_builds=2).build.tolist() == [0, 0, 1]
    assert mend(scene, start, 4.0).items.tolist() == [0, 1]


def test_above_the_first_item_of_a_further_build_zones_are_kept_free():
    scene = scene_of(4, (8, 4, 10), zones=[(4, 0, 0, 8, 4, 5)])
    start = placed((0, 0, 0), (4, 0, 5), (3.9, 0, 5.2), (4, 0, 5.5))
    found = mend(scene, start, 10.0, most_builds=2)
    assert sorted(found.items.tolist()) == [0, 1, 2, 3]
