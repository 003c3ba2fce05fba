import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation
from tests.shared.examples import examples

from amprep.geometry.bounding.boxes.orientation import (
    about_z,
    angles_of,
    flat_rotation,
    hull_of,
    outline_of,
    smallest_box_about_z,
    smallest_box_rotation,
)


def box_volume(points, rotation):
    return float(np.prod(np.ptp(points @ rotation.T, axis=0)))


def turned_box(seed):
    """Corners of a box in a random orientation, with points inside."""
    rng = np.random.default_rng(seed)
    corners = np.array(np.meshgrid([0, 9], [0, 5], [0, 2], indexing="ij"), float).reshape(3, -1).T
    points = np.concatenate((corners, rng.random((20, 3)) * [9, 5, 2]))
    return points @ Rotation.random(rng=seed).as_matrix().T


@given(seed=st.integers(0, 10**6))
@examples(20)
def test_a_turned_box_gets_its_own_volume(seed):
    points = turned_box(seed)
    volume, rotation = smallest_box_rotation(hull_of(points))
    assert volume == pytest.approx(90)
    assert box_volume(points, rotation) == pytest.approx(90)
    assert np.linalg.det(rotation) == pytest.approx(1)


@given(seed=st.integers(0, 10**6), stretch=st.floats(0.05, 1))
@examples(15)
def test_no_box_with_a_face_along_a_face_of_the_hull_is_smaller(seed, stretch):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(14, 3)) * [1, stretch, 1]
    volume, rotation = smallest_box_rotation(hull_of(points))
    assert box_volume(points, rotation) == pytest.approx(volume)
    turns = Rotation.from_rotvec(np.linspace(0, np.pi / 2, 91)[:, None] * [0.0, 0, 1]).as_matrix()
    for normal in ConvexHull(points).equations[:, :3]:
        to_z = Rotation.align_vectors([[0, 0, 1]], [normal])[0].as_matrix()
        for turn in turns:
            assert box_volume(points, turn @ to_z) >= volume * (1 - 1e-9)


def test_a_coplanar_set_has_no_hull():
    assert hull_of(np.random.default_rng(0).random((9, 3)) * [1, 1, 0]) is None


@given(seed=st.integers(0, 10**6))
@examples(20)
def test_no_rotation_about_z_gives_a_smaller_box(seed):
    points = np.random.default_rng(seed).normal(size=(9, 3)) * [1, 0.3, 1]
    volume, rotation = smallest_box_about_z(points)
    assert box_volume(points, rotation) == pytest.approx(volume)
    assert rotation[2].tolist() == [0, 0, 1]
    for angle in np.linspace(0, np.pi / 2, 500):
        assert box_volume(points, about_z(angle)) >= volume * (1 - 1e-9)


def test_the_angles_of_a_square_are_one():
    square = outline_of(np.array([[0.0, 0], [2, 2], [0, 4], [-2, 2]]))
    assert angles_of(np.roll(square, -1, axis=0) - square) == pytest.approx([np.pi / 4])


def test_the_outline_of_points_on_a_line_is_its_ends():
    line = np.array([[1.0, 1], [0, 0], [3, 3], [2, 2]])
    assert sorted(outline_of(line).tolist()) == [[0, 0], [3, 3]]


@given(seed=st.integers(0, 10**6))
@examples(20)
def test_points_in_a_plane_are_laid_level_in_the_smallest_rectangle(seed):
    rectangle = np.array([[0, 0, 0], [9, 0, 0], [9, 5, 0], [0, 5, 0], [4, 2, 0]], float)
    turned = rectangle @ Rotation.random(rng=seed).as_matrix().T + 50
    rotation = flat_rotation(turned)
    assert np.linalg.det(rotation) == pytest.approx(1)
    assert sorted(np.ptp(turned @ rotation.T, axis=0)) == pytest.approx([0, 5, 9], abs=1e-9)


@pytest.mark.parametrize("points", [[[1, 2, 3]] * 3, [[0, 0, 0], [1, 2, 3], [2, 4, 6]]])
def test_points_on_a_line_or_alone_have_a_rotation(points):
    rotation = flat_rotation(np.array(points, float))
    assert np.allclose(rotation @ rotation.T, np.eye(3))
