"""Collision, distance and directional distance of two sets of convex pieces under arrays of poses."""

from typing import Literal

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.bounding.convex.inflate import inflate_pieces
from amprep.geometry.bounding.convex.linear_program import sets_collide_by_program
from amprep.geometry.bounding.convex.prepared import PreparedPieces

Method = Literal["gjk", "lp"]


def pieces_collide(
    a: PreparedPieces,
    b: PreparedPieces,
    poses_a: Floats,
    poses_b: Floats,
    margin: float = 0.0,
    method: Method = "gjk",
) -> Bools:
    """Return for each pair of poses ``(n,)`` whether the sets are closer than the margin.

    No answer "free" is wrong by more than 1e-9 mm. Pieces that touch without a margin collide.

    Parameters
    ----------
    a, b
        The sets in their own coordinates.
    poses_a, poses_b
        ``(n, 4, 4)`` rigid motions; or ``(4, 4)`` for one pose that is combined with all of the other set.
    margin
        Least distance of the sets, at least 0, mm.
    method
        ``gjk``: exact distances. ``lp``: linear programs (thesis 2.5); with a margin the pieces of `a` are inflated, so
        distances up to 1.2 times the margin may count as collisions.
    """
    poses = relative_poses(poses_a, poses_b)
    hit = np.zeros(len(poses), np.bool_)
    if method == "lp":
        inflated = inflate_pieces(a, margin)
        for n, pose in enumerate(poses):
            hit[n] = sets_collide_by_program(inflated, b, pose)
        return hit
    from amprep.kernels.bounding.piece_sets import collide_at

    collide_at(a.arrays, b.arrays, poses, float(margin), work_array(b), hit)
    return hit


def pieces_distance(
    a: PreparedPieces, b: PreparedPieces, poses_a: Floats, poses_b: Floats, most: float = np.inf
) -> Floats:
    """Return for each pair of poses the distance ``(n,)`` of the sets, mm, at most `most`; 0 if they intersect.

    See `pieces_collide` for the arguments.
    """
    from amprep.kernels.bounding.piece_sets import distance_at

    poses = relative_poses(poses_a, poses_b)
    found = np.empty(len(poses))
    distance_at(a.arrays, b.arrays, poses, float(most), work_array(b), found)
    return found


def pieces_travel(
    a: PreparedPieces,
    b: PreparedPieces,
    poses_a: Floats,
    poses_b: Floats,
    directions: Floats,
    margin: float = 0.0,
    upto: float = np.inf,
) -> Floats:
    """Return for each pair of poses how far a may move until its distance to b is the margin, ``(n,)`` mm (thesis 2.6).

    The values are never too long; they are 0 for sets that are closer than the margin, and at most `upto`.

    Parameters
    ----------
    a, b, poses_a, poses_b, margin
        See `pieces_collide`.
    directions
        ``(n, 3)`` or ``(3,)`` unit vectors.
    upto
        Longest travel of interest, mm.
    """
    from amprep.kernels.bounding.piece_sets import directional_distance_at

    poses = relative_poses(poses_a, poses_b)
    turns = np.asarray(poses_a, np.float64)[..., :3, :3]
    rays = np.einsum("...ji,...j->...i", turns, np.asarray(directions, np.float64))
    rays = np.ascontiguousarray(np.broadcast_to(rays, (len(poses), 3)))
    found = np.empty(len(poses))
    directional_distance_at(a.arrays, b.arrays, poses, rays, float(margin), float(upto), work_array(b), found)
    return found


def relative_poses(poses_a: Floats, poses_b: Floats) -> Floats:
    """Return the motions ``(n, 4, 4)`` from the coordinates of b to those of a."""
    first, second = np.asarray(poses_a, np.float64), np.asarray(poses_b, np.float64)
    back = np.swapaxes(first[..., :3, :3], -1, -2)
    poses = np.zeros((np.broadcast(first[..., 0, 0], second[..., 0, 0]).size, 4, 4))
    poses[:, :3, :3] = back @ second[..., :3, :3]
    poses[:, :3, 3] = np.einsum("...ij,...j->...i", back, second[..., :3, 3] - first[..., :3, 3])
    poses[:, 3, 3] = 1.0
    return poses


def work_array(b: PreparedPieces) -> Floats:
    """Return an array in which the kernels `collide`, `distance` and `directional_distance` may write."""
    from amprep.kernels.bounding.piece_sets import COLUMNS, SIMPLEX_ROWS

    return np.empty((len(b.first) + SIMPLEX_ROWS, COLUMNS))
