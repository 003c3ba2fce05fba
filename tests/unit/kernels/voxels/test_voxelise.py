"""Voxel centres are inside a solid where its planes say so, and elements meet the voxels that hold points of them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples

from amprep.geometry.merging.union import arrays_of
from amprep.kernels.voxels.voxelise import count_crossings, mark_elements, mark_interior

PITCH, STEP, SHAPE = 0.5, 0.4, (8, 7, 9)


def centres():
    z, y, x = np.indices(SHAPE) + 0.5
    return np.stack([x * PITCH, y * PITCH, z * STEP], axis=-1).reshape(-1, 3)


@examples(30)
@given(st.integers(0, 10**6))
def test_the_centres_of_marked_voxels_are_inside_the_solid(seed):
    rng = np.random.default_rng(seed)
    cloud = rng.uniform(-0.5, 4.0, (8, 3))  # the solid may reach out of the block of voxels
    solid = Manifold.hull_points(cloud)
    points, triangles = arrays_of(solid)
    change, marks = np.zeros(SHAPE, np.int16), np.full(SHAPE, 9, np.int32)
    count_crossings(points, triangles, PITCH, STEP, change)
    mark_interior(change, marks)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    behind = ((centres()[:, None] - corners[None, :, 0]) * normal[None]).sum(axis=2) <= 0
    assert ((marks.ravel() == 0) == behind.all(axis=1)).all()


@examples(15)
@given(st.integers(0, 10**6))
def test_an_element_meets_the_voxels_in_which_it_has_points_and_the_smallest_label_counts(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.3, 4.5, (6, 3))
    elements, labels = np.array([[0, 1, 2], [3, 4, 4], [5, 5, 5]]), np.array([2, 1, 0], np.int32)
    marks = np.full(SHAPE, 9, np.int32)
    mark_elements(points, elements, labels, PITCH, STEP, 0.0, 0.0, True, marks)
    steps = np.linspace(0, 1, 40)
    weights = np.array([(a, b, 1 - a - b) for a in steps for b in steps if a + b <= 1 + 1e-12])
    size = np.array([PITCH, PITCH, STEP])
    lower = np.full(SHAPE, 9, np.int32)
    for element, label in zip(elements, labels, strict=True):
        voxels = np.floor(weights @ points[element] / size).astype(int)
        voxels = voxels[((voxels >= 0) & (voxels < SHAPE[::-1])).all(axis=1)]
        np.minimum.at(lower, tuple(voxels[:, ::-1].T), label)
        near = (np.abs(centres()[:, None] - (weights @ points[element])[None]) <= size / 2 + 0.15).all(axis=2)
        assert near.any(axis=1)[marks.ravel() == label].all(), "a marked voxel is near a point of the element"
    assert (marks <= lower).all(), "a voxel with a point of an element is marked"
