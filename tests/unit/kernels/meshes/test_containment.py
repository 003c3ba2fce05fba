"""Containment by winding numbers along vertical lines agrees with solid angles, and with manifold3d's balls."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples

from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.containment import inside


def winding_numbers(points, vertices, triangles):
    """Return winding numbers by the sum of signed solid angles (van Oosterom and Strackee 1983)."""
    corners = vertices[triangles][None] - points[:, None, None]
    length = np.linalg.norm(corners, axis=3)
    a, b, c = (corners[:, :, k] for k in range(3))
    numerator = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    denominator = (
        length.prod(axis=2)
        + np.einsum("ijk,ijk->ij", a, b) * length[..., 2]
        + np.einsum("ijk,ijk->ij", b, c) * length[..., 0]
        + np.einsum("ijk,ijk->ij", c, a) * length[..., 1]
    )
    return np.round(2.0 * np.arctan2(numerator, denominator).sum(axis=1) / (4 * np.pi))


@examples(20)
@given(st.integers(0, 10**6))
def test_points_are_inside_where_the_solid_angle_says_so(seed):
    rng = np.random.default_rng(seed)
    ball = Manifold.sphere(1.0, 8).rotate(rng.uniform(0, 90, 3).tolist())
    one, two = arrays_of(ball), arrays_of(ball.translate([0.7, 0.2, 0.1]))
    vertices = np.concatenate([one[0], two[0]])  # two shells that overlap: winding numbers up to 2
    triangles = np.concatenate([one[1], two[1] + len(one[0])])
    points = rng.uniform(-1.5, 2.0, (200, 3))
    expected = winding_numbers(points, vertices, triangles) > 0
    assert (inside(points, vertices, triangles) == expected).all()


def test_points_above_edges_and_corners_of_a_box_are_counted_once():
    vertices, triangles = arrays_of(Manifold.cube([2.0, 2.0, 2.0]))
    x, y, z = (each.ravel() for each in np.meshgrid([0.5, 1.0, 1.5], [0.5, 1.0, 1.5], [-1.0, 1.0, 3.0]))
    assert (inside(np.column_stack([x, y, z]), vertices, triangles) == (z == 1.0)).all()
