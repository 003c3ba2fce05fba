"""Collision of convex pieces as a linear program (thesis 2.5)."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.prepared import PreparedPieces

DEPTH_TOLERANCE = 1e-6
"""Length (mm) by which pieces must be apart to be free: the solver's feasibility tolerance is a tenth of it."""


def pieces_share_point(planes: Floats, other: Floats) -> bool:
    """Return whether two convex pieces intersect or touch, up to `DEPTH_TOLERANCE`.

    The linear program maximises the depth t of a point x below all planes: n x + t <= d for every plane (n, d).

    Parameters
    ----------
    planes, other
        ``(k, 4)`` and ``(m, 4)``, outward unit normals and offsets, in one system of coordinates.
    """
    from scipy.optimize import linprog

    both = np.concatenate((planes, other))
    rows = np.column_stack((both[:, :3], np.ones(len(both))))
    origin = -rows[:, :3] @ _near(planes) + both[:, 3]
    found = linprog([0, 0, 0, -1], A_ub=rows, b_ub=origin, bounds=[(None, None)] * 3 + [(None, 1.0)])
    return found.x is None or bool(found.x[3] > -DEPTH_TOLERANCE)


def _near(planes: Floats) -> Floats:
    """Return a point near the planes, from which the program measures, so that its numbers are small."""
    return np.asarray(np.linalg.lstsq(planes[:, :3], planes[:, 3], rcond=None)[0])


def sets_collide_by_program(a: PreparedPieces, b: PreparedPieces, pose: Floats) -> bool:
    """Return whether two sets of pieces intersect or touch; `pose` ``(4, 4)`` maps b into the coordinates of a.

    Pairs whose axis-parallel boxes are apart are skipped.
    """
    moved = b.vertices @ pose[:3, :3].T + pose[:3, 3]
    others = np.split(moved, b.first[1:-1])
    lo, hi = np.array([p.min(axis=0) for p in others]), np.array([p.max(axis=0) for p in others])
    for i, piece in enumerate(a.pieces):
        near = ((lo <= piece.max(axis=0)) & (hi >= piece.min(axis=0))).all(axis=1)
        for j in np.flatnonzero(near).tolist():
            if pieces_share_point(a.planes[i], move_planes(b.planes[j], pose)):
                return True
    return False


def move_planes(planes: Floats, pose: Floats) -> Floats:
    """Return planes ``(k, 4)`` under a rigid motion ``(4, 4)``."""
    normals = planes[:, :3] @ pose[:3, :3].T
    return np.column_stack((normals, planes[:, 3] + normals @ pose[:3, 3]))
