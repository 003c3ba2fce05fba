"""What needs support, on shapes whose faces, edges and tips can be counted by hand."""

import manifold3d
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.geometry.overhangs.candidates import Modifiers
from amprep.geometry.overhangs.find import find_overhangs

Solid = manifold3d.Manifold


def arrays(solid):
    mesh = solid.to_mesh()
    return np.asarray(mesh.vert_properties[:, :3], float), np.asarray(mesh.tri_verts, np.int32)


def needs(solid, angle_deg=45.0, **limits):
    return find_overhangs(*arrays(solid), angle_deg=angle_deg, **limits)


def box(size, corner=(0, 0, 0)):
    return Solid.cube(size).translate(corner)


def summary(overhangs):
    return [(region.kind, pytest.approx(region.measure, abs=1e-4)) for region in overhangs.regions]


def wedge(angle_deg, length=10.0):
    """A ramp standing on an upright wall: its slanted face looks down at `angle_deg` to the plate."""
    rise = length * np.tan(np.radians(angle_deg))
    points = [(0, y, 0) for y in (0, 5)] + [(0, y, rise + 1) for y in (0, 5)]
    points += [(length, y, rise) for y in (0, 5)] + [(length, y, rise + 1) for y in (0, 5)]
    return np.array(points, float)


def ramp(angle_deg):
    vertices = wedge(angle_deg)
    triangles = [(0, 1, 4), (4, 1, 5)]  # the slanted face, normal down
    return vertices, np.array(triangles, np.int32)


def test_a_box_on_the_plate_needs_nothing():
    assert needs(box((10, 20, 5))).regions == ()


def test_a_lifted_box_needs_its_whole_underside_as_one_region():
    found = needs(box((10, 20, 5), (0, 0, 3)))
    assert summary(found) == [("face", 200.0)]
    assert found.regions[0].centre == pytest.approx((5, 10, 3))
    assert found.face_region.tolist() == [0, 0]


def test_a_table_needs_the_underside_of_its_slab_around_the_leg():
    table = box((40, 40, 5), (0, 0, 20)) + box((10, 10, 20), (15, 15, 0))
    assert summary(needs(table)) == [("face", 40.0 * 40 - 10 * 10)]


def test_two_undersides_apart_are_two_regions():
    arch = box((30, 10, 5), (0, 0, 10)) + box((10, 10, 10), (10, 0, 0))
    assert summary(needs(arch)) == [("face", 100.0), ("face", 100.0)]


@pytest.mark.parametrize(
    ("angle_deg", "needed"), [(44.98, True), (44.995, False), (45.0, False), (45.005, False), (30.0, True)]
)
def test_a_face_within_a_hundredth_of_a_degree_of_the_threshold_counts_as_steep(angle_deg, needed):
    found = find_overhangs(*ramp(angle_deg), angle_deg=45.0)
    assert (len(found.faces) == 2) == needed


def test_any_threshold_is_possible():
    assert len(find_overhangs(*ramp(60.0), angle_deg=70.0).faces) == 2
    assert len(find_overhangs(*ramp(10.0), angle_deg=5.0).faces) == 0


def tilted_cube(degrees=45.0, lift=0.0):
    return Solid.cube((10, 10, 10), True).rotate((degrees, 0, 0)).translate((0, 0, 50 + lift))


def on_plate(solid, lift=0.0):
    return solid.translate((0, 0, lift - solid.bounding_box()[2]))


def test_a_cube_that_rests_on_the_plate_with_an_edge_is_held_by_it():
    assert needs(on_plate(tilted_cube())).regions == ()


def test_the_same_cube_lifted_needs_its_knife_edge_held():
    found = needs(on_plate(tilted_cube(), lift=1.0))
    assert summary(found) == [("edge", 10.0)]
    assert arrays(on_plate(tilted_cube(), lift=1.0))[0][found.edges.ravel(), 2] == pytest.approx([1, 1])


def test_an_edge_of_a_needy_face_is_no_knife_edge():
    found = needs(on_plate(tilted_cube(30.0), lift=1.0))
    assert summary(found) == [("face", 100.0)]


def test_a_steep_edge_needs_nothing_on_its_own():
    blade = Solid.hull_points([(0, -1, 20), (0, 1, 20), (0, 0, 0), (20, -1, 70), (20, 1, 70), (20, 0, 50)])
    found = needs(on_plate(blade, lift=1.0))
    assert [region.kind for region in found.regions] == ["tip"]


def test_a_groove_seen_from_above_is_no_knife_edge():
    block = box((20, 20, 20), (-10, -10, 0)) - tilted_cube(45.0, lift=-30.0)
    assert needs(block).regions == ()


def test_a_cone_on_its_tip_needs_the_tip_held_unless_it_stands_on_the_plate():
    cone = Solid.cylinder(20, 0, 5, 24)
    assert needs(cone).regions == ()
    found = needs(cone.translate((0, 0, 2)))
    assert summary(found) == [("tip", 0.0)]
    assert found.regions[0].centre == pytest.approx((0, 0, 2))


