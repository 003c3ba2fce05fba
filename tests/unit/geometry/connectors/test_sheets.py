"""Walls without thickness rise to the lowest face above them, and enter it by the overlap."""

import numpy as np
import pytest

from amprep.geometry.connectors.columns import ConnectorColumns, clip_to_columns
from amprep.geometry.connectors.sheets import join_sheets, plan_segments, raise_sheets

OVERLAP = 0.1
COLUMN = ConnectorColumns(
    np.array([[0.0, 0.0, 1.0]]),
    np.array([[2.0, 2.0, 20.0]]),
    np.zeros((1, 2), np.int64),
    np.array([0.0, 0.0, 2.0]),
    (1, 1),
)
SEGMENT = np.array([[[0.0, 1.0], [2.0, 1.0]]])


def face(height, x0=0.0, x1=2.0):
    """Return two triangles that face down between two x; `height` is a function of x."""
    a, b = (x0, 0.0, height(x0)), (x1, 0.0, height(x1))
    c, d = (x1, 2.0, height(x1)), (x0, 2.0, height(x0))
    return np.array([[a, c, b], [a, d, c]])


def patches(*faces):
    corners = np.concatenate(faces)
    return clip_to_columns(COLUMN, corners, np.arange(len(corners)), np.array([True]))


def raised(supported, surface):
    return raise_sheets(COLUMN, np.array([0]), SEGMENT, supported, surface, overlap=OVERLAP)


def area(mesh):
    corners = mesh[0][mesh[1]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(normal, axis=1).sum() / 2


def test_a_wall_below_a_level_face_has_its_height_and_the_overlap():
    own = patches(face(lambda x: 5.0))
    points, triangles = raised(own, own)
    assert points[:, 2].min() == 1.0
    assert points[:, 2].max() == pytest.approx(5.0 + OVERLAP)
    assert area((points, triangles)) == pytest.approx(2.0 * (4.0 + OVERLAP))


def test_a_wall_follows_a_sloping_face():
    own = patches(face(lambda x: 4.0 + x))
    assert area(raised(own, own)) == pytest.approx(2.0 * (4.0 + OVERLAP))


def test_a_face_below_the_supported_one_stops_the_wall():
    upper, lower = face(lambda x: 8.0), face(lambda x: 5.0, 0.0, 1.0)
    both = patches(upper, lower)
    assert area(raised(both, both)) == pytest.approx(1.0 * (4.0 + OVERLAP) + 1.0 * (7.0 + OVERLAP))
    assert area(raised(patches(upper), both)) == pytest.approx(7.0 + OVERLAP), (
        "nothing rises below an obstacle"
    )


def test_the_lower_edges_of_a_template_are_its_segments():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], float)
    segments = plan_segments(points, np.array([[0, 1, 2], [0, 2, 3]]))
    assert segments.tolist() == [[[0, 0], [1, 0]]]


def test_joined_walls_share_vertices_and_repeat_no_triangle():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], float)
    one = points, np.array([[0, 1, 2], [0, 2, 3]])
    other = points + (1.0, 0.0, 0.0), one[1]
    merged, triangles = join_sheets([one, other, one])
    assert (len(merged), len(triangles)) == (6, 4)
