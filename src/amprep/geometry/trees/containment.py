"""Points and bodies inside a collision mesh, for arrays of poses (thesis 2.6)."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.trees.collision_mesh import CollisionMesh
from amprep.geometry.trees.poses import pose_rows
from amprep.geometry.trees.stacks import new_stack


def contains_points(body: CollisionMesh, points: Floats) -> Bools:
    """Tell which points ``(n, 3)`` mm, in the coordinates of a mesh, are inside it, ``(n,)``.

    Points on the surface may count either way.
    """
    from amprep.kernels.trees.batches import contains_each

    answers = np.empty(len(points), np.bool_)
    rows = np.array(points, np.float64).reshape(-1, 3)
    contains_each(body.tree, rows, new_stack(body.tree.depth, body.tree.depth), answers)
    return answers


def solids_collide(
    a: CollisionMesh, b: CollisionMesh, poses_a: Floats, poses_b: Floats, margin: float = 0.0
) -> Bools:
    """Tell for each pose whether two solids intersect or are closer than a margin, ``(n,)``.

    A body inside the other intersects it; bodies that only touch do not.

    Parameters
    ----------
    poses_a, poses_b
        Rigid motions of the bodies, ``(n, 4, 4)``, or ``(4, 4)`` for all.
    margin
        mm, at least 0.
    """
    from amprep.kernels.trees.batches import solids_collide_each

    rows_a, rows_b = pose_rows(poses_a, poses_b)
    answers = np.empty(len(rows_a), np.bool_)
    stack = new_stack(a.tree.depth, b.tree.depth)
    solids_collide_each(a.tree, rows_a, b.tree, rows_b, margin, stack, answers)
    return answers


def is_inside(a: CollisionMesh, b: CollisionMesh, poses_a: Floats, poses_b: Floats) -> Bools:
    """Tell for each pose whether the first body is inside the second, ``(n,)``.

    Where it touches faces from inside, it may count either way.

    Parameters
    ----------
    poses_a, poses_b
        Rigid motions of the bodies, ``(n, 4, 4)``, or ``(4, 4)`` for all.
    """
    from amprep.kernels.trees.batches import is_inside_each

    rows_a, rows_b = pose_rows(poses_a, poses_b)
    answers = np.empty(len(rows_a), np.bool_)
    is_inside_each(a.tree, rows_a, b.tree, rows_b, new_stack(a.tree.depth, b.tree.depth), answers)
    return answers
