"""Connectors: from red squares straight up to the true surface that they hold, and a little into it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.meshes import clip_columns as kernels

if TYPE_CHECKING:
    pass

RUN_SLACK = 1e-6
"""mm; faces this little outside a column's run of cubes still count as in it."""

LOWEST = 1e-4
"""mm; walls are not cut closer than this to their upper ends."""


class ConnectorColumns(NamedTuple):
    """The spaces above red squares that connectors may pass.

    Attributes
    ----------
    lo, hi
        ``(m, 3)`` mm, from the red square up to the top of its run of cubes.
    square
        ``(m, 2)`` int64, y and x.
    grid
        ``(3,)`` origin x, origin y, pitch.
    shape
        Numbers of squares (ny, nx).
    """

    lo: Floats
    hi: Floats
    square: Int64s
    grid: Floats
    shape: tuple[int, int]


class Patches(NamedTuple):
    """Pieces of triangles that lie in columns, sorted by column.

    Attributes
    ----------
    points
        ``(p, 3)`` mm, corners, counter-clockwise seen from above.
    start
        ``(n + 1,)`` where each patch's corners start.
    owner
        ``(n, 2)`` column, and triangle as the caller numbers them.
    of_column
        ``(m + 1,)`` where each column's patches start.
    """

    points: Floats
    start: Int64s
    owner: Int64s
    of_column: Int64s

    def chosen(self, keep: Bools) -> "Patches":
        """Return only the patches that `keep` ``(n,)`` names."""
        sizes = np.diff(self.start)
        start = np.concatenate([[0], np.cumsum(sizes[keep])])
        owner = self.owner[keep]
        of_column = np.searchsorted(owner[:, 0], np.arange(len(self.of_column)))
        return Patches(self.points[np.repeat(keep, sizes)], start, owner, of_column)

    def in_column(self, column: int) -> tuple[Floats, Int64s]:
        """Return the corners of the patches in a column, and where each patch's start among them."""
        first, last = self.of_column[column : column + 2]
        start = self.start[first : last + 1]
        return self.points[start[0] : start[-1]], start - start[0]


def clip_to_columns(columns: ConnectorColumns, corners: Floats, number: Int64s, allowed: Bools) -> Patches:
    """Cut triangles that look down to the columns they reach into.

    Parameters
    ----------
    corners
        ``(t, 3, 3)`` mm.
    number
        ``(t,)`` what each triangle is called in `Patches.owner`.
    allowed
        ``(m,)`` which columns to fill.
    """
    ny, nx = columns.shape
    chosen = np.flatnonzero(allowed)
    flat = columns.square[chosen, 0] * nx + columns.square[chosen, 1]
    order = np.argsort(flat, kind="stable")
    square_start = np.searchsorted(flat[order], np.arange(ny * nx + 1))
    room = 4 * len(corners) + 64
    while True:
        points, start, owner = (
            np.empty((8 * room, 3)),
            np.empty(room + 1, np.int64),
            np.empty((room, 2), np.int64),
        )
        count = kernels.clip_to_columns(
            corners, columns.grid, columns.shape, square_start, chosen[order], columns.lo, columns.hi,
            RUN_SLACK, points, start, owner,
        )  # fmt: skip
        if count >= 0:
            break
        room *= 4
    owner = owner[:count]
    owner[:, 1] = number[owner[:, 1]]
    return _sorted(points, start[: count + 1], owner, len(columns.lo))


def _sorted(points: Floats, start: Int64s, owner: Int64s, columns: int) -> Patches:
    """Sort patches by column."""
    order = np.argsort(owner[:, 0], kind="stable")
    sizes = np.diff(start)[order]
    ends = np.cumsum(sizes)
    take = np.repeat(start[:-1][order] - ends + sizes, sizes) + np.arange(int(sizes.sum()))
    owner = owner[order]
    of_column = np.searchsorted(owner[:, 0], np.arange(columns + 1))
    return Patches(points[take], np.concatenate([[0], ends]), owner, of_column)


def join_patches(families: Sequence[Patches], columns: int) -> Patches:
    """Return the patches of several families as one."""
    points = np.concatenate([np.empty((0, 3)), *(each.points for each in families)])
    sizes = np.concatenate([np.empty(0, np.int64), *(np.diff(each.start) for each in families)])
    owner = np.concatenate([np.empty((0, 2), np.int64), *(each.owner for each in families)])
    return _sorted(points, np.concatenate([[0], np.cumsum(sizes)]), owner, columns)


def held_corners(
    vertices: Floats, triangles: Int64s, faces: Int64s, edges: Int64s, tips: Int64s, *, width: float
) -> Floats:
    """Return what is to be held as triangles that look down, ``(t, 3, 3)`` mm.

    A face is itself; a knife edge is a level band of `width` mm along it, a tip a level square of that width.

    Parameters
    ----------
    faces, edges, tips
        Triangles, ``(e, 2)`` and ``(t,)`` vertices.
    """
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    along = end - start
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
    length = np.linalg.norm(across, axis=1)
    across *= (0.5 * width / np.maximum(length, 1e-12))[:, None]
    x, y = np.eye(3)[:2] * width
    middle = vertices[tips]
    bands = _quads(np.concatenate([start - across, middle - 0.5 * (x + y)]),
                   np.concatenate([start + across, middle + 0.5 * (y - x)]),
                   np.concatenate([end + across, middle + 0.5 * (x + y)]),
                   np.concatenate([end - across, middle + 0.5 * (x - y)]))  # fmt: skip
    return np.concatenate([vertices[triangles[faces]], bands])


def _quads(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Two triangles for each quadrangle given by its corners ``(n, 3)``."""
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
