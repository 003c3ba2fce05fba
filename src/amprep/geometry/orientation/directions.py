"""Directions of a part that may point upwards in the build: spread over the sphere, and from its flat faces."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.boxes.orientation import Hull

_ALIKE_DEG = 0.05
"""Directions closer than this (degrees) are one."""

_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))


def sphere_directions(count: int) -> Floats:
    """Return `count` unit vectors ``(count, 3)`` spread evenly over the sphere.

    They are the Fibonacci lattice: equal steps in height, turned by the golden angle from one to the next (Gonzalez
    2010, doi 10.1007/s11004-009-9257-x).
    """
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    radius = np.sqrt(1.0 - height * height)
    angle = _GOLDEN * np.arange(count)
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle), height))


def hull_directions(hull: Hull, most: int) -> Floats:
    """Return the directions ``(k, 3)`` that point up when a face of the convex hull is on the plate, at most `most`.

    Faces in one plane count together; the largest come first.
    """
    return _largest(hull.normals, hull.areas, most)


def flat_face_directions(cross: Floats, most: int) -> Floats:
    """Return the directions ``(k, 3)`` that point up when a large flat face of a mesh points down, at most `most`.

    Parameters
    ----------
    cross
        ``(m, 3)`` normals of the triangles with twice their area (mm2) as length. All triangles with the same normal
        count together.
    most
        Number of directions; those of the largest area come first.
    """
    size = np.linalg.norm(cross, axis=1)
    sound = size > 0.0
    return _largest(cross[sound] / size[sound, None], size[sound], most)


def _largest(normals: Floats, areas: Floats, most: int) -> Floats:
    """Return the opposites of the normals with the largest total areas."""
    alike = np.round(normals, 4)
    _, first, group = np.unique(alike, axis=0, return_index=True, return_inverse=True)
    total = np.bincount(group.reshape(-1), areas, len(first))
    chosen = first[np.argsort(-total, kind="stable")[:most]]
    return -normals[chosen] + 0.0


def distinct(directions: Floats) -> Floats:
    """Return the directions ``(k, 3)`` without those that are nearly equal to an earlier one; the order is kept."""
    from scipy.spatial import KDTree

    pairs = KDTree(directions).query_pairs(np.radians(_ALIKE_DEG), output_type="ndarray")
    kept = np.ones(len(directions), np.bool_)
    kept[pairs.max(axis=1, initial=-1)] = False
    return directions[kept]


def around(direction: Floats, angle_deg: float, count: int) -> Floats:
    """Return `count` unit vectors ``(count, 3)`` on a circle at an angle from a direction ``(3,)``."""
    across = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    across /= np.linalg.norm(across)
    other = np.cross(direction, across)
    turn = 2.0 * np.pi * np.arange(count) / count
    ring = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * other
    tilt = np.radians(angle_deg)
    return np.asarray(np.cos(tilt) * direction + np.sin(tilt) * ring)
