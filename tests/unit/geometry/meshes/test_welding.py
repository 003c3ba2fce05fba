"""Welding unites solids that touch in equal faces and rounds coordinates as files store them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from manifold3d import Manifold

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.meshes.welding import cancel_opposite, merge_vertices, round_as_stored, weld

CUBE = arrays_of(Manifold.cube([1.0, 1.0, 1.0]))


def together(*meshes):
    counts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    triangles = [faces + first for (_, faces), first in zip(meshes, counts[:-1], strict=True)]
    return np.concatenate([points for points, _ in meshes]), np.concatenate(triangles)


def moved(mesh, shift):
    """Return the mirror image of a cube at x = 1/2, moved: then both cubes split their common face alike."""
    points, triangles = mesh
    return points * (-1.0, 1.0, 1.0) + shift, triangles[:, ::-1]


def test_two_cubes_that_share_a_face_become_one_solid_without_it():
    points, triangles = weld(*together(CUBE, moved(CUBE, (2.0, 0.0, 0.0))))
    assert (len(points), len(triangles)) == (12, 20)
    solid = as_manifold(points, triangles)
    assert accepted(solid)
    assert solid.volume() == pytest.approx(2.0)


def test_a_shift_below_the_lattice_is_merged_and_a_larger_one_is_not():
    near = together(CUBE, moved(CUBE, (2.0 + 1e-6, 0.0, 0.0)))
    far = together(CUBE, moved(CUBE, (2.0 + 1e-3, 0.0, 0.0)))
    assert len(weld(*near)[0]) == 12
    assert len(weld(*far)[0]) == 16
    assert len(weld(*near, lattice=0.0)[0]) == 16


def test_opposite_triangles_cancel_and_of_equal_ones_the_first_stays():
    a, b = [0, 1, 2], [2, 1, 0]
    assert cancel_opposite(np.array([a, b])).tolist() == [False, False]
    assert cancel_opposite(np.array([a, [1, 2, 0], b])).tolist() == [True, False, False]
    assert cancel_opposite(np.array([b, [0, 2, 1]])).tolist() == [True, False]
    assert cancel_opposite(np.array([[0, 0, 1], a])).tolist() == [False, True]


@given(arrays(np.float64, st.tuples(st.integers(1, 9), st.just(3)), elements=st.floats(-1e4, 1e4)))
def test_rounding_is_idempotent_and_close(points):
    once = round_as_stored(points)
    assert np.array_equal(round_as_stored(once), once)
    assert np.abs(once - points).max() <= 5e-7 + 1e4 * 2.0**-24


def test_merged_vertices_keep_the_first_of_each_place():
    points = np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [1.0 + 1e-5, 1.0, 1.0]])
    merged, triangles = merge_vertices(points, np.array([[0, 1, 2]]))
    assert merged.tolist() == [[1, 1, 1], [0, 0, 0]]
    assert triangles.tolist() == [[0, 1, 0]]
