"""Directions spread over the sphere, and from flat faces."""

import numpy as np
from scipy.spatial import KDTree

from amprep.geometry.bounding.boxes.orientation import hull_of
from amprep.geometry.orientation.directions import (
    around,
    distinct,
    flat_face_directions,
    hull_directions,
    sphere_directions,
)


def test_directions_cover_the_sphere_evenly():
    found = sphere_directions(1000)
    assert np.allclose(np.linalg.norm(found, axis=1), 1.0)
    random = np.random.default_rng(1).normal(size=(5000, 3))
    distance, _ = KDTree(found).query(random / np.linalg.norm(random, axis=1, keepdims=True))
    # a hexagonal lattice of 1000 points has a covering radius of 3.9 degrees
    assert np.degrees(np.max(distance)) < 5.5
    assert abs(found.sum(axis=0)).max() < 1.0


def test_faces_of_a_hull_come_by_area_and_point_up_when_they_are_down():
    corners = np.array([[x, y, z] for x in (0, 4) for y in (0, 3) for z in (0, 1)], float)
    hull = hull_of(corners)
    assert hull is not None
    found = hull_directions(hull, 4)
    # the faces of 12 mm2 come first, then those of 4 mm2
    assert sorted(map(tuple, found[:2].tolist())) == [(0, 0, -1), (0, 0, 1)]
    assert sorted(map(tuple, found[2:].tolist())) == [(0, -1, 0), (0, 1, 0)]


def test_triangles_in_one_plane_count_together():
    cross = np.array([[0, 0, 2.0], [0, 0, 2.0], [3.0, 0, 0], [0, 0, 0]])
    assert flat_face_directions(cross, 1).tolist() == [[0.0, 0.0, -1.0]]


def test_nearly_equal_directions_are_one_and_the_first_stays():
    near = np.array([[0.0, 0.0, 1.0], [1e-5, 0.0, 1.0], [1.0, 0.0, 0.0]])
    assert distinct(near).tolist() == [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]


def test_directions_around_one_have_its_angle():
    centre = np.array([0.6, 0.0, 0.8])
    ring = around(centre, 10.0, 8)
    assert np.allclose(np.degrees(np.arccos(ring @ centre)), 10.0)
    assert np.allclose(np.linalg.norm(ring, axis=1), 1.0)
