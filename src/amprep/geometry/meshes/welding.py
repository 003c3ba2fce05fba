"""Weld meshes on arrays: merge vertices that coincide, cancel triangles that face each other."""

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.kernels.meshes.welding import label_rows

WELD_LATTICE = 1e-4
"""mm; cells that conform agree to about 1e-12 mm, a build file to 3e-5 mm, the finest wall is far thicker."""


def round_as_stored(points: Floats) -> Floats:
    """Round coordinates to what 3MF keeps: six decimals, then float32; what is kept already stays."""
    return np.asarray(np.round(points, 6).astype(np.float32) + np.float32(0.0), np.float64)


def label_equal_rows(rows: NDArray[np.int64]) -> tuple[Int64s, int]:
    """Number equal rows of `rows` ``(n, 3)`` in order of first appearance: labels ``(n,)`` and their count."""
    table = np.full(1 << (2 * len(rows) + 1).bit_length(), -1, np.int64)
    label = np.empty(len(rows), np.int64)
    count = label_rows(np.ascontiguousarray(rows, np.int64), table, label)
    return label, int(count)


def merge_vertices(
    points: Floats, triangles: Int64s, *, lattice: float = WELD_LATTICE
) -> tuple[Floats, Int64s]:
    """Make vertices on the same lattice point one, at the place a build file keeps.

    Parameters
    ----------
    points, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    lattice
        mm; 0 merges only what a build file keeps at exactly the same place.

    Returns
    -------
    points, triangles
        As many triangles as before, in their order; the first of each set of vertices stays.
    """
    rounded = round_as_stored(points)
    keys = np.round(points / lattice).astype(np.int64) if lattice else rounded.view(np.int64)
    label, count = label_equal_rows(keys)
    merged = np.empty((count, 3))
    merged[label[::-1]] = rounded[::-1]  # of repeated labels the last one written is the first vertex
    return merged, label[triangles]


def cancel_opposite(triangles: Int64s) -> Bools:
    """Tell which triangles stay, ``(m,)``, once those with the same corners turning opposite ways cancel.

    Of equal triangles that are left over only the first stays: what is there twice is there once. Triangles
    with a repeated corner go.
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
    """Merge vertices and cancel opposite triangles; vertices nothing uses any more are dropped.

    Closed meshes give a closed mesh, and where faces coincide they vanish: the union of solids that touch
    face to face with the same triangles.

    Parameters
    ----------
    points, triangles, lattice
        As for `merge_vertices`.
    """
    merged, corners = merge_vertices(points, triangles, lattice=lattice)
    return drop_unused_vertices(merged, corners[cancel_opposite(corners)])
