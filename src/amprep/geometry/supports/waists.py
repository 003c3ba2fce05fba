"""Find waists in the outline of a region: places between two wider ones at which it is narrower than a width."""

import numpy as np

from amprep.arrays import Floats, Int64s

_INWARDS = np.radians(5.0)
"""Angle by which an outline turns inwards at the corner of a waist."""

_OPPOSITE = 0.7
"""Cosine of the largest angle at which the shortest line across a waist meets the other side."""

_REACH = 1.5
"""Distance (in widths) from a corner up to which the middles of pieces of sides, at most a width long, are compared."""


def find_waists(points: Floats, after: Int64s, width: float) -> Int64s:
    """Return the corners that turn inwards at which a region is narrower than a width, indices ``(k,)``.

    Where a region becomes narrower and then wider again, one of its two sides turns inwards. So only such corners are
    compared with the sides near them.

    Parameters
    ----------
    points, after
        ``(n, 2)`` mm, vertices of the outlines, which have the region to their left; the next vertex of each.
    width
        Length (mm).
    """
    from scipy.spatial import cKDTree

    side = points[after] - points
    length = np.hypot(side[:, 0], side[:, 1])
    heading = np.arctan2(side[:, 1], side[:, 0])
    turn = np.empty(len(points))
    turn[after] = (heading[after] - heading + np.pi) % (2.0 * np.pi) - np.pi
    corner = np.flatnonzero(turn < -_INWARDS)
    if not len(corner):
        return corner
    pieces = np.ceil(length / width).astype(np.int64)
    owner = np.repeat(np.arange(len(points)), pieces)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middle = points[owner] + ((number + 0.5) / pieces[owner])[:, None] * side[owner]
    near = np.asarray(cKDTree(middle).query_ball_point(points[corner], _REACH * width), np.object_)
    vertex = np.repeat(corner, [len(each) for each in near])
    across = owner[np.concatenate([np.array(each, np.int64) for each in near])]
    along = side[across] / length[across, None]
    offset = points[across] - points[vertex]
    offset += np.clip(-(offset * along).sum(axis=1), 0.0, length[across])[:, None] * along
    distance = np.hypot(offset[:, 0], offset[:, 1])
    outwards = offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]
    is_narrow = (distance > 1e-6) & (distance < width) & (outwards > _OPPOSITE * distance)
    return np.unique(vertex[is_narrow])
