"""Overlapping shells are united, cavities remain."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import arrays, nested_balls

from amprep.geometry.bounding.simplification.solids import hull, hull_volume, united, without_overlaps
from amprep.geometry.meshes.manifold import as_manifold


def joined(*meshes):
    starts = np.cumsum([0, *[len(vertices) for vertices, _ in meshes]])
    triangles = [mesh[1] + start for mesh, start in zip(meshes, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(triangles)


def test_shells_that_overlap_are_united():
    cube = Manifold.cube([2, 2, 2])
    mesh = joined(arrays(cube), arrays(cube.translate([1, 0, 0])))
    assert as_manifold(*without_overlaps(mesh)).volume() == pytest.approx(12.0)


def test_shells_that_do_not_overlap_are_left_alone():
    for mesh in (arrays(nested_balls()), arrays(Manifold.cube([1, 2, 3]))):
        assert without_overlaps(mesh) is mesh


def test_hull_and_union_have_the_volume_of_the_solids():
    cube = Manifold.cube([1, 1, 1])
    both = joined(arrays(cube), arrays(cube.translate([4, 0, 0])))
    assert as_manifold(*hull(both)).volume() == pytest.approx(5.0)
    assert hull_volume(both) == pytest.approx(5.0)
    assert as_manifold(*united(arrays(cube), arrays(cube.translate([0.5, 0, 0])))).volume() == pytest.approx(
        1.5
    )


def test_nothing_is_outside_the_hull():
    points = np.random.default_rng(5).normal(size=(3000, 3)).astype(np.float32).astype(float)
    points *= 50 / np.linalg.norm(points, axis=1)[:, None]
    vertices, triangles = hull((points, np.empty((0, 3), np.int64)))
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    assert (points @ normal.T - (normal * a).sum(axis=1) <= 1e-9 * np.linalg.norm(normal, axis=1)).all()
