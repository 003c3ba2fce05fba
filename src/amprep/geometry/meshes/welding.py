"""Weld meshes: merge coincident vertices and cancel opposite triangles."""

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.kernels.meshes.welding import label_rows

WELD_LATTICE = 1e-4
"""Pitch (mm) of the lattice on which vertices are merged: far coarser than the errors of conforming cells (1e-12 mm)
and of build files (3e-5 mm), far finer than the thinnest wall."""


def round_as_stored(points: Floats) -> Floats:
    """Round coordinates to six decimals and to float32, as 3MF files store them; the function is idempotent."""
    return np.asarray(np.round(points, 6).astype(np.float32) + np.float32(0.0), np.float64)


def label_equal_rows(rows: NDArray[np.int64]) -> tuple[Int64s, int]:
    """Number equal rows of an array ``(n, 3)`` in order of first appearance; return labels ``(n,)`` and their count."""
    table = np.full(1 << (2 * len(rows) + 1).bit_length(), -1, np.int64)
    label = np.empty(len(rows), np.int64)
    count = label_rows(np.ascontiguousarray(rows, np.int64), table, label)
    return label, int(count)


def merge_vertices(
    points: Floats, triangles: Int64s, *, lattice: float = WELD_LATTICE
) -> tuple[Floats, Int64s]:
    """Merge vertices at the same point of a lattice and round their coordinates as build files store them.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    lattice
        Pitch, mm; 0 merges only vertices that a build file stores with equal coordinates.

    Returns
    -------
    points, triangles
        Merged vertices, each at the first of its set, and as many triangles as before in their order.
    """
    rounded = round_as_stored(points)
    keys = np.round(points / lattice).astype(np.int64) if lattice else rounded.view(np.int64)
    label, count = label_equal_rows(keys)
    merged = np.empty((count, 3))
    merged[label[::-1]] = rounded[::-1]  # of repeated labels the last one written is the first vertex
    return merged, label[triangles]


def cancel_opposite(triangles: Int64s) -> Bools:
    """Tell which triangles remain, ``(m,)``, when triangles of the same corners and opposite orientation cancel.

    Of the equal triangles that remain only the first is kept. Triangles with a repeated corner are dropped.
    """
    flat = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    order = np.sort(triangles, axis=1)
    middle = np.take_along_axis(triangles, (triangles.argmin(axis=1)[:, None] + 1) % 3, axis=1)[:, 0]
    sign = np.where(middle == order[:, 1], 1, -1)
    sign[flat] = 0
    label, count = label_equal_rows(order)
    net = np.sign(np.bincount(label, sign, count)).astype(np.int64)
    candidates = np.flatnonzero((net[label] != 0) & (sign == net[label]))[::-1]
    first = np.full(count, -1)
    first[label[candidates]] = candidates
    stays = np.zeros(len(triangles), np.bool_)
    stays[first[first >= 0]] = True
    return stays


def weld(points: Floats, triangles: Int64s, *, lattice: float = WELD_LATTICE) -> tuple[Floats, Int64s]:
    """Merge vertices, cancel opposite triangles and drop unused vertices.

    Closed meshes give a closed mesh. Coincident faces vanish, so the result is the union of solids that touch in faces
    with the same triangles.

    Parameters
    ----------
    points, triangles, lattice
        As for `merge_vertices`.
    """
    merged, corners = merge_vertices(points, triangles, lattice=lattice)
    return drop_unused_vertices(merged, corners[cancel_opposite(corners)])
