"""Collision, distance and travel of convex pieces agree with manifold3d, with linear programs, and with each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.convex import moved, random_poses, random_sets, united
from tests.shared.examples import examples

from amprep.geometry.bounding.convex.collision import (
    pieces_collide,
    pieces_distance,
    pieces_travel,
    relative_poses,
)
from amprep.geometry.bounding.convex.prepared import prepare_pieces

SEEDS = st.integers(0, 10**6)
CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
STILL = np.eye(4)


def at(x, y=0.0, z=0.0):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def directions(seed, count):
    found = np.random.default_rng(seed).normal(size=(count, 3))
    found[::4] = [0, 0, 1]
    return found / np.linalg.norm(found, axis=1)[:, None]


@given(SEEDS)
@examples(30)
def test_pieces_collide_if_and_only_if_their_union_intersects(seed):
    a, b = random_sets(seed)
    poses_a, poses_b = random_poses(seed + 1, 4, 1.5), random_poses(seed + 2, 4, 1.5)
    hit = pieces_collide(a, b, poses_a, poses_b)
    shared = [united(a, p) ^ united(b, q) for p, q in zip(poses_a, poses_b, strict=True)]
    assert hit.tolist() == [solid.volume() > 1e-12 for solid in shared]


@given(SEEDS)
@examples(30)
def test_the_distance_is_the_least_gap_of_the_solids(seed):
    a, b = random_sets(seed)
    poses_a, poses_b = random_poses(seed + 1, 4), random_poses(seed + 2, 4)
    found = pieces_distance(a, b, poses_a, poses_b)
    gaps = [united(a, p).min_gap(united(b, q), 100.0) for p, q in zip(poses_a, poses_b, strict=True)]
    assert found == pytest.approx(gaps, abs=1e-9)


@given(SEEDS, st.floats(0.01, 2.0))
@examples(30)
def test_pieces_collide_within_the_margin_exactly_when_they_are_nearer(seed, margin):
    a, b = random_sets(seed)
    poses_a, poses_b = random_poses(seed + 1, 20), random_poses(seed + 2, 20)
    near = pieces_distance(a, b, poses_a, poses_b) < margin
    assert pieces_collide(a, b, poses_a, poses_b, margin).tolist() == near.tolist()


@given(SEEDS)
@examples(10)
def test_linear_programs_and_gjk_agree(seed):
    a, b = random_sets(seed, most=2)
    poses_a, poses_b = random_poses(seed + 1, 6, 1.5), random_poses(seed + 2, 6, 1.5)
    by_program = pieces_collide(a, b, poses_a, poses_b, method="lp")
    assert by_program.tolist() == pieces_collide(a, b, poses_a, poses_b).tolist()


@given(SEEDS)
@examples(8)
def test_linear_programs_with_a_margin_are_conservative_and_bounded(seed):
    a, b = random_sets(seed, most=2)
    poses_a, poses_b = random_poses(seed + 1, 6, 2.0), random_poses(seed + 2, 6, 2.0)
    distance = pieces_distance(a, b, poses_a, poses_b)
    hit = pieces_collide(a, b, poses_a, poses_b, 0.5, method="lp")
    assert hit[distance < 0.5].all()
    assert not hit[distance > 0.5 * 1.2 + 1e-5].any()


@given(SEEDS, st.sampled_from([0.0, 0.3]))
@examples(30)
def test_travel_ends_at_the_margin_and_never_passes_through(seed, margin):
    a, b = random_sets(seed)
    count = 20
    poses_a, poses_b = random_poses(seed + 1, count), random_poses(seed + 2, count)
    ways = directions(seed, count)
    travel = pieces_travel(a, b, poses_a, poses_b, ways, margin, upto=50.0)
    start = pieces_distance(a, b, poses_a, poses_b)
    assert (travel[start < margin - 1e-9] == 0.0).all()
    free = start > margin + 1e-6
    for fraction in (0.25, 0.5, 0.75, 0.9, 1.0):
        along = moved(poses_a, fraction * travel[:, None] * ways)
        assert (pieces_distance(a, b, along, poses_b)[free] >= margin - 1e-9).all()
    stopped = free & (travel < 50.0)
    ended = moved(poses_a, travel[:, None] * ways)
    assert pieces_distance(a, b, ended, poses_b)[stopped] == pytest.approx(margin, abs=1e-7)


def test_a_cube_meets_another_after_the_gap_and_one_beside_it_never():
    cube = prepare_pieces([CUBE])
    there = np.array([at(3), at(3, 0.5, 0.5), at(3, 2), at(-3)])
    travel = pieces_travel(cube, cube, STILL, there, np.array([1.0, 0, 0]), 0.0, upto=99.0)
    assert travel == pytest.approx([2.0, 2.0, 99.0, 99.0], abs=1e-9)


@pytest.mark.parametrize("margin", [0.5, 3.0])
def test_a_set_at_the_margin_may_leave_and_slide_but_not_come_nearer(margin):
    cube = prepare_pieces([CUBE])
    there = at(1 + margin)
    ways = np.array([[-1.0, 0, 0], [0, 1, 0], [1, 0, 0]])
    still = np.tile(STILL, (3, 1, 1))
    assert pieces_travel(cube, cube, still, there, ways, margin, upto=9.0).tolist() == [9.0, 9.0, 0.0]


def test_cubes_that_touch_collide_and_at_the_margin_they_do_not():
    cube = prepare_pieces([CUBE])
    there = np.array([at(1), at(1, 1), at(1, 1, 1), at(0.5, 1)])
    assert pieces_collide(cube, cube, STILL, there).all()
    assert not pieces_collide(cube, cube, STILL, np.array([at(1.5), at(0, 0, 1.5)]), 0.5).any()
    assert pieces_collide(cube, cube, STILL, np.array([at(1.499), at(0, 0, 1.499)]), 0.5).all()


def test_shrunk_cubes_that_touch_or_penetrate_a_little_do_not_collide():
    cube = prepare_pieces([CUBE], shrink=1e-3)
    assert not pieces_collide(cube, cube, STILL, np.array([at(1), at(1, 1), at(1 - 1e-4)])).any()
    assert pieces_collide(cube, cube, STILL, at(1 - 3e-3)[None]).all()


@pytest.mark.parametrize("far", [0.0, 1e3])
@pytest.mark.parametrize("gap", [1e-2, 1e-5, 1e-7])
def test_parallel_faces_in_near_contact_are_measured(gap, far):
    plate = prepare_pieces([CUBE * [100, 100, 0.2]])
    there = np.array([at(far, far, far + 0.2 + gap), at(far + 50, far + 30, far + 0.2 + gap)])
    assert pieces_distance(plate, plate, at(far, far, far), there) == pytest.approx(
        gap, abs=1e-12 * max(far, 1)
    )
    assert not pieces_collide(plate, plate, at(far, far, far), there).any()


def test_relative_poses_map_one_set_into_the_coordinates_of_the_other():
    a, b = random_poses(1, 5), random_poses(2, 5)
    assert a @ relative_poses(a, b) == pytest.approx(b)
