"""Figures of meshes whose shape is known by hand."""

import numpy as np
import pytest
import trimesh
from tests.shared.builds import box_mesh

from amprep.measures.contents import measure_contents
from amprep.model import Mesh, Part
from amprep.model.mesh import join_meshes
from amprep.pipeline.reading import repair_part

CUBE = box_mesh((0, 0, 0), (10, 10, 10))


def contents(mesh):
    return measure_contents(repair_part(Part("part", mesh, 0.0), allow_surface=True))


def test_a_box_has_its_size_volume_area_and_no_handle():
    found = contents(box_mesh((1, 2, 3), (10, 20, 30)))
    assert found.size_mm == pytest.approx((10, 20, 30))
    assert found.low_mm == pytest.approx((1, 2, 3))
    assert (found.volume_mm3, found.area_mm2) == (pytest.approx(6000), pytest.approx(2200))
    assert (found.triangles, found.vertices, found.bodies, found.cavities, found.genus) == (12, 8, 1, 0, 0)
    assert (found.open_edges, found.nonmanifold_edges, found.overlap_mm3) == (0, 0, 0.0)


def test_a_torus_has_one_handle_and_two_tori_have_two():
    ring = trimesh.creation.torus(10, 3)
    one = Mesh(ring.vertices, ring.faces)
    other = Mesh(ring.vertices + [50, 0, 0], ring.faces)
    assert contents(one).genus == 1
    both = contents(join_meshes([one, other]))
    assert (both.genus, both.bodies) == (2, 2)


def test_a_void_is_a_cavity_and_an_overlap_counts_once():
    inner = box_mesh((3, 3, 3), (4, 4, 4))
    hollow = contents(join_meshes([CUBE, Mesh(inner.vertices, inner.triangles[:, ::-1])]))
    assert (hollow.bodies, hollow.cavities, hollow.genus) == (1, 1, 0)
    assert hollow.volume_mm3 == pytest.approx(936)
    crossing = contents(join_meshes([CUBE, box_mesh((5, 5, 5), (10, 10, 10))]))
    assert crossing.overlap_mm3 == pytest.approx(125)


def test_a_box_without_a_triangle_is_a_surface_with_three_open_edges():
    found = contents(Mesh(CUBE.vertices, CUBE.triangles[1:]))
    assert (found.open_edges, found.volume_mm3, found.genus, found.bodies) == (3, None, None, 1)


def test_boxes_that_share_an_edge_touch_one_another_there():
    found = contents(join_meshes([CUBE, box_mesh((10, 10, 0), (10, 10, 10))]))
    assert found.nonmanifold_edges == 1
    assert found.bodies == 2
    assert np.isclose(found.volume_mm3, 2000)
