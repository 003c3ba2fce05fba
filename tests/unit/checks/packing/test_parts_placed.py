"""The check of placed meshes reports each broken promise; contact is not overlap."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import mesh_of

from amprep.checks.packing.pairs import PairCounts
from amprep.checks.packing.parts_placed import check_placed, judge_placed
from amprep.model import BuildSettings, BuildVolume, Mesh, Orientations, Overrides, Part, PlacedPart, Stop

ROOM = BuildVolume(np.array([100.0, 100.0, 50.0]))


def part(solid, *, name="part", is_solid=True, **more):
    return Part(name, mesh_of(solid), solid.volume(), is_solid=is_solid, **more)


def cube(side=10.0, **more):
    return part(Manifold.cube([side] * 3), **more)


def at(shape, x=5.0, y=5.0, z=0.0, rotation=None, label="a", **more):
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) if rotation is None else rotation
    matrix[:3, 3] = x, y, z
    return PlacedPart(label, shape, matrix, **more)


def promises(*placed, stop=None, **rules):
    settings = BuildSettings("test", rules.pop("space", ROOM), **rules)
    return [violation.promise for violation in check_placed(placed, settings, stop or Stop())]


def test_an_empty_build_and_a_single_part_are_valid():
    assert promises() == []
    assert promises(at(cube()), clearance=2.0) == []


@pytest.mark.parametrize(
    ("place", "promise"),
    [
        ((-0.1, 5, 3), "inside build volume"),
        ((90.1, 5, 3), "inside build volume"),
        ((5, 5, 40.1), "inside build volume"),
        ((5, 5, -0.1), "inside build volume"),
        ((1.9, 5, 3), "clearance"),
        ((5, 88.1, 3), "clearance"),
        ((5, 5, 38.1), "clearance"),
        ((5, 5, 2.9), "lift"),
    ],
)
def test_parts_outside_or_too_close_to_walls_top_or_plate_are_reported(place, promise):
    assert promises(at(cube(), *place), clearance=2.0, lift=3.0) == [promise]


def test_contact_within_the_tolerance_is_accepted():
    assert promises(at(cube(), -0.0009, 5, 0), at(cube(), 9.998, 5, 0, label="b")) == []


def test_a_round_build_volume_has_a_round_wall():
    space = BuildVolume(np.array([20.0, 20.0, 20.0]), "cylinder")
    assert promises(at(cube(), 5, 5), space=space) == []
    assert promises(at(cube(), 8, 8), space=space) == ["inside build volume"]
    # a corner is 7.07 from the axis: 2.93 from the wall
    assert promises(at(cube(), 5, 5), space=space, clearance=3.0) == ["clearance"]


def test_overlap_and_clearance_are_measured_on_the_meshes():
    for x, expected in ((15.0, []), (14.9, ["no intersection"]), (17.0, []), (16.9, [])):
        assert promises(at(cube()), at(cube(), x, label="b")) == expected
    for x, expected in ((17.0, []), (16.9, ["clearance"]), (14.9, ["no intersection"])):
        assert promises(at(cube()), at(cube(), x, label="b"), clearance=2.0) == expected


def test_enclosing_boxes_may_overlap_if_the_meshes_do_not():
    ring = part(Manifold.cylinder(10, 20, 20, center=False) - Manifold.cylinder(10, 15, 15))
    peg = part(Manifold.cylinder(10, 10, 10))
    assert promises(at(ring, 30, 30), at(peg, 30, 30, label="peg")) == []
    assert promises(at(ring, 30, 30), at(peg, 36, 30, label="peg")) == ["no intersection"]


def test_a_part_wholly_inside_another_intersects_it():
    assert promises(at(cube(30.0)), at(cube(5.0), 15, 15, 10, label="inner")) == ["no intersection"]


def test_distances_of_surfaces_are_those_of_their_triangles():
    sheet = Part("sheet", Mesh([[0, 0, 0], [20, 0, 0], [0, 20, 0]], [[0, 1, 2]]), 0.0, is_solid=False)
    box = cube()
    assert promises(at(sheet, 4, 4, 20), at(box, 5, 5, 0, label="b"), clearance=2.0) == []
    assert promises(at(sheet, 4, 4, 11), at(box, 5, 5, 0, label="b"), clearance=2.0) == ["clearance"]
    assert promises(at(sheet, 4, 4, 5), at(box, 5, 5, 0, label="b")) == ["no intersection"]
    assert promises(at(sheet, 4, 4, 10), at(box, 5, 5, 0, label="b")) == []


def test_overlap_with_a_zone_is_measured_on_the_meshes():
    space = BuildVolume(np.array([100.0, 100.0, 50.0]), zone_lo=[[50, 0, 0]], zone_hi=[[60, 100, 50]])
    ball = part(Manifold.sphere(10, 64))
    sheet = Part("sheet", Mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]]), 0.0, is_solid=False)
    assert promises(at(ball, 40, 20, 10), space=space, clearance=2.0) == []
    assert promises(at(ball, 40.1, 20, 10), space=space) == ["outside forbidden zones"]
    assert promises(at(sheet, 52, 20, 10), space=space) == ["outside forbidden zones"]


def test_placements_in_other_orientations_are_reported():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    tilt = turn[[2, 0, 1]][:, [2, 0, 1]]
    place = {"x": 30.0, "y": 30.0, "z": 20.0}
    listed = Orientations(matrices=np.array([np.eye(3), turn]))
    assert promises(at(cube(), **place, rotation=turn, orientations=listed)) == []
    assert promises(at(cube(), **place, rotation=turn)) == ["allowed motion"]
    assert promises(at(cube(), **place, rotation=tilt, orientations=Orientations("about-z"))) == [
        "allowed motion"
    ]
    assert promises(at(cube(), **place, rotation=tilt, orientations=Orientations("free"))) == []
    for bad in (np.diag([1.0, 1.0, -1.0]), 1.01 * np.eye(3), np.array([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]])):
        assert promises(at(cube(), **place, rotation=bad, orientations=Orientations("free"))) == [
            "allowed motion"
        ]
    assert promises(at(cube(), float("nan"))) == ["allowed motion"]


def test_a_rotation_rounded_to_six_digits_is_still_the_allowed_one():
    c, s = np.cos(0.3), np.sin(0.3)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    listed = Orientations(matrices=turn[None])
    assert promises(at(cube(), 30, 30, 10, rotation=np.round(turn, 6), orientations=listed)) == []


def test_geometry_that_differs_from_its_digest_is_reported():
    shape = cube()
    assert promises(at(shape, recorded_digest=shape.mesh.digest)) == []
    assert promises(at(shape, recorded_digest="0" * 64)) == ["part unchanged"]


def test_clearance_and_lift_of_a_part_override_those_of_the_build():
    wide = cube(overrides=Overrides(clearance_mm=5.0))
    assert promises(at(cube(), 10), at(wide, 24, 10, label="b")) == ["clearance"]
    assert promises(at(cube(), 10), at(wide, 25, 10, label="b")) == []
    high = cube(overrides=Overrides(lift_mm=4.0))
    assert promises(at(high, z=3.0), lift=3.0) == ["lift"]
    assert promises(at(high, z=4.0), lift=3.0) == []


def test_a_check_that_is_stopped_reports_a_violation():
    stop = Stop()
    stop.cancelled.set()
    found = check_placed([at(cube()), at(cube(), 8, label="b")], BuildSettings("test", ROOM), stop)
    assert [violation.promise for violation in found] == ["clearance"]
    assert "interrupted" in found[0].message


def test_the_judge_counts_every_pair_once_by_the_method_that_judged_it():
    ball = part(Manifold.sphere(5, 32))
    placed = [
        at(ball, 20, 20, 10),
        at(ball, 28, 28, 10, label="near"),
        at(cube(), 60, 60, 0, label="cube"),
        at(cube(), 70, 60, 0, label="touching"),
    ]
    found, counts = judge_placed(placed, BuildSettings("test", ROOM), Stop())
    assert not found
    assert counts == PairCounts(boxes=5, triangles=1, solids=0), "boxes that only touch are apart"
    found, counts = judge_placed(placed, BuildSettings("test", ROOM, clearance=0.5), Stop())
    assert [violation.promise for violation in found] == ["clearance"]
    assert counts == PairCounts(boxes=4, triangles=1, solids=1)
