"""The area of thin walls on solids whose walls are known by hand."""

import numpy as np
import pytest
import trimesh
from tests.shared.builds import box_mesh

from amprep.measures.thin_walls import measure_thin_walls
from amprep.model import Mesh
from amprep.model.mesh import join_meshes


def areas(mesh, *thicknesses):
    return [wall.area_mm2 for wall in measure_thin_walls(mesh, thicknesses)]


def test_both_faces_of_a_sheet_are_above_a_thin_wall_and_its_rim_is_not():
    sheet = box_mesh((0, 0, 0), (20, 30, 0.5))
    assert areas(sheet, 0.4, 0.5, 0.6) == pytest.approx([0, 0, 2 * 600], abs=30)


def test_a_ball_is_as_thick_as_its_diameter():
    ball = trimesh.creation.icosphere(subdivisions=3, radius=5)
    thin = areas(Mesh(ball.vertices, ball.faces), 9.0, 10.5)
    assert thin == [0.0, pytest.approx(ball.area)]


def test_a_wall_with_another_one_behind_it_stays_thin():
    sheets = join_meshes([box_mesh((0, 0, 0), (20, 20, 0.3)), box_mesh((0, 0, 0.5), (20, 20, 9.5))])
    assert areas(sheets, 0.4, 0.8)[1] == pytest.approx(2 * 400, rel=0.05)


def test_a_wedge_is_thin_as_far_as_its_height_is():
    """A wedge rises from 0 to 10 mm over 100 mm: below 1 mm the tenth part of its lower face is thin."""
    vertices = np.array([[0, 0, 0], [100, 0, 0], [100, 0, 10], [0, 20, 0], [100, 20, 0], [100, 20, 10.0]])
    triangles = [[0, 1, 2], [3, 5, 4], [0, 3, 1], [1, 3, 4], [1, 4, 2], [2, 4, 5], [0, 2, 3], [2, 5, 3]]
    (area,) = areas(Mesh(vertices, triangles), 1.0)
    slope = np.hypot(10, 1)
    assert area == pytest.approx(20 * 10 + 20 * slope, rel=0.15)
