"""Travel and turn inside the walls agree with the vertices at small steps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from tests.shared.examples import examples
from tests.shared.triangles import KINDS, arrays, placed, random_direction, random_pose, shift, some_solid

from amprep.geometry.trees.build_volume import build_walls, travel_inside, turn_inside
from amprep.geometry.trees.collision_mesh import collision_mesh

SIZE = np.array([40.0, 40.0, 30.0])
HERE = np.eye(4)
X, Y, Z = np.eye(3)


def outside(points, *, cylinder, margin):
    """How far the outermost point is outside, mm; positive if any is."""
    gaps = [margin - points[:, 2], points[:, 2] - SIZE[2] + margin]
    if cylinder:
        gaps.append(np.linalg.norm(points[:, :2] - 20.0, axis=1) - 20.0 + margin)
    else:
        gaps += [margin - points[:, 0], points[:, 0] - 40.0 + margin]
        gaps += [margin - points[:, 1], points[:, 1] - 40.0 + margin]
    return max(gap.max() for gap in gaps)


def turned(points, about, direction, angle):
    return (points - about) @ Rotation.from_rotvec(angle * direction).as_matrix().T + about


@given(st.sampled_from(KINDS), st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from([0.0, 1.5]))
@examples(40)
def test_travel_inside_begins_and_ends_at_a_wall(kind, seed, cylinder, margin):
    rng = np.random.default_rng(seed)
    solid = some_solid(kind, rng)
    body, pose = collision_mesh(*arrays(solid)), shift(20, 20, 15) @ random_pose(rng, 12.0)
    direction = random_direction(rng)
    points = placed(arrays(solid)[0], pose)
    walls = build_walls(SIZE, is_cylinder=cylinder)
    ((first, last),) = travel_inside(body, pose, direction, walls, margin)
    for travel in np.linspace(-80, 80, 400):
        inside = outside(points + travel * direction, cylinder=cylinder, margin=margin) <= 0
        if abs(travel - first) > 1e-6 and abs(travel - last) > 1e-6:
            assert inside == (first <= travel <= last)
    if first <= last:
        for end in (first, last):
            assert outside(points + end * direction, cylinder=cylinder, margin=margin) == pytest.approx(
                0.0, abs=1e-9
            )


@given(st.sampled_from(KINDS), st.integers(0, 2**32 - 1), st.booleans(), st.booleans())
@examples(60)
def test_a_turn_inside_ends_at_a_wall(kind, seed, cylinder, upright):
    rng = np.random.default_rng(seed)
    solid = some_solid(kind, rng)
    body, pose = collision_mesh(*arrays(solid)), shift(20, 20, 15) @ random_pose(rng, 8.0)
    about, direction = rng.uniform(0, 40, 3), (Z if upright else random_direction(rng))
    points = placed(arrays(solid)[0], pose)
    walls = build_walls(SIZE, is_cylinder=cylinder)
    if outside(points, cylinder=cylinder, margin=0.5) > 1e-6:
        assert turn_inside(body, pose, (about, direction), walls, 0.5)[0] == 0.0
        return
    (angle,) = turn_inside(body, pose, (about, direction), walls, 0.5)
    for fraction in np.linspace(0, 1, 50):
        assert (
            outside(turned(points, about, direction, fraction * angle), cylinder=cylinder, margin=0.5) <= 1e-6
        )
    if angle < 2 * np.pi:
        beyond = turned(points, about, direction, angle + 1e-4)
        assert outside(beyond, cylinder=cylinder, margin=0.5) > -1e-6


@pytest.mark.parametrize("cylinder", [False, True])
def test_a_body_at_a_wall_may_slide_and_leave_but_not_pass(cylinder):
    body = collision_mesh(*arrays(Manifold.cube((2, 2, 2), True)))
    walls = build_walls(SIZE, is_cylinder=cylinder)
    for error in (-1e-9, 0.0, 1e-9):
        low = shift(20, 20, 1 - error)
        assert travel_inside(body, low, -Z, walls)[0] == pytest.approx([-28, 0], abs=1e-8)
        assert travel_inside(body, low, X, walls)[0, 1] > 15
        assert travel_inside(body, low, Z, walls)[0] == pytest.approx([0, 28], abs=1e-8)
        assert turn_inside(body, low, ([20, 20, 1], Z), walls)[0] == 2 * np.pi
        assert turn_inside(body, low, ([20, 20, 1], X), walls)[0] < 1e-8


def test_a_body_that_is_too_large_is_never_inside():
    body = collision_mesh(*arrays(Manifold.cube((41, 2, 2), True)))
    first, last = travel_inside(body, shift(20, 20, 15), Z, build_walls(SIZE))[0]
    assert first > last


def test_a_bar_turns_in_a_box_until_its_corner_meets_the_wall():
    body = collision_mesh(*arrays(Manifold.cube((36, 2, 2), True)))
    at = shift(20, 20, 1.5)
    (angle,) = turn_inside(body, at, ([20, 20, 1.5], Y), build_walls(SIZE))
    assert 18 * np.sin(angle) + np.cos(angle) == pytest.approx(1.5, abs=1e-9)
