"""Quick figures of many directions, beside those of the exact search."""

import numpy as np
import pytest
import trimesh
from scipy.stats import spearmanr
from tests.shared.overhang_shapes import block, bore, box, rod

from amprep.geometry.bounding.boxes.orientation import upright_rotation
from amprep.geometry.orientation.directions import sphere_directions
from amprep.geometry.orientation.quick_figures import carried_fractions, quick_figures
from amprep.geometry.orientation.surface import turnable_surface
from amprep.geometry.overhangs.carried.points import Limits
from amprep.model.mesh import Mesh
from amprep.model.orientation import OrientationRules
from amprep.model.part import Part
from amprep.model.supports.rules import SupportRules
from amprep.orienting.candidates import turnable_part
from amprep.orienting.measure import measure_orientation

UP = np.array([[0.0, 0.0, 1.0]])
BY_ANGLE = Limits(45.0, 0.0, 0.0, 0.0, 0.001, 0.04)
METAL = Limits(45.0, 1.0, 2.0, 8.0, 0.06, 0.04)


def table():
    """A top of 20 x 20 x 2 mm, its lower side at 10 mm, on a leg of 4 x 4 mm."""
    top = trimesh.creation.box(bounds=[[-10, -10, 10], [10, 10, 12]])
    return trimesh.boolean.union([top, trimesh.creation.box(bounds=[[-2, -2, 0], [2, 2, 11]])])


def slot(width):
    """What is cut away for a slot along y, 10 mm high."""
    return box((width, 60, 20), (-width / 2, -30, -10))


def surface_of(solid):
    if isinstance(solid, trimesh.Trimesh):
        return turnable_surface(solid.vertices, solid.faces)
    mesh = solid.to_mesh()
    return turnable_surface(mesh.vert_properties[:, :3], mesh.tri_verts)


def test_area_and_shadow_of_a_table_are_those_of_its_top():
    found = quick_figures(surface_of(table()), UP, BY_ANGLE, lift=0.0)
    assert found.height == pytest.approx([12])
    assert found.overhang == pytest.approx([400 - 16])
    assert found.shadow == pytest.approx([3840])
    assert found.edge_length.tolist() == [0.0]


def test_the_lift_has_supports_below_everything():
    found = quick_figures(surface_of(table()), UP, BY_ANGLE, lift=3.0)
    assert found.overhang == pytest.approx([400])
    assert found.shadow == pytest.approx([384 * 13 + 16 * 3])


def test_a_tilted_box_has_knife_edges():
    box = trimesh.creation.box(bounds=[[0, 0, 0], [10, 10, 10]])
    angle = np.radians(45)
    found = quick_figures(surface_of(box), np.array([[np.sin(angle), 0, np.cos(angle)]]), BY_ANGLE, lift=2.0)
    # exactly at the overhang angle no face is an overhang; the lowest edge is 10 mm long and level
    assert (found.overhang[0], found.edge_length[0]) == (0.0, pytest.approx(10))
    assert found.edge_shadow == pytest.approx([20])


def test_an_enforced_face_counts_at_any_angle():
    wall = trimesh.creation.box(bounds=[[0, 0, 0], [1, 10, 10]])
    surface = surface_of(wall)
    steep = np.radians(60)
    up = np.array([[-np.cos(steep), 0.0, np.sin(steep)]])
    normal = surface.normals @ up[0]
    mask = (normal < -0.1) & (np.abs(surface.normals[:, 0]) > 0.9)
    kept = quick_figures(surface, up, BY_ANGLE, lift=5.0, enforced=mask)
    assert kept.overhang[0] - quick_figures(surface, up, BY_ANGLE, lift=5.0).overhang[0] == pytest.approx(100)


@pytest.mark.parametrize(("diameter", "carried"), [(7.5, True), (12.0, False)])
def test_the_part_carries_small_bores(diameter, carried):
    surface = surface_of(bore(diameter))
    fraction = carried_fractions(surface, METAL)
    middle = surface.points[surface.triangles].mean(axis=1)
    ceiling = (surface.normals[:, 2] < -0.9) & (middle[:, 2] > 1.0)
    assert ceiling.any()
    assert (fraction[ceiling].mean() > 0.9) == carried


def test_the_part_carries_short_ledges_bridges_and_no_more():
    solid = block() - slot(1.8)
    surface = surface_of(solid)
    middle = surface.points[surface.triangles].mean(axis=1)
    ceiling = (surface.normals[:, 2] < -0.9) & (middle[:, 2] > 1.0)
    assert carried_fractions(surface, METAL)[ceiling].min() == 1.0
    wide = surface_of(block() - slot(9.0))
    middle = wide.points[wide.triangles].mean(axis=1)
    ceiling = (wide.normals[:, 2] < -0.9) & (middle[:, 2] > 1.0)
    # 1 mm on both sides of 9 mm
    assert wide.areas[ceiling] @ carried_fractions(wide, METAL)[ceiling] < 0.4 * wide.areas[ceiling].sum()


def test_quick_figures_rank_directions_as_the_exact_search():
    solid = block() - rod(6.0, 60).translate((0, 0, 22)) - slot(9.0)
    mesh = solid.to_mesh()
    part = Part("block", Mesh(mesh.vert_properties[:, :3], mesh.tri_verts), 1.0)
    rules = SupportRules(rules="limits", ledge_mm=1.0, bridge_mm=2.0, bore_mm=8.0, plate_mm=0.06)
    turnable = turnable_part(part, rules, 0.0, OrientationRules())
    directions = sphere_directions(14)
    quick = turnable.figures(directions)
    exact = [measure_orientation(part, upright_rotation(each), rules, 0.0) for each in directions]
    assert spearmanr(quick.overhang, [each.overhang_mm2 for each in exact])[0] > 0.9
    assert spearmanr(quick.shadow, [each.shadow_mm3 for each in exact])[0] > 0.9
