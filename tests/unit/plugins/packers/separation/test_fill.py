"""The most valuable items that fit one build."""

import numpy as np
import pytest

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Stop, silent
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation import pack_separation


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
