"""Clip the surfaces of parts to the columns above red squares."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.meshes.clip_columns import ColumnIndex, PatchBuffers
from amprep.kernels.meshes.clip_columns import clip_to_columns as clip_kernel
from amprep.kernels.meshes.patches import Patches

RUN_SLACK = 1e-6
"""Faces up to this far (mm) above or below the run of voxels of a column count as inside it."""


class ConnectorColumns(NamedTuple):
    """Spaces above red squares that connectors may fill.

    Attributes
    ----------
    lo, hi
        ``(m, 3)`` mm, corners: from the red square up to the top of its run of voxels.
    square
        ``(m, 2)`` int64, indices y and x of the square.
    grid
        ``(3,)`` origin x, origin y and pitch, mm.
    shape
        Numbers of squares (ny, nx).
    """

    lo: Floats
    hi: Floats
    square: Int64s
    grid: Floats
    shape: tuple[int, int]


def clip_to_columns(columns: ConnectorColumns, corners: Floats, number: Int64s, allowed: Bools) -> Patches:
    """Clip triangles that face down to the columns above which they are.

    Parameters
    ----------
    columns
        All columns.
    corners
        ``(t, 3, 3)`` triangles, mm.
    number
        ``(t,)`` number of each triangle in `Patches.owner`.
    allowed
        ``(m,)`` whether triangles are clipped to the column.
    """
    ny, nx = columns.shape
    chosen = np.flatnonzero(allowed)
    flat = columns.square[chosen, 0] * nx + columns.square[chosen, 1]
    order = np.argsort(flat, kind="stable")
    square_start = np.searchsorted(flat[order], np.arange(ny * nx + 1))
    index = ColumnIndex(columns.grid, columns.shape, square_start, chosen[order], columns.lo, columns.hi)
    room = 4 * len(corners) + 64
    while True:
        out = PatchBuffers(
            np.empty((8 * room, 3)), np.empty(room + 1, np.int64), np.empty((room, 2), np.int64)
        )
        count = clip_kernel(corners, index, RUN_SLACK, out)
        if count >= 0:
            break
        room *= 4
    owner = out.owner[:count]
    owner[:, 1] = number[owner[:, 1]]
    return _sorted(out.points, out.start[: count + 1], owner, len(columns.lo))


def _sorted(points: Floats, start: Int64s, owner: Int64s, columns: int) -> Patches:
    """Return the patches sorted by column."""
    order = np.argsort(owner[:, 0], kind="stable")
    sizes = np.diff(start)[order]
    ends = np.cumsum(sizes)
    take = np.repeat(start[:-1][order] - ends + sizes, sizes) + np.arange(int(sizes.sum()))
    owner = owner[order]
    of_column = np.searchsorted(owner[:, 0], np.arange(columns + 1))
    return Patches(points[take], np.concatenate([[0], ends]), owner, of_column)


def join_patches(families: Sequence[Patches], columns: int) -> Patches:
    """Return the patches of several families in one record, sorted by column."""
    points = np.concatenate([np.empty((0, 3)), *(each.points for each in families)])
    sizes = np.concatenate([np.empty(0, np.int64), *(np.diff(each.start) for each in families)])
    owner = np.concatenate([np.empty((0, 2), np.int64), *(each.owner for each in families)])
    return _sorted(points, np.concatenate([[0], np.cumsum(sizes)]), owner, columns)


def supported_triangles(
    vertices: Floats, triangles: Int64s, faces: Int64s, edges: Int64s, tips: Int64s, *, width: float
) -> Floats:
    """Return the overhangs of a mesh as triangles that face down, ``(t, 3, 3)`` mm.

    A knife edge becomes a level band along it, a tip a level square.

    Parameters
    ----------
    vertices, triangles
        The mesh, ``(n, 3)`` mm and ``(m, 3)``.
    faces, edges, tips
        Indices of triangles, ``(e, 2)`` and ``(t,)`` indices of vertices.
    width
        Width of bands and squares, mm.
    """
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    along = end - start
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
    length = np.linalg.norm(across, axis=1)
    across *= (0.5 * width / np.maximum(length, 1e-12))[:, None]
    x, y = np.eye(3)[:2] * width
    middle = vertices[tips]
    bands = _split_quads(np.concatenate([start - across, middle - 0.5 * (x + y)]),
                         np.concatenate([start + across, middle + 0.5 * (y - x)]),
                         np.concatenate([end + across, middle + 0.5 * (x + y)]),
                         np.concatenate([end - across, middle + 0.5 * (x - y)]))  # fmt: skip
    return np.concatenate([vertices[triangles[faces]], bands])


def _split_quads(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Return two triangles for each quadrangle with corners a, b, c, d, each ``(n, 3)``."""
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
