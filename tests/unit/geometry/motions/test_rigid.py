"""The rigid motion between the corners of two bodies."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from amprep.geometry.motions.rigid import angle_deg, displacement, find_motion, largest_distance

POINTS = np.random.default_rng(1).uniform(-50.0, 50.0, (40, 3))
FLAT = POINTS * (1.0, 1.0, 0.0)
vectors = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


def motion_of(turn, shift):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = Rotation.from_rotvec(turn).as_matrix(), shift
    return matrix


@given(turn=vectors, shift=vectors, points=st.sampled_from([POINTS, FLAT]))
def test_every_motion_is_found_again_also_of_points_in_a_plane(turn, shift, points):
    motion = motion_of(turn, 100.0 * np.array(shift))
    after = points @ motion[:3, :3].T + motion[:3, 3]
    found = find_motion(points, after)
    assert np.abs(found - motion).max() < 1e-9
    assert largest_distance(found, points, after) < 1e-9


@pytest.mark.parametrize("scale", [(1.001, 1.001, 1.001), (-1.0, 1.0, 1.0), (1.0, 1.0, 1.1)])
def test_scaled_and_mirrored_points_have_no_rigid_motion(scale):
    assert find_motion(POINTS, POINTS * scale) is None


def test_rounding_of_files_is_granted_and_more_is_not():
    noise = np.zeros((40, 3))
    noise[7] = 0.0, 0.0, 0.0009
    assert find_motion(POINTS, POINTS + noise) is not None
    assert find_motion(POINTS, POINTS + 3.0 * noise) is None


@pytest.mark.parametrize("degrees", [0.0, 0.01, 30.0, 90.0, 179.9])
def test_the_angle_of_a_motion_is_that_of_its_rotation(degrees):
    motion = motion_of(np.radians(degrees) * np.array([0.0, 0.6, 0.8]), (5.0, 0.0, 0.0))
    assert angle_deg(motion) == pytest.approx(degrees, abs=1e-9)


def test_the_displacement_is_that_of_the_corner_that_moves_most():
    box = (np.zeros(3), np.array([10.0, 20.0, 5.0]))
    half = motion_of((0.0, 0.0, np.pi), (0.0, 0.0, 0.0))
    assert displacement(box, np.eye(4), half) == pytest.approx(2.0 * np.hypot(10.0, 20.0))
