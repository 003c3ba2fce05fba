"""Queries on two collision meshes, for arrays of poses (thesis 2.6)."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.trees.collision_mesh import CollisionMesh
from amprep.geometry.trees.poses import pose_rows, unit_vectors
from amprep.geometry.trees.stacks import new_stack


def surfaces_collide(
    a: CollisionMesh, b: CollisionMesh, poses_a: Floats, poses_b: Floats, margin: float = 0.0
) -> Bools:
    """Tell for each pose whether two surfaces intersect or are closer than a margin, ``(n,)``.

    Touching is no intersection: see `amprep.kernels.trees`. For a body inside another see `solids_collide`.

    Parameters
    ----------
    poses_a, poses_b
        Rigid motions of the bodies, ``(n, 4, 4)``, or ``(4, 4)`` for all.
    margin
        mm, at least 0.
    """
    from amprep.kernels.trees.batches import collide_each

    rows_a, rows_b = pose_rows(poses_a, poses_b)
    answers = np.empty(len(rows_a), np.bool_)
    collide_each(a.tree, rows_a, b.tree, rows_b, margin, new_stack(a.tree.depth, b.tree.depth), answers)
    return answers


def surface_distances(
    a: CollisionMesh, b: CollisionMesh, poses_a: Floats, poses_b: Floats, limit: float = np.inf
) -> Floats:
    """Return for each pose the distance of two surfaces, at most a limit, ``(n,)`` mm; 0 if they intersect.

    Parameters
    ----------
    poses_a, poses_b
        Rigid motions of the bodies, ``(n, 4, 4)``, or ``(4, 4)`` for all.
    limit
        mm.
    """
    from amprep.kernels.trees.batches import distance_each

    rows_a, rows_b = pose_rows(poses_a, poses_b)
    answers = np.empty(len(rows_a))
    distance_each(a.tree, rows_a, b.tree, rows_b, limit, new_stack(a.tree.depth, b.tree.depth), answers)
    return answers


def directional_distances(
    a: CollisionMesh,
    b: CollisionMesh,
    poses_a: Floats,
    poses_b: Floats,
    directions: Floats,
    margin: float = 0.0,
    limit: float = np.inf,
) -> Floats:
    """Return for each pose how far the first body may travel before it is within a margin of the second, ``(n,)`` mm.

    Parameters
    ----------
    poses_a, poses_b
        Rigid motions of the bodies, ``(n, 4, 4)``, or ``(4, 4)`` for all.
    directions
        ``(n, 3)`` or ``(3,)``, of any length but 0.
    margin, limit
        mm; where the body may travel at least to the limit, the limit is returned.
    """
    from amprep.kernels.trees.batches import directional_each

    along = np.atleast_2d(directions)
    rows_a, rows_b = pose_rows(poses_a, poses_b, count=len(along))
    count = len(rows_a)
    answers = np.empty(count)
    directional_each(
        a.tree,
        rows_a,
        b.tree,
        rows_b,
        unit_vectors(along, count),
        margin,
        np.full(count, float(limit)),
        new_stack(a.tree.depth, b.tree.depth),
        answers,
    )
    return answers


def rotational_distances(
    a: CollisionMesh,
    b: CollisionMesh,
    poses_a: Floats,
    poses_b: Floats,
    axes: Floats,
    margin: float = 0.0,
    limit: float = 2.0 * np.pi,
) -> Floats:
    """Return for each pose how far the first body may turn before it is within a margin of the second, ``(n,)`` rad.

    Parameters
    ----------
    poses_a, poses_b
        Rigid motions of the bodies, ``(n, 4, 4)``, or ``(4, 4)`` for all.
    axes
        ``(n, 2, 3)`` or ``(2, 3)``: a point on each axis, mm, and its direction, of any length but 0. Turns are
        counter-clockwise seen against the direction.
    margin, limit
        mm and rad; where the body may turn at least to the limit, the limit is returned.
    """
    from amprep.kernels.trees.batches import rotational_each

    lines = np.asarray(axes, np.float64).reshape(-1, 2, 3)
    rows_a, rows_b = pose_rows(poses_a, poses_b, count=len(lines))
    count = len(rows_a)
    answers = np.empty(count)
    rotational_each(
        a.tree,
        rows_a,
        b.tree,
        rows_b,
        np.hstack([np.broadcast_to(lines[:, 0], (count, 3)), unit_vectors(lines[:, 1], count)]),
        margin,
        float(limit),
        new_stack(a.tree.depth, b.tree.depth),
        answers,
    )
    return answers
