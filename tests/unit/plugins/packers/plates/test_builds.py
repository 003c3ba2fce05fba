"""Few plates, judged on the meshes and on areas of shadows, and the promises of any packer."""

import numpy as np
import pytest
from tests.shared.plates import block, disc, mushroom, pack, plate_problem, ring, shadow_faults

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import Boxes, BuildVolume, Orientations, Placement, Stop
from amprep.model.rotations import quarter_turns

TURNS = Orientations("list", quarter_turns())


def checked(problem, **params):
    packing = pack(problem, **params)
    assert check_packing(problem, packing) == []
    assert shadow_faults(problem, packing) == []
    return packing


@pytest.mark.parametrize("clearance", [0.0, 0.5, 3.0])
def test_small_parts_go_into_the_holes_of_large_ones(clearance):
    side = 40.0 + 2.0 * clearance
    volumes = [ring(20.0, 12.0), ring(11.5 - clearance, 8.0), disc(7.5 - 2.0 * clearance)]
    packing = checked(plate_problem(volumes, (side, side, 9.0), clearance=clearance))
    assert len(packing.builds) == 1
    assert packing.status == "optimal"
    assert packing.bound_for == "shapes"


def test_nothing_is_below_an_overhang():
    problem = plate_problem([mushroom(10.0, 2.0), disc(4.0, 2.0)], (22.0, 22.0, 9.0))
    assert len(checked(problem).builds) == 2


def test_angles_nest_where_their_boxes_do_not():
    angle = Boxes(np.zeros((2, 3)), np.array([[10.0, 2.0, 3.0], [2.0, 10.0, 3.0]]))
    packing = checked(plate_problem([angle] * 6, (16.2, 16.2, 5.0), orientations=TURNS, clearance=0.5))
    assert len(packing.builds) == 2


def test_a_round_plate_takes_parts_up_to_its_edge():
    problem = plate_problem(
        [disc(10.0)] * 7, BuildVolume(np.array([64.0, 64.0, 9.0]), "cylinder"), clearance=0.5
    )
    assert len(checked(problem).builds) == 1


def test_zones_and_fixed_parts_are_avoided_and_low_zones_only_by_what_they_meet():
    space = BuildVolume(
        np.array([30.0, 30.0, 20.0]), "box", np.array([[10.0, 0.0, 5.0]]), np.array([[20.0, 30.0, 20.0]])
    )
    fixed = (Placement(0, np.eye(3), np.array([21.0, 1.0, 0.0])),)
    volumes = [block(8, 28, 10), block(8, 28, 10), block(8, 28, 4), disc(4.0, 12.0)]
    packing = checked(plate_problem(volumes, space, fixed=fixed, clearance=0.5))
    assert [sorted(p.item for p in build) for build in packing.builds] == [[0, 1, 2], [3]]


def test_any_angle_is_narrowed_to_steps():
    problem = plate_problem([block(30, 2)], (24.0, 24.0, 5.0), orientations=Orientations("about-z"))
    assert len(checked(problem, angle_step_deg=15.0).builds) == 1


def test_boxes_that_fill_a_plate_are_in_neat_rows():
    packing = checked(plate_problem([block(10, 10)] * 9, (30.0, 30.0, 5.0)))
    assert packing.status == "optimal"
    assert len({round(float(p.translation[0]), 6) for p in packing.builds[0]}) == 3


def test_the_same_seed_gives_the_same_layout_and_a_stop_the_best_so_far():
    rng = np.random.default_rng(5)
    volumes = [block(*size) for size in rng.uniform(3, 12, (30, 2))] + [ring(9.0, 6.0)] * 2
    problem = plate_problem(volumes, (30.0, 30.0, 9.0), orientations=TURNS, clearance=0.5)
    one, other = (checked(problem, work=60.0) for _ in range(2))
    matrices = [[[p.matrix.tolist() for p in build] for build in each.builds] for each in (one, other)]
    assert matrices[0] == matrices[1]
    stopped = checked(problem, stop=Stop.after(0.0))
    assert sum(map(len, stopped.builds)) == len(volumes)


def test_parts_that_hang_over_keep_a_margin_for_their_supports_and_others_do_not():
    def gap(volume):
        packing = checked(plate_problem([volume] * 2, (60.0, 60.0, 9.0)), support_margin_mm=3.0)
        one, other = packing.builds[0]
        return np.hypot(*(one.translation - other.translation)[:2]) - 16.0

    assert gap(mushroom(8.0, 2.0)) >= 6.0 - 1e-3
    assert gap(disc(8.0)) < 2.0
