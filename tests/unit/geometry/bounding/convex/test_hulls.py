"""Hulls contain their points with something to spare, and are closed meshes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.hulls import containing_hull
from amprep.geometry.bounding.convex.prepared import planes_of
from amprep.geometry.meshes.manifold import accepted, as_manifold

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


@given(st.integers(0, 10**6), st.sampled_from([0.0, 1e-12, 1e-6, 1e-3, 1.0]), st.sampled_from([0.0, 1e3]))
@examples(60)
def test_a_hull_contains_its_points_and_is_a_closed_mesh(seed, flatness, far):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 40)), 3)) * [10, 5, flatness] + far
    vertices, triangles = containing_hull(points)
    planes = planes_of(vertices)
    depth = planes[:, 3] - points @ planes[:, :3].T
    assert depth.min() >= 0.5e-6
    solid = as_manifold(vertices, triangles)
    assert accepted(solid)
    assert solid.volume() == pytest.approx(ConvexHull(vertices).volume, rel=1e-3, abs=0.0)


def test_a_hull_is_hardly_larger_than_its_points():
    vertices, triangles = containing_hull(CUBE)
    assert as_manifold(vertices, triangles).volume() == pytest.approx(1.0, abs=2e-5)
    assert len(vertices) == 8


@pytest.mark.parametrize("points", [CUBE[:4], CUBE[:2], CUBE[:1], np.repeat(CUBE[:1], 5, axis=0)])
def test_points_in_a_plane_on_a_line_or_alone_get_a_thin_hull(points):
    vertices, triangles = containing_hull(points)
    assert accepted(as_manifold(vertices, triangles))
    assert (vertices.min(axis=0) < points.min(axis=0)).all()
    assert (vertices.max(axis=0) > points.max(axis=0)).all()
