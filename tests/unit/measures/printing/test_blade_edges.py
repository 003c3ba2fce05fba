"""Long edges that the recoater blade meets at once are found, with part, length and height."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.builds import box_mesh
from tests.shared.solids import mesh_of

from amprep.measures.printing.blade_edges import BladeRules, measure_blade_edges
from amprep.model import Build, BuildSettings, BuildVolume, Part, PlacedPart
from amprep.model.rotations import turns_about_z


def edges_of(mesh, *degrees, rules=None, place=(50.0, 60.0, 3.0)):
    part = Part("part", mesh, mesh.signed_volume)
    placed = []
    for angle in degrees:
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = turns_about_z(np.array([angle]))[0], place
        placed.append(PlacedPart("part", part, matrix))
    build = Build(BuildSettings("none", BuildVolume(np.full(3, 200.0))), tuple(placed))
    return measure_blade_edges(build, rules or BladeRules())


PLATE = box_mesh((0, 0, 0), (8, 40, 6))


def test_a_side_parallel_to_the_blade_is_found_with_its_length_and_heights():
    (edge,) = edges_of(PLATE, 0.0)
    assert (edge.part, edge.faces) == (0, 2)
    assert edge.length_mm == pytest.approx(40)
    assert edge.off_deg == pytest.approx(0, abs=1e-9)
    assert (edge.low_mm, edge.high_mm) == (pytest.approx(3), pytest.approx(9))
    assert edge.position_mm[1] == pytest.approx(80)
    assert edge.position_mm[0] in (pytest.approx(50), pytest.approx(58))


@pytest.mark.parametrize(
    ("degrees", "meets"),
    [(0, True), (4.9, True), (5.1, False), (90, False), (-4.9, True), (176, True), (45, False)],
)
def test_an_edge_meets_the_blade_within_five_degrees(degrees, meets):
    assert len(edges_of(PLATE, degrees)) == meets


def test_the_blade_is_perpendicular_to_its_motion():
    for degrees in (0.0, 30.0, 90.0, 250.0):
        rules = BladeRules(recoater_deg=degrees)
        assert len(edges_of(PLATE, degrees, rules=rules)) == 1
        assert len(edges_of(PLATE, degrees + 90, rules=rules)) == 0


def test_short_edges_and_round_parts_meet_the_blade_point_by_point():
    assert edges_of(box_mesh((0, 0, 0), (9.9, 9.9, 50)), 0.0) == ()
    assert edges_of(mesh_of(Manifold.cylinder(30, 20, 20, 90)), 0.0) == ()
    assert len(edges_of(mesh_of(Manifold.cylinder(30, 6, 6, 60).rotate([90, 0, 0])), 0.0)) == 1
    assert edges_of(mesh_of(Manifold.sphere(20, 64)), 0.0) == ()


def test_each_placed_part_is_judged_in_its_own_orientation():
    assert [edge.part for edge in edges_of(PLATE, 0.0, 45.0, 2.0, 90.0)] == [0, 2]


@pytest.mark.parametrize("key", ["angle_deg", "edge_mm"])
def test_rules_out_of_bounds_are_refused(key):
    with pytest.raises(ValueError, match=key):
        BladeRules(**{key: -1.0})
