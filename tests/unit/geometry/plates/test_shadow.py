"""Shadows are the projections that manifold3d computes, also of surfaces, and in little time."""

import time

import numpy as np
import pytest
from manifold3d import CrossSection, FillRule, Manifold
from tests.shared.solids import arrays, gear, gyroid, thread

from amprep.geometry.plates.shadow import shadow_of, silhouette_walks


def difference(one, other):
    return (one - other).area() + (other - one).area()


@pytest.mark.parametrize("make", [gear, thread, gyroid])
def test_the_shadow_of_a_solid_is_its_projection(make):
    solid = make().rotate([20.0, 35.0, 10.0])
    assert difference(shadow_of(*arrays(solid)), solid.project()) < 1e-3 * solid.project().area()


def test_the_shadow_of_a_surface_is_the_union_of_its_triangles():
    rng = np.random.default_rng(5)
    points, triangles = rng.uniform(0, 10, (12, 3)), rng.permutation(12).reshape(4, 3)
    each = [points[corners][:, :2] for corners in triangles]
    united = CrossSection([t if _is_left(t) else t[::-1] for t in each], FillRule.Positive)
    assert difference(shadow_of(points, triangles), united) < 1e-5


def _is_left(t):
    return np.linalg.det(t[1:] - t[0]) > 0.0


def test_a_hole_through_the_part_is_a_hole_of_the_shadow():
    tube = Manifold.cylinder(5, 10, 10, 64) - Manifold.cylinder(5, 6, 6, 64)
    assert len(shadow_of(*arrays(tube)).to_polygons()) == 2


def test_many_triangles_leave_few_edges_and_take_little_time():
    sphere = Manifold.sphere(10.0, 640)
    vertices, triangles = arrays(sphere)
    assert len(triangles) > 200_000
    before = time.process_time()
    shadow = shadow_of(vertices, triangles)
    assert time.process_time() - before < 2.0
    assert shadow.area() == pytest.approx(np.pi * 100.0, rel=1e-3)
    assert sum(map(len, silhouette_walks(vertices[:, :2], triangles))) < 0.02 * len(triangles)
