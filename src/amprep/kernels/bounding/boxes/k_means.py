"""K-means clustering of small boxes by (centre, diagonal direction) pairs."""

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.helper import helper

_MOST_STEPS = 100

_THINNEST = 1e-3
"""Least component of a diagonal direction, as a fraction of the greatest."""


@helper
def _enclose(items: Floats, labels: Int64s, boxes: Floats) -> None:
    """Write the enclosing box of each cluster to `boxes`; inf and -inf where it is empty."""
    boxes[:, :3] = np.inf
    boxes[:, 3:] = -np.inf
    for i in range(len(items)):
        for c in range(3):
            boxes[labels[i], c] = min(boxes[labels[i], c], items[i, c])
            boxes[labels[i], c + 3] = max(boxes[labels[i], c + 3], items[i, c + 3])


@helper
def _assign(items: Floats, boxes: Floats, rates: Floats, labels: Int64s) -> bool:
    """Assign each item to the pair whose smallest box around it has least volume; tell whether a label changed.

    The smallest box with centre c and diagonal direction d that contains an item has the scale
    ``max |p - c| / d`` over its corners p and the axes, and a volume of scale^3 times the product of d.
    """
    for k in range(len(boxes)):
        longest = max(boxes[k, 3] - boxes[k, 0], boxes[k, 4] - boxes[k, 1], boxes[k, 5] - boxes[k, 2])
        product = 1.0
        for c in range(3):
            rates[k, c] = (boxes[k, c] + boxes[k, c + 3]) / 2.0
            side = max(boxes[k, c + 3] - boxes[k, c], _THINNEST * longest, 1e-12)
            rates[k, c + 3] = 1.0 / side
            product *= side
        for c in range(3):
            rates[k, c + 3] *= product ** (1.0 / 3.0)
    changed = False
    for i in range(len(items)):
        best, label = np.inf, labels[i]
        for k in range(len(boxes)):
            if boxes[k, 0] > boxes[k, 3]:
                continue
            scale = 0.0
            for c in range(3):
                reach = max(items[i, c + 3] - rates[k, c], rates[k, c] - items[i, c])
                scale = max(scale, reach * rates[k, c + 3])
            if scale < best:
                best, label = scale, k
        changed |= label != labels[i]
        labels[i] = label
    return changed


@helper
def _union(boxes: Floats) -> float:
    """Volume of the union of few boxes, by inclusion and exclusion."""
    total = 0.0
    for chosen in range(1, 1 << len(boxes)):
        sign, volume = -1.0, 1.0
        for k in range(len(boxes)):
            if chosen >> k & 1:
                sign = -sign
        for c in range(3):
            low, high = -np.inf, np.inf
            for k in range(len(boxes)):
                if chosen >> k & 1:
                    low = max(low, boxes[k, c])
                    high = min(high, boxes[k, c + 3])
            volume *= max(high - low, 0.0)
        total += sign * volume
    return total


@njit(cache=True)
def cluster(items: Floats, seeds: Int64s, labels: Int64s) -> float:
    """Cluster from several starts (thesis 2.3, adaptation of K-means); keep the labels of least union.

    Parameters
    ----------
    items
        ``(m, 6)`` mm, small boxes to be covered.
    seeds
        ``(starts, k)`` items around which the first clusters of each start are collected, by cubes.
    labels
        ``(m,)``, receives the cluster of each item.

    Returns
    -------
    float
        Volume of the union of the enclosing boxes of the clusters.
    """
    count = seeds.shape[1]
    boxes, rates = np.empty((count, 6)), np.empty((count, 6))
    current = np.zeros(len(items), np.int64)
    best = np.inf
    for start in range(len(seeds)):
        for k in range(count):
            for c in range(3):
                middle = (items[seeds[start, k], c] + items[seeds[start, k], c + 3]) / 2.0
                boxes[k, c], boxes[k, c + 3] = middle - 0.5, middle + 0.5
        _assign(items, boxes, rates, current)
        for _ in range(_MOST_STEPS):
            _enclose(items, current, boxes)
            if not _assign(items, boxes, rates, current):
                break
        _enclose(items, current, boxes)
        volume = 0.0
        for k in range(count):
            if boxes[k, 0] > boxes[k, 3]:
                boxes[k] = 0.0
        volume = _union(boxes)
        if volume < best:
            best = volume
            labels[:] = current
    return best
