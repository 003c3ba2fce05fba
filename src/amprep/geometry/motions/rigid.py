"""Find the rigid motion that takes the triangles of one body to those of another."""

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats

_MOST_POINTS = 3000
"""Number of corners from which the motion is computed; all of them are compared."""


def find_motion(before: Floats, after: Floats, tolerance: float = CONTACT_TOLERANCE) -> Floats | None:
    """Return the rigid motion ``(4, 4)`` that takes each point to within a tolerance of another; None if none does.

    The rotation is that of least squares (Kabsch 1976, doi:10.1107/S0567739476001873). Mirrored or scaled points have
    no rigid motion.

    Parameters
    ----------
    before, after
        The points ``(n, 3)`` mm before and after, in the same order, at least one.
    tolerance
        Largest distance (mm) of a point from where the motion takes it.
    """
    chosen = np.unique(np.linspace(0, len(before) - 1, _MOST_POINTS).astype(np.int64))
    motion = _least_squares(before[chosen], after[chosen])
    return motion if largest_distance(motion, before, after) <= tolerance else None


def largest_distance(motion: Floats, before: Floats, after: Floats) -> float:
    """Return the largest distance (mm) of points ``(n, 3)``, moved by a motion ``(4, 4)``, from others."""
    moved = before @ motion[:3, :3].T + motion[:3, 3]
    return float(np.linalg.norm(moved - after, axis=1).max(initial=0.0))


def displacement(bounds: tuple[Floats, Floats], before: Floats, after: Floats) -> float:
    """Return the largest distance (mm) that a point of a box moves from one placement ``(4, 4)`` to another."""
    corners = np.array(
        [[bounds[side][axis] for axis, side in enumerate(each)] for each in np.ndindex(2, 2, 2)]
    )
    return largest_distance(before, corners, corners @ after[:3, :3].T + after[:3, 3])


def angle_deg(motion: Floats) -> float:
    """Return the angle (degrees) of the rotation of a motion ``(4, 4)``."""
    # the sine is exact for small angles, the cosine for large ones
    rotation = motion[:3, :3]
    axis = [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    return float(np.degrees(np.arctan2(np.linalg.norm(axis), np.trace(rotation) - 1.0)))


def _least_squares(before: Floats, after: Floats) -> Floats:
    """Return the proper motion with the least sum of squared distances of points ``(n, 3)``."""
    middle, there = before.mean(axis=0), after.mean(axis=0)
    left, _, right = np.linalg.svd((before - middle).T @ (after - there))
    sign = 1.0 if np.linalg.det(left) * np.linalg.det(right) > 0.0 else -1.0
    rotation = right.T @ np.diag([1.0, 1.0, sign]) @ left.T
    motion = np.eye(4)
    motion[:3, :3], motion[:3, 3] = rotation, there - rotation @ middle
    return motion
