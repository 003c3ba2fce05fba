"""Rotational distances are the first angles at which triangles meet or come within the margin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from tests.shared.examples import examples
from tests.shared.triangles import (
    SCENES,
    arrays,
    corners,
    crossings,
    least_distance,
    placed,
    random_direction,
    random_pose,
    shift,
    some_solid,
)

from amprep.geometry.trees.collision_mesh import collision_mesh
from amprep.geometry.trees.queries import rotational_distances, surfaces_collide

HERE = np.eye(4)
X, Y, Z = np.eye(3)


def tree_of(solid):
    return collision_mesh(*arrays(solid))


def about(point, direction, angle):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(angle * np.asarray(direction)).as_matrix()
    return shift(*point) @ matrix @ shift(*-np.asarray(point))


def scene(kinds_and_seed):
    first, second, seed = kinds_and_seed
    rng = np.random.default_rng(seed)
    one, other = some_solid(first, rng), some_solid(second, rng)
    pose, where = random_pose(rng, 15.0), random_pose(rng, 3.0)
    return (
        (tree_of(one), pose, placed(corners(one), pose)),
        (
            tree_of(other),
            where,
            placed(corners(other), where),
        ),
        rng,
    )


@given(SCENES, st.sampled_from([0.0, 0.7]))
@examples(25)
def test_the_rotational_distance_is_the_first_angle_of_contact(kinds, margin):
    (a, pose, t), (b, where, u), rng = scene(kinds)
    if crossings(t, u) or least_distance(t, u) <= margin + 0.1:
        return
    point, direction = rng.uniform(-10, 10, 3), random_direction(rng)
    found = rotational_distances(a, b, pose, where, [point, direction], margin)[0]
    for fraction in np.linspace(0.0, 0.999, 12):
        assert least_distance(placed(t, about(point, direction, fraction * found)), u) > margin
    at = [placed(t, about(point, direction, found + error)) for error in (-1e-7, 1e-7)]
    if found == 2 * np.pi:
        return
    if margin == 0.0:
        assert not crossings(placed(t, about(point, direction, found - 2e-9)), u)
        assert crossings(placed(t, about(point, direction, found + 2e-9)), u) or (
            least_distance(at[1], u) < 1e-6
        )
    else:
        assert least_distance(at[0], u) >= margin - 1e-9
        assert least_distance(placed(t, about(point, direction, found)), u) < margin + 1e-6
    assert not surfaces_collide(a, b, about(point, direction, found) @ pose, where, margin)[0]


@given(SCENES)
@examples(20)
def test_a_chain_of_greatest_turns_never_collides(kinds):
    (a, pose, t), (b, where, u), rng = scene(kinds)
    if crossings(t, u):
        return
    moved = 0
    for _ in range(30):
        point, direction = rng.uniform(-10, 10, 3), random_direction(rng)
        angle = rotational_distances(a, b, pose, where, [point, direction], limit=1.0)[0]
        pose = about(point, direction, angle) @ pose
        moved += angle > 1e-3
        assert not surfaces_collide(a, b, pose, where)[0]
    assert moved >= 5


def test_a_bar_turns_until_its_side_meets_a_post():
    bar, post = tree_of(Manifold.cube((20, 2, 2), True)), tree_of(Manifold.cube((2, 2, 2), True))
    (angle,) = rotational_distances(bar, post, HERE, shift(0, 8, 0), [[0, 0, 0], Z])
    corner = np.array([1.0, 7.0])
    expected = np.arctan2(corner[1], corner[0]) - np.arcsin(1.0 / np.hypot(*corner))
    assert angle == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("margin", [0.0, 1.0])
def test_a_cube_on_a_plate_turns_about_the_vertical_and_off_the_plate_but_not_into_it(margin):
    cube, plate = tree_of(Manifold.cube((2, 2, 2), True)), tree_of(Manifold.cube((9, 9, 2), True))
    on = shift(0, 0, 2 + margin)
    assert rotational_distances(cube, plate, on, HERE, [[0, 0, 0], Z], margin)[0] == 2 * np.pi
    assert rotational_distances(cube, plate, on, HERE, [[3, 2, 0], Z], margin)[0] == 2 * np.pi
    assert rotational_distances(cube, plate, on, HERE, [[0, 0, 2 + margin], X], margin)[0] < 1e-8
    assert rotational_distances(cube, plate, on, HERE, [[0, 9, 1 + margin], -X], margin, 0.5)[0] == 0.5


def test_bodies_that_a_turn_never_brings_to_one_height_do_not_meet():
    cube = tree_of(Manifold.cube((2, 2, 2), True))
    assert rotational_distances(cube, cube, shift(5, 0, 3), HERE, [[9, 0, 0], Z])[0] == 2 * np.pi
    assert rotational_distances(cube, cube, shift(9, 0, 3), HERE, [[4.5, 0, 0], Z], 1.5)[0] < np.pi
