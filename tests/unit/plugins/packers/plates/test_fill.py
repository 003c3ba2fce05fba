"""The most valuable plate, and the height of one plate, which is that of the tallest part."""

import pytest
from tests.shared.plates import block, disc, pack, plate_problem, ring, shadow_faults

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Orientations
from amprep.model.rotations import axis_rotations


def checked(problem, **params):
    packing = pack(problem, **params)
    assert check_packing(problem, packing) == []
    assert shadow_faults(problem, packing) == []
    return packing


def test_the_plate_is_filled_with_the_greatest_value():
    volumes = [block(10, 10), block(20, 20), block(20, 9), block(9, 20), block(9, 9)]
    packing = checked(plate_problem(volumes, (30.0, 30.0, 5.0), "fill", values=[1.0, 10.0, 5.0, 5.0, 2.0]))
    assert sorted(p.item for p in packing.builds[0]) == [1, 2, 3, 4]


def test_all_parts_on_one_plate_have_the_height_of_the_tallest_and_this_is_proved():
    packing = checked(
        plate_problem([ring(15.0, 9.0, 7.0), disc(6.0, 3.0)], (32.0, 32.0, 20.0), "height", lift=1.0)
    )
    assert packing.status == "optimal"
    assert packing.bound == pytest.approx(8.0)


def test_parts_that_may_be_laid_down_are_for_height():
    allowed = Orientations("list", axis_rotations())
    packing = checked(
        plate_problem([block(4, 6, 20), block(5, 5, 18)], (40.0, 40.0, 30.0), "height", allowed)
    )
    assert packing.status == "optimal"
    assert packing.bound == pytest.approx(5.0)
