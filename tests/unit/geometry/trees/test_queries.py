"""Collisions, distances and directional distances of trees equal those over all pairs of triangles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.triangles import (
    SCENES,
    arrays,
    corners,
    crossings,
    least_distance,
    least_travel,
    placed,
    random_direction,
    random_pose,
    shift,
    some_solid,
)

from amprep.geometry.trees.collision_mesh import collision_mesh
from amprep.geometry.trees.queries import directional_distances, surface_distances, surfaces_collide

HERE = np.eye(4)
X, Y, Z = np.eye(3)


def tree_of(solid):
    return collision_mesh(*arrays(solid))


def cube(size=1.0):
    return tree_of(Manifold.cube((size, size, size)))


def scene(kinds_and_seed, reach, scale=1.0):
    """Two bodies with poses, and their triangles in place."""
    first, second, seed = kinds_and_seed
    rng = np.random.default_rng(seed)
    one, other = some_solid(first, rng).scale([scale] * 3), some_solid(second, rng).scale([scale] * 3)
    pose, where = random_pose(rng, reach * scale), random_pose(rng, reach * scale)
    return (
        (tree_of(one), pose, placed(corners(one), pose)),
        (
            tree_of(other),
            where,
            placed(corners(other), where),
        ),
        rng,
    )


@given(SCENES, st.sampled_from([1e-3, 1.0, 1e3]))
@examples(60)
def test_surfaces_collide_where_an_edge_pierces_a_triangle(kinds, scale):
    (a, pose, t), (b, where, u), _ = scene(kinds, 5.0, scale)
    assert surfaces_collide(a, b, pose, where)[0] == crossings(t, u)


@given(SCENES)
@examples(40)
def test_the_distance_is_the_least_over_all_pairs(kinds):
    (a, pose, t), (b, where, u), _ = scene(kinds, 8.0)
    expected = least_distance(t, u)
    assert surface_distances(a, b, pose, where)[0] == pytest.approx(expected, abs=1e-9)
    assert surface_distances(a, b, pose, where, limit=0.5)[0] == pytest.approx(min(expected, 0.5), abs=1e-9)


@given(SCENES, st.floats(1e-3, 10.0))
@examples(40)
def test_bodies_collide_if_they_are_closer_than_the_margin(kinds, margin):
    (a, pose, t), (b, where, u), _ = scene(kinds, 8.0)
    expected = least_distance(t, u)
    if abs(expected - margin) > 1e-6:
        assert surfaces_collide(a, b, pose, where, margin)[0] == (expected < margin)


@given(SCENES, st.sampled_from([1e-3, 1.0, 1e3]))
@examples(80)
def test_the_directional_distance_is_the_least_over_all_pairs(kinds, scale):
    (a, pose, t), (b, where, u), rng = scene(kinds, 15.0, scale)
    if crossings(t, u):
        return
    direction = u.mean(axis=(0, 1)) - t.mean(axis=(0, 1)) + scale * rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    expected = least_travel(t, u, direction)
    found = directional_distances(a, b, pose, where, direction)[0]
    assert found == expected or found == pytest.approx(expected, abs=1e-9 * max(scale, 1.0))
    assert directional_distances(a, b, pose, where, direction, limit=scale)[0] == pytest.approx(
        min(expected, scale), abs=1e-9 * max(scale, 1.0)
    )


@given(SCENES, st.floats(1e-3, 5.0))
@examples(40)
def test_travel_with_a_margin_ends_at_the_margin(kinds, margin):
    (a, pose, t), (b, where, u), rng = scene(kinds, 15.0)
    if least_distance(t, u) <= margin:
        return
    direction = u.mean(axis=(0, 1)) - t.mean(axis=(0, 1)) + rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    travel = directional_distances(a, b, pose, where, direction, margin, limit=60.0)[0]
    for fraction in (0.25, 0.5, 0.75, 0.9, 0.99, 1.0):
        assert least_distance(t + fraction * travel * direction, u) >= margin - 1.01e-7
    if travel < 60.0:
        assert least_distance(t + (travel + 1e-6) * direction, u) < margin
        assert not surfaces_collide(a, b, shift(*(travel * direction)) @ pose, where, margin)[0]


@given(SCENES, st.sampled_from([0.0, 0.5]))
@examples(30)
def test_a_long_chain_of_greatest_moves_never_collides_and_never_gets_stuck(kinds, margin):
    (a, *_), (b, *_), rng = scene(kinds, 0.0)
    pose, moved = shift(30.0, 0.0, 0.0), 0
    for _ in range(60):
        toward = -pose[:3, 3] / max(np.linalg.norm(pose[:3, 3]), 1e-9)
        direction = random_direction(rng) + (toward if rng.random() < 0.7 else 0.0)
        travel = directional_distances(a, b, pose, HERE, direction, margin, limit=20.0)[0]
        pose = shift(*(travel * direction / np.linalg.norm(direction))) @ pose
        moved += travel > 1e-3
        assert not surfaces_collide(a, b, pose, HERE, margin)[0]
        assert surface_distances(a, b, pose, HERE)[0] >= margin - 2e-7
    assert moved >= 10


@pytest.mark.parametrize("turn", [np.eye(3), np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])])
def test_cubes_that_touch_at_a_face_an_edge_or_a_corner_do_not_collide(turn):
    one, pose = cube(), np.eye(4)
    pose[:3, :3] = turn
    pose[:3, 3] = -np.minimum(turn @ np.ones(3), 0.0)
    for offset in ([1, 0, 0], [1, 0.3, 0.2], [1, 1, 0], [1, 1, 1], [-1, 0, 0], [0, -1, 0.5], [0, 0, 1]):
        assert not surfaces_collide(one, one, shift(*offset) @ pose, HERE)[0], offset


@pytest.mark.parametrize("depth", [1e-6, 1e-3, 0.5])
def test_cubes_that_enter_one_another_collide_also_where_their_faces_are_coplanar(depth):
    one = cube()
    for offset in ([1, 0, 0], [1, 0.3, 0.2], [0, -1, 0], [0, 0, 1], [0.5, 0, 1]):
        inwards = np.array(offset, float)
        inwards[np.abs(inwards) == 1.0] *= 1.0 - depth
        assert surfaces_collide(one, one, shift(*inwards), HERE)[0], offset


def test_a_body_collides_with_its_own_copy():
    for kind in ("box", "ball", "ring", "angle"):
        body = tree_of(some_solid(kind, np.random.default_rng(1)))
        assert surfaces_collide(body, body, HERE, HERE)[0]


def test_a_cube_on_another_may_rise_and_slide_but_not_sink():
    one, above = cube(), shift(0.25, 0.25, 1.0)
    assert directional_distances(one, one, above, HERE, -Z, limit=9.0)[0] == 0.0
    assert directional_distances(one, one, above, HERE, [1, 0, -1e-6], limit=9.0)[0] < 1e-9
    for free in (Z, X, -X, Y, X + 1e-6 * Z):
        assert directional_distances(one, one, above, HERE, free, limit=9.0)[0] == 9.0


def test_a_cube_slides_past_others_that_it_only_grazes():
    one = cube()
    for offset in ([0, 1, 0], [0, 0, -1], [0, 1, 1], [0, -1, 0.5]):
        assert directional_distances(one, one, shift(-5, 0, 0) @ shift(*offset), HERE, X, limit=9.0)[0] == 9.0
    assert directional_distances(one, one, shift(-5, 1 - 1e-5, 0), HERE, X, limit=9.0)[0] == pytest.approx(
        4.0
    )


@pytest.mark.parametrize("margin", [0.0, 0.5, 2.0])
def test_a_cube_at_its_margin_may_leave_and_slide_but_not_come_closer(margin):
    one, at = cube(), shift(0.0, 0.0, 1.0 + margin)
    assert directional_distances(one, one, at, HERE, -Z, margin, limit=9.0)[0] == 0.0
    assert directional_distances(one, one, at, HERE, X, margin, limit=9.0)[0] == 9.0
    assert directional_distances(one, one, at, HERE, X + Z, margin, limit=9.0)[0] == 9.0
    slot = shift(-5.0, 1.0 + margin, 0.3)
    assert directional_distances(one, one, slot, HERE, X, margin, limit=9.0)[0] == 9.0


def test_rounding_at_a_contact_neither_blocks_nor_frees():
    one = cube()
    for error in (-1e-8, -1e-12, 1e-12, 1e-8):
        at = shift(0.1, 0.2, 1.0 + error)
        assert directional_distances(one, one, at, HERE, -Z, limit=9.0)[0] <= 1e-8
        assert directional_distances(one, one, at, HERE, Z, limit=9.0)[0] == 9.0
        assert directional_distances(one, one, at, HERE, X + 1e-3 * Y, limit=9.0)[0] == 9.0


def test_one_pose_may_meet_many_directions_and_many_poses_one_direction():
    one = cube()
    assert directional_distances(
        one, one, shift(3, 0, 0), HERE, np.array([-X, X]), limit=9.0
    ) == pytest.approx([2.0, 9.0])
    poses = np.array([shift(3, 0, 0), shift(5, 0, 0)])
    assert directional_distances(one, one, poses, HERE, -X, limit=9.0) == pytest.approx([2.0, 4.0])
    assert surface_distances(one, one, poses, HERE) == pytest.approx([2.0, 4.0])
    assert list(surfaces_collide(one, one, poses, HERE, 3.0)) == [True, False]
