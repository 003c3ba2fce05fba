"""Rays agree with a box whose openings are known."""

import numpy as np
from tests.shared.solids import mesh_of
from tests.shared.supported import box

from amprep.kernels.meshes.line_of_sight import look_outside

AXES = np.concatenate([np.eye(3), -np.eye(3)])


def seen(points, solid, directions=AXES):
    mesh = mesh_of(solid)
    sees = np.zeros(len(points), np.bool_)
    look_outside(
        np.asarray(points, float), directions, np.ascontiguousarray(mesh.vertices[mesh.triangles]), sees
    )
    return sees.tolist()


def test_a_point_sees_the_outside_only_through_an_opening():
    shell = box((10, 10, 10), (0, 0, 0)) - box((8, 8, 8), (1, 1, 1))
    assert seen([(5, 5.1, 5.2), (20, 0.1, 0.2)], shell) == [False, True]
    opened = shell - box((1, 1, 5), (4.5, 4.6, 7))
    assert seen([(5, 5.1, 5.2), (3, 3.1, 3.2)], opened) == [True, False]


def test_only_the_given_directions_count():
    opened = box((10, 10, 10), (0, 0, 0)) - box((8, 8, 8), (1, 1, 1)) - box((2, 2, 5), (4, 4, 7))
    assert seen([(5, 5.1, 5.2)], opened, AXES[:1]) == [False]
    assert seen([(5, 5.1, 5.2)], opened, AXES[2:3]) == [True]
