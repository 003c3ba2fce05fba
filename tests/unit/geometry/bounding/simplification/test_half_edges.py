"""Half-edges of meshes, also of those whose surfaces touch."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import PRINTABLE, arrays

from amprep.geometry.bounding.simplification.half_edges import make_half_edges


@pytest.mark.parametrize("name", PRINTABLE)
def test_opposite_half_edges_join_the_same_points_in_reverse(name):
    surface = make_half_edges(*arrays(PRINTABLE[name]()))
    start, opposite = surface.start, surface.opposite
    end = np.roll(start.reshape(-1, 3), -1, axis=1).ravel()
    assert np.array_equal(opposite[opposite], np.arange(len(start)))
    assert np.array_equal(end, start[opposite])
    assert np.array_equal(start[surface.leaving], np.arange(len(surface.points)))


def test_a_corner_that_two_cubes_share_becomes_two_vertices():
    solid = Manifold.cube([1, 1, 1])
    one, triangles = arrays(solid)
    both, number = np.unique(np.concatenate([one, one + 1.0]), axis=0, return_inverse=True)
    assert len(both) == 15
    surface = make_half_edges(both, number[np.concatenate([triangles, triangles + 8])])
    assert len(surface.points) == 16
