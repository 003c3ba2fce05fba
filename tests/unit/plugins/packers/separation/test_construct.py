"""Constructed layouts overlap nothing, fill builds as asked, and several orders are tried."""

import numpy as np
import pytest

from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.construct import best_constructed, by_size, construct, random_order
from amprep.plugins.packers.separation.no_fit import prepare_no_fit
from amprep.plugins.packers.separation.shapes import prepare_shapes
from amprep.plugins.packers.separation.state import Scene, WorkBudget

SIZES = [(4, 2, 2), (2, 3, 1), (1, 1, 1)]


def scene_of(counts, room, objective="builds"):
    """Boxes of some sizes, as many of each as told."""
    volumes = [Boxes(np.zeros(3), np.array(size, float)) for size in SIZES]
    items = tuple(Item(k, copy, volumes[k], 1.0) for k, count in enumerate(counts) for copy in range(count))
    problem = PackingProblem(items, BuildVolume(np.array(room, float)), objective)
    instance, params = prepare_shapes(problem, Stop()), SeparationParams(step=0.1)
    no_fit = prepare_no_fit(instance, params, Stop())
    assert no_fit is not None
    return Scene(instance, no_fit, params, np.random.default_rng(1), WorkBudget(Stop(), 1e12))


def overlapping(scene, placed):
    size = scene.instance.size[placed.shape]
    lo, hi = placed.position, placed.position + size
    depth = (np.minimum(hi[:, None], hi[None]) - np.maximum(lo[:, None], lo[None])).min(axis=2)
    together = placed.build[:, None] == placed.build[None]
    return int(((depth > 1e-3) & together & ~np.eye(len(size), dtype=bool)).sum())


@pytest.mark.parametrize("even", [False, True])
def test_items_overlap_nothing_and_are_inside(even):
    scene = scene_of((6, 8, 20), (6.3, 5.1, 4.2))
    items = np.arange(34)
    placed = construct(scene, random_order(scene, items), scene.full_height, 3, even=even)
    assert overlapping(scene, placed) == 0
    assert (placed.position >= 0.0).all()
    assert (placed.position + scene.instance.size[placed.shape] <= [6.3, 5.1, 4.2]).all()
    assert len(set(placed.items.tolist())) == len(placed.items) > 20


def test_a_build_is_filled_before_the_next_one_is_begun_or_all_are_filled_evenly():
    scene, items = scene_of((0, 0, 40), (3, 3, 3)), np.arange(40)
    one_by_one = construct(scene, by_size(scene, items), scene.full_height, 40)
    filled = np.bincount(one_by_one.build)
    assert len(filled) > 1
    assert set(filled[:-1]) == {filled[0]}
    assert filled[-1] <= filled[0]
    even = construct(scene, by_size(scene, items), scene.full_height, 4, even=True)
    assert np.bincount(even.build).tolist() == [10, 10, 10, 10]


def test_the_best_of_several_orders_is_returned():
    scene, items = scene_of((5, 9, 11), (5, 5, 20)), np.arange(25)
    tried = []

    def value(placed):
        tried.append(round(float((placed.position[:, 2] * (1 + placed.items)).sum()), 9))
        return tried[-1]

    best = best_constructed(scene, items, scene.full_height, 9, value, 0)
    assert len(set(tried)) > 1
    assert value(best) == min(tried)


def test_an_interrupted_pass_returns_what_is_placed():
    scene, items = scene_of((0, 0, 40), (4, 4, 4)), np.arange(40)
    scene.budget.left = 2000.0
    placed = construct(scene, items, scene.full_height, 40)
    assert 0 < len(placed.items) < 40
    assert overlapping(scene, placed) == 0
