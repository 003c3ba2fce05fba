"""Candidate planes follow the faces at concave edges, and sections along the axes."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.convex_solids import SOLIDS, part_of

from amprep.geometry.bounding.convex.cells import cells_of
from amprep.geometry.bounding.convex.cutting_planes import candidate_planes, concave_faces


def faces_of(solid):
    mesh = part_of(solid).mesh
    return concave_faces(*mesh.arrays)


def test_the_concave_edge_of_an_angle_gives_its_two_planes():
    faces = faces_of(SOLIDS["angle"]())
    assert sorted(np.abs(faces.planes).round(6).tolist()) == [[0, 0, 1, 5], [1, 0, 0, 5]]
    assert faces.weight == pytest.approx([10.0, 10.0])
    assert faces.middle == pytest.approx(np.array([[5.0, 5, 5], [5, 5, 5]]))


@pytest.mark.parametrize("solid", [lambda: Manifold.cube([1, 2, 3]), lambda: Manifold.sphere(5, 40)])
def test_a_convex_solid_has_no_concave_faces(solid):
    assert len(faces_of(solid()).planes) == 0


def test_facets_of_a_smooth_concave_surface_are_left_out():
    bowl = Manifold.sphere(10, 128) - Manifold.sphere(10, 128).translate([0, 0, 8])
    rim_only = faces_of(bowl)
    assert len(rim_only.planes) < 2 * 0.1 * bowl.num_edge()


def test_candidates_cut_the_cell_and_count_the_sections():
    solid = SOLIDS["tee"]()
    cell = cells_of(solid)[0]
    found = candidate_planes(cell, faces_of(solid), 40.0, 4)
    assert len(found) > 12
    for normal, offset in found:
        height = cell.vertices @ normal - offset
        assert height.min() < 0.0 < height.max()
        assert np.linalg.norm(normal) == pytest.approx(1.0)
