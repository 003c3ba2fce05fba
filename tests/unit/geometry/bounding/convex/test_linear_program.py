"""Two convex pieces share a point if and only if the linear program finds one."""

import numpy as np
from tests.shared.convex import random_poses, random_sets

from amprep.geometry.bounding.convex.linear_program import (
    move_planes,
    pieces_share_point,
    sets_collide_by_program,
)
from amprep.geometry.bounding.convex.prepared import planes_of, prepare_pieces

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def test_cubes_share_a_point_until_they_are_apart():
    shares = [
        pieces_share_point(planes_of(CUBE), planes_of(CUBE + [x, 0, 0])) for x in (0, 0.999, 1, 1.001, 5)
    ]
    assert shares == [True, True, True, False, False]


def test_moved_planes_are_the_planes_of_the_moved_piece():
    piece, pose = random_sets(2)[0].pieces[0], random_poses(4, 2)[1]
    planes = move_planes(planes_of(piece), pose)
    reach = (piece @ pose[:3, :3].T + pose[:3, 3]) @ planes[:, :3].T - planes[:, 3]
    assert np.abs(reach.max(axis=0)).max() < 1e-12


def test_sets_collide_if_any_pair_of_pieces_does():
    two = prepare_pieces([CUBE, CUBE + [10, 0, 0]])
    pose = np.eye(4)
    pose[:3, 3] = 10.5, 0.5, 0.5
    assert sets_collide_by_program(two, two, pose)
    pose[:3, 3] = 5, 0, 0
    assert not sets_collide_by_program(two, two, pose)
