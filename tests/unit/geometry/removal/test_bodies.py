"""Bodies of several shapes."""

import numpy as np
from tests.shared.removal import box
from tests.shared.solids import arrays

from amprep.geometry.removal.bodies import CollisionShape, movable_body


def test_the_boxes_of_a_body_are_those_of_its_moved_shapes():
    shape = CollisionShape(*arrays(box((0, 0, 0), (1, 2, 3))))
    pose = np.array([[0.0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    body = movable_body([(shape, np.eye(4)), (shape, pose)])
    np.testing.assert_allclose(body.low, [[0, 0, 0], [3, 0, 0]])
    np.testing.assert_allclose(body.high, [[1, 2, 3], [5, 1, 3]])


def test_surfaces_have_both_sides():
    vertices, triangles = arrays(box((0, 0, 0), (1, 1, 1)))
    assert len(CollisionShape(vertices, triangles, is_solid=False).tree.triangles) == 2 * len(triangles)
