"""The packer `sweep` fills rows, rows fill layers, layers fill builds."""

import numpy as np
import pytest
from tests.shared.boxes import boxes_problem as problem

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Orientations, Stop, silent
from amprep.model.rotations import axis_rotations
from amprep.plugins.packers.params import SweepParams
from amprep.plugins.packers.sweep import pack_sweep


def run(task, stop=None, **params):
    packing = pack_sweep(
        task, params=SweepParams(**params), rng=np.random.default_rng(0), stop=stop or Stop(), progress=silent
    )
    assert check_packing(task, packing) == []
    return packing


def test_eight_cubes_make_two_rows_in_each_of_two_layers():
    packing = run(problem([(5, 5, 5)] * 8))
    assert (len(packing.builds), packing.status) == (1, "optimal")
    corners = sorted(placement.translation.tolist() for placement in packing.builds[0])
    assert corners == [[x, y, z] for x in (0, 5) for y in (0, 5) for z in (0, 5)]


def test_a_lower_box_does_not_stand_on_another_in_its_layer():
    # one slicing: the layer is 6 high, the box of height 3 stands beside; above it 3 mm stay empty
    packing = run(problem([(5, 10, 6), (5, 10, 3), (5, 10, 3), (5, 10, 4)]), slicings=1)
    assert sorted(p.translation[2] for p in packing.builds[0]) == [0.0, 0.0, 6.0, 6.0]


def test_without_stacking_there_is_one_layer_a_build():
    packing = run(problem([(5, 5, 2)] * 8, stacking=False))
    assert [len(build) for build in packing.builds] == [4, 4]


def test_clearance_is_kept_in_every_direction_and_what_just_fits_fits():
    assert len(run(problem([(3, 3, 3)] * 8, room=(9, 9, 8), clearance=1.0, lift=0.0)).builds) == 1
    assert len(run(problem([(3, 3, 3)] * 8, room=(9, 9, 7.9), clearance=1.0)).builds) == 2


def test_a_box_is_turned_flat_when_it_may():
    sizes = [(2, 10, 10)] * 5
    assert len(run(problem(sizes, orientations=Orientations("list", axis_rotations()))).builds) == 1


def test_filling_takes_one_build_and_the_greater_of_two_that_exclude_each_other():
    packing = run(problem([(6, 6, 6), (10, 10, 10)], objective="fill"))
    assert [placement.item for placement in packing.builds[0]] == [1]
    assert [(left.item, left.reason) for left in packing.unplaced] == [(0, "no room left")]


@pytest.mark.parametrize("seed", range(5))
def test_boxes_of_any_shape_keep_the_promise(seed):
    rng = np.random.default_rng(seed)
    task = problem(rng.uniform(0.5, 9.0, (60, 3)).tolist(), clearance=0.3, lift=0.5)
    run(task)
    run(task, Stop.after(0.0))


def test_a_negative_number_of_slicings_is_refused():
    with pytest.raises(ValueError, match="slicings"):
        SweepParams(slicings=-1)