def test_the_bottom_of_a_pit_is_no_tip():
    assert (
        needs(box((20, 20, 30), (-10, -10, 0)) - Solid.cylinder(21, 0, 5, 24).translate((0, 0, 10))).regions
        == ()
    )


def test_small_regions_are_dropped():
    notch = box((10, 10, 10)) - box((0.5, 0.5, 1), (4, 4, 0))
    assert summary(needs(notch)) == [("face", 0.25)]
    assert needs(notch, min_area=0.3).regions == ()


def test_a_region_that_starts_in_the_air_is_kept_however_small():
    blunt = Solid.cylinder(20, 0.1, 5, 4).translate((0, 0, 2))
    assert summary(needs(blunt, min_area=5.0)) == [("face", pytest.approx(0.02, abs=1e-3))]
    short = Solid.hull_points([(0, 0, 1), (0.2, 0, 1), (0, -3, 9), (0.2, -3, 9), (0, 3, 9), (0.2, 3, 9)])
    assert summary(needs(short, min_length=1.0)) == [("edge", 0.2)]


def test_a_ball_needs_its_cap_under_45_degrees():
    radius = 10.0
    found = needs(Solid.sphere(radius, 256).translate((0, 0, 20)))
    assert [region.kind for region in found.regions] == ["face"]
    cap = 2 * np.pi * radius**2 * (1 - np.cos(np.pi / 4))
    assert found.regions[0].measure == pytest.approx(cap, rel=0.02)


def test_loose_triangles_give_the_same_needs_as_shared_vertices():
    vertices, triangles = arrays(on_plate(tilted_cube(20.0), lift=1.0))
    loose = find_overhangs(
        vertices[triangles.ravel()], np.arange(triangles.size).reshape(-1, 3), angle_deg=45
    )
    shared = find_overhangs(vertices, triangles, angle_deg=45)
    assert loose.faces.tolist() == shared.faces.tolist()
    assert summary(loose) == summary(shared)


def test_edges_of_four_faces_and_open_walls_are_judged_too():
    left, right = (arrays(box((5, 5, 5), (x, x, 1))) for x in (0, 5))
    both = np.concatenate([left[0], right[0]]), np.concatenate([left[1], right[1] + 8])
    assert summary(find_overhangs(*both, angle_deg=45)) == [("face", 25.0), ("face", 25.0)]
    wall = np.array([(0, 0, 2), (8, 0, 2), (8, 0, 9), (0, 0, 9)], float), np.array([(0, 1, 2), (0, 2, 3)])
    assert summary(find_overhangs(*wall, angle_deg=45)) == [("edge", 8.0)]


def test_nothing_comes_of_an_empty_mesh():
    assert find_overhangs(np.empty((0, 3)), np.empty((0, 3), np.int32), angle_deg=45).regions == ()


def test_marks_block_and_enforce():
    vertices, triangles = arrays(box((10, 10, 5), (0, 0, 3)))
    none, every = np.zeros(len(triangles), bool), np.ones(len(triangles), bool)
    corners = np.ones(len(vertices), bool)
    assert (
        find_overhangs(vertices, triangles, angle_deg=45, modifiers=Modifiers(none, every, corners)).regions
        == ()
    )
    steep = ramp(60.0)
    marks = Modifiers(np.array([True, True]), np.zeros(2, bool), np.zeros(len(steep[0]), bool))
    assert len(find_overhangs(*steep, angle_deg=45, modifiers=marks).faces) == 2
    upper = Modifiers(every, none, ~corners)
    assert (
        len(find_overhangs(vertices, triangles, angle_deg=45, modifiers=upper).faces) == 2
    )  # only the underside


def test_what_lies_on_the_plate_is_held_by_it_even_when_support_is_enforced():
    vertices, triangles = arrays(box((10, 10, 5), (0, 0, 0)))
    marks = Modifiers(
        np.ones(len(triangles), bool), np.zeros(len(triangles), bool), np.zeros(len(vertices), bool)
    )
    assert find_overhangs(vertices, triangles, angle_deg=45, modifiers=marks).regions == ()


@examples(60)
@given(st.lists(st.tuples(*[st.floats(0, 20)] * 3), min_size=5, max_size=12), st.floats(10, 80))
def test_the_lowest_point_of_a_lifted_convex_solid_is_always_among_its_needs(points, angle_deg):
    hull = Solid.hull_points(np.array(points))
    if hull.volume() < 1.0:
        return
    vertices, triangles = arrays(on_plate(hull, lift=1.0))
    found = find_overhangs(vertices, triangles, angle_deg=angle_deg, min_area=1e9, min_length=1e9)
    used = np.concatenate([triangles[found.faces].ravel(), found.edges.ravel(), found.tips])
    assert vertices[used, 2].min() == pytest.approx(1.0, abs=1e-5)
