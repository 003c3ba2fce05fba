"""Few builds for instances whose least number is known."""

import numpy as np

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Item, PackingProblem, Placement, Stop, silent
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation import pack_separation


def angle(size=4.0):
    """Two boxes that form an L in the plane of x and y."""
    return Boxes(np.array([[0.0, 0, 0], [0, 0, 0]]), np.array([[size, 1.0, 2], [1.0, size, 2]]))


def block(x, y, z):
    return Boxes(np.zeros(3), np.array([x, y, z], float))


def pack(volumes, size, work=100.0, **rules):
    items = tuple(Item(k, 0, volume, 1.0) for k, volume in enumerate(volumes))
    problem = PackingProblem(items, BuildVolume(np.array(size, float)), "builds", **rules)
    packing = pack_separation(
        problem,
        params=SeparationParams(work=work),
        rng=np.random.default_rng(2),
        stop=Stop(),
        progress=silent,
    )
    assert check_packing(problem, packing) == []
    return packing


def test_shapes_of_several_boxes_nest():
    packing = pack([angle()] * 3, (6, 6, 2))
    assert len(packing.builds) == 1
    assert packing.status == "optimal"


def test_the_bound_by_volume_is_met_by_blocks_that_fill_two_builds():
    packing = pack([block(4, 2, 2)] * 4 + [block(2, 4, 2)] * 4, (4, 4, 4))
    assert packing.bound == 2.0
    assert len(packing.builds) == 2


def test_parts_share_the_first_build_with_a_fixed_one():
    fixed = (Placement(0, np.eye(3), np.zeros(3)),)
    packing = pack([block(4, 4, 2), block(4, 4, 2)], (4, 4, 4), fixed=fixed)
    assert len(packing.builds) == 1


def test_a_part_that_is_too_large_is_left_out_and_the_others_are_not():
    packing = pack([block(9, 1, 1), block(1, 1, 1)], (4, 4, 4))
    assert [(unplaced.item, unplaced.reason) for unplaced in packing.unplaced] == [(0, "too large")]
    assert packing.status == "infeasible"
