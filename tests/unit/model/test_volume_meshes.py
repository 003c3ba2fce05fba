"""Bounding volumes as meshes for pictures: closed, outward, and of the same volume."""

import numpy as np
import pytest

from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.model import Boxes, ConvexPieces, Solid
from amprep.model.volume_meshes import box_mesh, meshes_of


def test_each_box_becomes_a_closed_mesh_with_outward_normals():
    lo, hi = np.array([[0, 0, 0], [5, 5, 5.0]]), np.array([[1, 2, 3], [9, 9, 9.0]])
    for mesh, low, high in zip(meshes_of(Boxes(lo, hi)), lo, hi, strict=True):
        solid = as_manifold(*mesh.arrays)
        assert accepted(solid)
        assert solid.volume() == pytest.approx(np.prod(high - low))
        np.testing.assert_array_equal(mesh.bounds, (low, high))


def test_pieces_and_solids_are_shown_as_they_are():
    cube = box_mesh(np.zeros(3), np.ones(3))
    assert meshes_of(ConvexPieces((cube, cube))) == (cube, cube)
    assert meshes_of(Solid(cube)) == (cube,)
