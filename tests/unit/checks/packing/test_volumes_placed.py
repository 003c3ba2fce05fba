"""The check of packings accepts a valid one and reports each promise that is broken on purpose."""

from dataclasses import replace

import numpy as np
import pytest

from amprep.checks.packing.volumes_placed import check_packing
from amprep.model import (
    Boxes,
    BuildVolume,
    ConvexPieces,
    Item,
    Mesh,
    Orientations,
    Packing,
    PackingProblem,
    Placement,
    Solid,
    Unplaced,
)

QUARTER_TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
MIRROR = np.diag([-1.0, 1.0, 1.0])


def cube(side=10.0):
    return Boxes(np.zeros((1, 3)), np.full((1, 3), side))


def cube_mesh(side=10.0):
    import manifold3d

    mesh = manifold3d.Manifold.cube([side] * 3).to_mesh()
    return Mesh(mesh.vert_properties[:, :3], mesh.tri_verts)


def items(*volumes, orientations=None):
    return tuple(Item(i, 0, volume, 1.0, orientations or Orientations()) for i, volume in enumerate(volumes))


def at(item, x, y, z, rotation=None):
    return Placement(item, np.eye(3) if rotation is None else rotation, np.array([x, y, z], float))


PROBLEM = PackingProblem(
    items(cube(), cube(), cube()), BuildVolume(np.array([60.0, 60.0, 60.0])), clearance=2.0, lift=3.0
)
GOOD = Packing(((at(0, 2, 2, 3), at(1, 14, 2, 3)), (at(2, 2, 2, 3),)), bound=1.0)


def promises(problem, packing):
    return [violation.promise for violation in check_packing(problem, packing)]


def moved(*placement, problem=PROBLEM):
    """Return the promises broken when item 1 of the valid packing is moved."""
    return promises(problem, replace(GOOD, builds=((at(0, 2, 2, 3), at(1, *placement)), GOOD.builds[1])))


def test_a_valid_packing_has_no_violation():
    assert check_packing(PROBLEM, GOOD) == []


def test_an_item_that_is_missing_or_occurs_twice_is_reported():
    assert promises(PROBLEM, replace(GOOD, builds=GOOD.builds[:1])) == ["every item once"]
    assert promises(PROBLEM, replace(GOOD, unplaced=(Unplaced(2, "no room left"),))) == ["every item once"]


def test_an_unknown_item_is_reported():
    assert "known item" in promises(PROBLEM, replace(GOOD, unplaced=(Unplaced(3, "no room left"),)))


def test_an_empty_build_is_reported():
    assert promises(PROBLEM, replace(GOOD, builds=(*GOOD.builds, ()))) == ["no empty build"]


def test_a_fill_problem_has_one_build():
    assert promises(replace(PROBLEM, objective="fill"), replace(GOOD, bound=3.0)) == ["one build"]


@pytest.mark.parametrize(
    ("place", "promise"),
    [
        ((13.9, 2, 3), "clearance"),
        ((9, 2, 3), "no overlap"),
        ((48.1, 2, 3), "inside build volume"),
        ((14, 1.9, 3), "inside build volume"),
        ((14, 2, 48.1), "inside build volume"),
        ((14, 2, 2.9), "lift"),
        ((np.nan, 2, 3), "allowed motion"),
        ((24, 2, 3, QUARTER_TURN), "allowed motion"),
        ((24, 2, 3, MIRROR), "allowed motion"),
        ((14, 2, 3, np.eye(3) * 1.01), "allowed motion"),
    ],
)
def test_a_placement_that_breaks_a_rule_is_reported(place, promise):
    assert moved(*place) == [promise]


def test_contact_within_the_tolerance_is_accepted():
    assert moved(13.9995, 2, 3) == []
    assert moved(48.0005, 2, 3) == []


def test_clearance_is_measured_diagonally():
    # 1.5 apart in x and in y is 2.12 apart, 1.4 and 1.4 is 1.98
    assert moved(13.5, 13.5, 3) == []
    assert moved(13.4, 13.4, 3) == ["clearance"]


def test_without_stacking_each_item_is_at_the_lift_height():
    assert moved(14, 2, 20) == []
    assert moved(14, 2, 20, problem=replace(PROBLEM, stacking=False)) == ["stacking"]


def test_overlap_with_a_forbidden_zone_is_reported():
    zoned = replace(
        PROBLEM, space=BuildVolume(np.full(3, 60.0), zone_lo=[[24, 0, 0]], zone_hi=[[30, 60, 60]])
    )
    assert moved(14, 2, 3, problem=zoned) == []
    assert moved(14.1, 2, 3, problem=zoned) == ["outside forbidden zones"]


