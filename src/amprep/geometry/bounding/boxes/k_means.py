"""Coverings with few boxes by an adaptation of K-means (thesis 2.3)."""

import numpy as np

from amprep.arrays import Floats, Int64s


def cluster_boxes(
    items: Floats, count: int, restarts: int, rng: np.random.Generator
) -> tuple[Int64s, Floats]:
    """Cluster small boxes so that the enclosing boxes of the clusters have a small union.

    A cluster is represented by the centre of its enclosing box and the direction of the diagonal; each item goes to
    the pair whose smallest box around it has the least volume. The thesis clusters points; an item is a point that
    has an extent, so that the enclosing boxes contain all that the items contain.

    Parameters
    ----------
    items
        ``(m, 6)`` mm, at least one.
    count
        Number of clusters.
    restarts
        Number of random starts; the smallest union counts.
    rng
        Chooses the items around which the first clusters are collected.

    Returns
    -------
    labels, boxes
        ``(m,)`` cluster of each item, and ``(k, 6)`` enclosing boxes of the clusters that are not empty.
    """
    from amprep.kernels.bounding.boxes.k_means import cluster

    labels = np.zeros(len(items), np.int64)
    seeds = rng.integers(0, len(items), (restarts, count))
    cluster(np.ascontiguousarray(items), seeds, labels)
    return labels, enclosing_boxes(items, labels, count)


def enclosing_boxes(items: Floats, labels: Int64s, count: int) -> Floats:
    """Return the enclosing boxes of clusters of items, ``(k, 6)``; empty clusters are left out."""
    members = [items[labels == number] for number in range(count)]
    return np.array([np.concatenate((m[:, :3].min(axis=0), m[:, 3:].max(axis=0))) for m in members if len(m)])
