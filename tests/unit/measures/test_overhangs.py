"""Areas that need support on parts whose overhangs are known by hand."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.builds import box_mesh

from amprep.geometry.meshes.manifold import as_manifold
from amprep.measures.overhangs import measure_overhangs
from amprep.model import Mesh, Orientations, Part, PlacedPart, Region
from amprep.model.supports.rules import SupportRules


def table(lift=0.0):
    """A plate of 20 x 20 mm on a leg of 10 x 20 mm: 10 x 20 mm of it are in the air."""
    leg, top = box_mesh((0, 0, lift), (10, 20, 10)), box_mesh((0, 0, lift + 10), (20, 20, 5))
    solid = (as_manifold(*leg.arrays) + as_manifold(*top.arrays)).to_mesh()
    mesh = Mesh(solid.vert_properties[:, :3], solid.tri_verts)
    return PlacedPart("table", Part("table", mesh, mesh.signed_volume), np.eye(4), Orientations())


def with_region(placed, kind, corner, size):
    region = Region(kind, kind, mesh=box_mesh(corner, size))
    return replace(placed, part=replace(placed.part, regions=(region,)))


def test_the_face_in_the_air_needs_support_and_the_one_on_the_plate_does_not():
    found = measure_overhangs(table(), SupportRules())
    assert (found.faces_mm2, found.face_regions) == pytest.approx((200, 1))
    assert found.on_plate_mm2 == pytest.approx(200)
    assert found.steep_mm2 == pytest.approx(0)
    assert (found.edges_mm, found.tips, found.blocked_mm2, found.enforced_mm2) == (0, 0, 0, 0)


def test_a_lifted_part_needs_support_below_its_lowest_face():
    found = measure_overhangs(table(lift=3.0), SupportRules())
    assert (found.faces_mm2, found.face_regions, found.on_plate_mm2) == pytest.approx((400, 2, 0))


def test_a_blocker_takes_its_area_away():
    found = measure_overhangs(with_region(table(), "blocker", (15, -1, 5), (10, 30, 10)), SupportRules())
    assert found.faces_mm2 == pytest.approx(100, rel=0.05)
    assert found.faces_mm2 + found.blocked_mm2 == pytest.approx(200)


def test_an_enforcer_adds_downward_faces_that_are_steep_enough():
    slope = box_mesh((0, 0, 0), (10, 10, 10))
    vertices = slope.vertices.copy()
    vertices[(vertices[:, 2] > 5) & (vertices[:, 0] > 5), 0] += 5.0  # one side is inclined by 63 degrees
    part = Part("slope", Mesh(vertices, slope.triangles), 1250.0)
    placed = PlacedPart("slope", part, np.eye(4), Orientations())
    inclined = 10 * np.hypot(10, 5)
    plain = measure_overhangs(placed, SupportRules())
    assert (plain.faces_mm2, plain.steep_mm2) == pytest.approx((0, inclined))
    forced = measure_overhangs(with_region(placed, "enforcer", (-5, -5, -5), (30, 30, 30)), SupportRules())
    assert (forced.faces_mm2, forced.enforced_mm2) == pytest.approx((inclined, inclined))
    assert forced.steep_mm2 == pytest.approx(0, abs=1e-6)


def test_the_angle_of_the_part_takes_precedence():
    placed = table()
    own = replace(placed.part, overrides=replace(placed.part.overrides, overhang_angle_deg=30.0))
    assert measure_overhangs(replace(placed, part=own), SupportRules()).angle_deg == 30.0