def test_corners_outside_the_circle_of_a_round_build_are_reported():
    # centred on the axis the corners are 7.07 from it: a radius of 9.07 leaves the clearance of 2
    for diameter, expected in ((18.15, []), (18.1, ["inside build volume"])):
        space = BuildVolume(np.array([diameter, diameter, 60.0]), "cylinder")
        problem = replace(PROBLEM, items=PROBLEM.items[:1], space=space)
        middle = diameter / 2.0 - 5.0
        assert promises(problem, Packing(((at(0, middle, middle, 3),),))) == expected


def test_a_moved_fixed_placement_is_reported():
    fixed = replace(PROBLEM, fixed=(at(0, 2, 2, 3),))
    assert promises(fixed, GOOD) == []
    assert promises(replace(PROBLEM, fixed=(at(0, 2, 3, 3),)), GOOD) == ["fixed placement kept"]
    assert promises(replace(PROBLEM, fixed=(at(2, 2, 2, 3),)), GOOD) == ["fixed placement kept"]


def test_fixed_placements_are_not_checked_otherwise():
    outside = replace(PROBLEM, fixed=(at(0, -5, 2, 0),))
    assert promises(outside, replace(GOOD, builds=((at(0, -5, 2, 0), at(1, 14, 2, 3)), GOOD.builds[1]))) == []


def test_an_unplaced_item_needs_a_reason_and_too_large_must_be_true():
    one_left = replace(GOOD, builds=GOOD.builds[:1], bound=None)
    assert promises(PROBLEM, replace(one_left, unplaced=(Unplaced(2, "too large"),))) == ["reason true"]
    assert promises(PROBLEM, replace(one_left, unplaced=(Unplaced(2, ""),))) == ["reason given"]
    large = replace(PROBLEM, items=items(cube(), cube(), cube(70.0)))
    assert promises(large, replace(one_left, unplaced=(Unplaced(2, "too large"),))) == []


@pytest.mark.parametrize(
    ("change", "promise"),
    [
        ({"bound": 3.0}, "bound"),
        ({"status": "optimal"}, "status"),
        ({"status": "optimal", "bound": None}, "status"),
        ({"status": "infeasible"}, "status"),
    ],
)
def test_a_status_or_bound_that_contradicts_the_packing_is_reported(change, promise):
    assert promises(PROBLEM, replace(GOOD, **change)) == [promise]


def test_optimal_is_accepted_if_the_bound_is_met():
    assert promises(PROBLEM, replace(GOOD, status="optimal", bound=2.0)) == []


def test_a_rotation_beyond_the_allowed_freedom_is_reported():
    c = np.sqrt(0.5)
    about_z = np.array([[c, -c, 0.0], [c, c, 0.0], [0.0, 0.0, 1.0]])
    about_x = about_z[[2, 0, 1]][:, [2, 0, 1]]
    for freedom, rotation, expected in (
        ("about-z", about_z, []),
        ("about-z", about_x, ["allowed motion"]),
        ("free", about_x, []),
        ("list", about_z, ["allowed motion"]),
    ):
        problem = replace(PROBLEM, items=items(cube(), orientations=Orientations(freedom)))
        assert promises(problem, Packing(((at(0, 20, 20, 20, rotation),),))) == expected


@pytest.mark.parametrize("kind", ["boxes", "pieces", "solid"])
def test_rotated_boxes_convex_pieces_and_solids_are_measured_exactly(kind):
    volume = {"boxes": cube(), "pieces": ConvexPieces((cube_mesh(),)), "solid": Solid(cube_mesh())}[kind]
    c = np.sqrt(0.5)
    turned = np.array([[c, -c, 0.0], [c, c, 0.0], [0.0, 0.0, 1.0]])
    problem = PackingProblem(
        items(volume, volume, orientations=Orientations("free")), BuildVolume(np.full(3, 60.0))
    )
    # two diamonds side by side: sides touch where the centres are 10 apart along (1, 1)
    apart = 10.0 * c
    for shift, expected in ((apart + 0.01, []), (apart - 0.1, ["no overlap"])):
        builds = ((at(0, 20, 20, 0, turned), at(1, 20 + shift, 20 + shift, 0, turned)),)
        assert promises(problem, Packing(builds)) == expected


def test_bounds_of_height_and_fill_problems_are_checked():
    one = replace(PROBLEM, items=PROBLEM.items[:1])
    builds = ((at(0, 2, 2, 3),),)
    assert promises(replace(one, objective="height"), Packing(builds, bound=13.0, status="optimal")) == []
    assert promises(replace(one, objective="height"), Packing(builds, bound=14.0)) == ["bound"]
    assert promises(replace(one, objective="fill"), Packing(builds, bound=1.0, status="optimal")) == []
    assert promises(replace(one, objective="fill"), Packing(builds, bound=0.5)) == ["bound"]
