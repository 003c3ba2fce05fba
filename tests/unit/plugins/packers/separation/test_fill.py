"""The most valuable items that fit one build."""

import numpy as np
import pytest

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop, silent
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation import pack_separation
from amprep.plugins.packers.separation.fill import exchanged
from amprep.plugins.packers.separation.no_fit import prepare_no_fit
from amprep.plugins.packers.separation.shapes import prepare_shapes
from amprep.plugins.packers.separation.state import Placed, Scene, WorkBudget


def pack(sizes, values, room, shape="box", work=50.0):
    volumes = [Boxes(np.zeros(3), np.array(size, float)) for size in sizes]
    items = tuple(Item(k, 0, v, value) for k, (v, value) in enumerate(zip(volumes, values, strict=True)))
    problem = PackingProblem(items, BuildVolume(np.array(room, float), shape), "fill")
    packing = pack_separation(
        problem,
        params=SeparationParams(work=work),
        rng=np.random.default_rng(3),
        stop=Stop(),
        progress=silent,
    )
    assert check_packing(problem, packing) == []
    return sum(items[placement.item].value for build in packing.builds for placement in build), packing


def test_an_item_that_the_constructive_pass_leaves_out_is_squeezed_in():
    sizes = [(3, 2, 2), (2, 3, 2), (3, 2, 2), (2, 3, 2)]  # a pinwheel around an empty square
    value, packing = pack(sizes, [4.0, 3.0, 2.0, 1.0], (5, 5, 2))
    assert value == 10.0
    assert packing.status == "optimal"


def test_the_bound_is_a_fractional_knapsack():
    value, packing = pack([(2, 2, 2)] * 3, [5.0, 4.0, 3.0], (2, 2, 4))
    assert value == 9.0
    assert packing.bound == pytest.approx(9.0, rel=0.01)
    assert packing.bound >= 9.0


def test_round_build_volumes_are_kept():
    value, _ = pack([(3, 3, 2)] * 6, [1.0] * 6, (8, 8, 2), "cylinder", work=20.0)
    assert value >= 2.0


def test_two_items_replace_one_of_greater_value_per_volume():
    """The pass by value per volume takes the long block; the two cubes beside it are worth more."""
    value, _ = pack([(3, 2, 2), (2, 2, 2), (2, 2, 2)], [7.0, 4.0, 4.0], (4, 2, 2))
    assert value == 8.0


def test_an_exchange_gains_value_and_fits_by_volume():
    volumes = [Boxes(np.zeros(3), np.array(size, float)) for size in [(3, 2, 2), (2, 2, 2), (2, 2, 2)]]
    items = tuple(
        Item(k, 0, v, value) for k, (v, value) in enumerate(zip(volumes, [7.0, 4.0, 4.0], strict=True))
    )
    problem = PackingProblem(items, BuildVolume(np.array([4.0, 2, 2]), "box"), "fill")
    instance, params = prepare_shapes(problem, Stop()), SeparationParams()
    no_fit = prepare_no_fit(instance, params, Stop())
    assert no_fit is not None
    scene = Scene(instance, no_fit, params, np.random.default_rng(1), WorkBudget(Stop(), 1e9))
    zero = np.zeros(1, np.int64)
    best = Placed(zero, zero, zero, np.zeros((1, 3)))
    for _ in range(20):
        found = exchanged(scene, best, scene.full_height)
        assert found is not None
        assert sorted(found.items.tolist()) == [1, 2]
    everything = Placed(np.arange(3), np.array([0, 1, 1]), np.zeros(3, np.int64), np.zeros((3, 3)))
    assert exchanged(scene, everything, scene.full_height) is None
