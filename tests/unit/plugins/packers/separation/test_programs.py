"""The linear programs, in closed form."""

import numpy as np
import pytest

from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.no_fit import prepare_no_fit
from amprep.plugins.packers.separation.programs import compacted, height_of, is_exact, make_exact
from amprep.plugins.packers.separation.shapes import prepare_shapes
from amprep.plugins.packers.separation.state import Placed, Scene, WorkBudget


def scene_of(sizes, room, shape="box", clearance=0.0):
    items = tuple(Item(k, 0, Boxes(np.zeros(3), np.array(size, float)), 1.0) for k, size in enumerate(sizes))
    problem = PackingProblem(items, BuildVolume(np.array(room, float), shape), "height", clearance=clearance)
    params = SeparationParams()
    instance = prepare_shapes(problem, Stop())
    no_fit = prepare_no_fit(instance, params, Stop())
    return Scene(instance, no_fit, params, np.random.default_rng(0), WorkBudget(Stop(), 1e9))


def exactly(scene, start, within):
    return make_exact(scene, start, within)


def placed(*positions):
    n = len(positions)
    return Placed(np.arange(n), np.arange(n), np.zeros(n, np.int64), np.array(positions, float))


def test_boxes_that_overlap_a_little_are_moved_apart_by_a_limited_length():
    scene = scene_of([(2, 2, 2), (2, 2, 2)], (9, 9, 9))
    found = exactly(scene, placed((1, 1, 1), (2.9, 1, 1)), scene.instance.positions(9.0))
    assert found.position[1, 0] - found.position[0, 0] >= 2.0
    assert np.abs(found.position - [(1, 1, 1), (2.9, 1, 1)]).max() <= 0.06 * 2.0 + 1e-9


def test_boxes_that_have_no_room_beside_each_other_stay():
    scene = scene_of([(2, 2, 2), (2, 2, 2)], (3, 2, 2))
    assert make_exact(scene, placed((0, 0, 0), (1, 0, 0)), scene.instance.positions(2.0)) is None


def test_a_tower_is_compacted_to_the_sum_of_its_heights():
    scene = scene_of([(2, 2, 1), (2, 2, 2), (2, 2, 3)], (2, 2, 20))
    low = compacted(scene, placed((0, 0, 1), (0, 0, 3), (0, 0, 6)), scene.instance.positions(20.0))
    assert height_of(scene, low) == pytest.approx(6.0, abs=1e-5)
    assert is_exact(scene, low)


def test_the_clearance_is_kept_between_boxes():
    scene = scene_of([(2, 2, 1), (2, 2, 1)], (4, 4, 20), clearance=1.0)
    low = compacted(scene, placed((1, 1, 0), (1, 1, 4)), scene.instance.positions(19.0))
    assert height_of(scene, low) == pytest.approx(3.0, abs=1e-5)


def test_a_box_that_is_partly_outside_the_circle_is_moved_into_it():
    scene = scene_of([(6, 8, 1)], (10, 10, 5), "cylinder")
    found = exactly(scene, placed((2.2, 1.1, 0)), scene.instance.positions(5.0))
    assert found.position[0] == pytest.approx([2.0, 1.0, 0.0], abs=2e-3)
