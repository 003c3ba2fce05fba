"""Volumes of boxes and of their union."""

from itertools import combinations

import numpy as np

from amprep.arrays import Floats


def volumes(boxes: Floats) -> Floats:
    """Return the volume (mm3) of each box ``(k, 6)``; 0 where it is empty."""
    return np.asarray(np.prod(np.maximum(boxes[:, 3:] - boxes[:, :3], 0.0), axis=1))


def union_volume(boxes: Floats) -> float:
    """Return the volume (mm3) of the union of boxes ``(k, 6)``.

    The faces of all boxes cut space into cells, each of which is inside a box or apart from it: exact but for
    rounding, in time k^4.
    """
    if len(boxes) <= 1:
        return float(volumes(boxes).sum())
    planes = [np.sort(np.concatenate((boxes[:, axis], boxes[:, axis + 3]))) for axis in range(3)]
    inside = np.zeros(tuple(len(row) - 1 for row in planes), np.bool_)
    for box in boxes:
        x, y, z = ((row[:-1] >= box[axis]) & (row[1:] <= box[axis + 3]) for axis, row in enumerate(planes))
        inside |= x[:, None, None] & y[:, None] & z
    dx, dy, dz = (np.diff(row) for row in planes)
    return float(np.einsum("ijk,i,j,k->", inside, dx, dy, dz))


def union_volumes(boxes: Floats) -> Floats:
    """Return the volume (mm3) of each union of at most five boxes, ``(n, k, 6)``, by inclusion and exclusion."""
    count = boxes.shape[1]
    total = np.zeros(len(boxes))
    for size in range(1, count + 1):
        for chosen in combinations(range(count), size):
            some = boxes[:, chosen]
            sides = some[:, :, 3:].min(axis=1) - some[:, :, :3].max(axis=1)
            total -= (-1) ** size * np.prod(np.maximum(sides, 0.0), axis=1)
    return total
