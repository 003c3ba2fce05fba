"""Queries on a collision mesh inside the walls of the build volume, for arrays of poses."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.trees.collision_mesh import CollisionMesh
from amprep.geometry.trees.poses import pose_rows, unit_vectors

if TYPE_CHECKING:
    from amprep.kernels.trees.walls import Walls


def build_walls(size: Floats, *, is_cylinder: bool = False) -> "Walls":
    """Return the walls of a box from the origin to `size`, ``(3,)`` mm, or of the upright cylinder inscribed in it."""
    from amprep.kernels.trees.walls import Walls

    x, y, z = (float(length) for length in size)
    return Walls((0.0, 0.0, 0.0), (x, y, z), is_cylinder)


def travel_inside(
    body: CollisionMesh, poses: Floats, directions: Floats, walls: "Walls", margin: float = 0.0
) -> Floats:
    """Return the first and the last travel at which a body is inside the walls, ``(n, 2)`` mm.

    The first is at most 0 if the body is inside now, and above the last if the body is never inside.

    Parameters
    ----------
    poses
        ``(n, 4, 4)``, or ``(4, 4)`` for all.
    directions
        ``(n, 3)`` or ``(3,)``, of any length but 0.
    walls, margin
        The build volume, and the clearance from its walls, mm.
    """
    from amprep.kernels.trees.walls import travel_inside

    (rows,) = pose_rows(poses, count=len(np.atleast_2d(directions)))
    along = unit_vectors(directions, len(rows))
    return np.array(
        [
            travel_inside(body.tree.hull, row, tuple(each), walls, margin)
            for row, each in zip(rows, along, strict=True)
        ]
    ).reshape(-1, 2)


def turn_inside(
    body: CollisionMesh,
    poses: Floats,
    axis: tuple[Floats, Floats],
    walls: "Walls",
    margin: float = 0.0,
    limit: float = 2.0 * np.pi,
) -> Floats:
    """Return the angle by which a body may turn about an axis inside the walls, ``(n,)`` rad.

    Parameters
    ----------
    poses
        ``(n, 4, 4)``, or ``(4, 4)``.
    axis
        A point on it ``(3,)`` mm and its direction ``(3,)``.
    walls, margin
        The build volume, and the clearance from its walls, mm.
    limit
        rad; returned where the body may turn at least as far.
    """
    from amprep.kernels.trees.walls import turn_inside

    (rows,) = pose_rows(poses)
    point, direction = tuple(np.asarray(axis[0], np.float64)), tuple(unit_vectors(axis[1], 1)[0])
    return np.array(
        [turn_inside(body.tree.hull, row, point, direction, walls, margin, limit) for row in rows], np.float64
    )
