"""Windows through connectors: rows of diamonds along both axes, through which powder leaves."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.meshes.manifold import as_manifold

if TYPE_CHECKING:
    from manifold3d import Manifold


ROOF = float(np.tan(np.radians(55.0)))
"""Steepness of the sides of the diamonds."""

WIDEST = 0.6
"""Share of the square's side that a window may take, so that posts are left in the corners."""

SILL, LINTEL = 0.2, 0.3
"""mm of material below each row of windows, and above the uppermost at least."""

_PAST = 0.01
"""mm that windows go on beyond the last square of a row."""


def windows(columns: ConnectorColumns, room: Floats, width: float) -> "Iterator[Manifold]":
    """Yield solids to be cut out of connectors: windows along x, and windows along y.

    They lie at the same heights above all squares of a plane, so that they line up from square to square.

    Parameters
    ----------
    room
        ``(m,)`` mm above the red square of each column that are solid all over the square; 0 for none.
    width
        mm; at most `WIDEST` of the square's side.
    """
    side = float(columns.grid[2])
    width = min(width, WIDEST * side)
    every = width * ROOF + SILL
    count = np.maximum(np.floor((room - LINTEL) / every), 0).astype(np.int64)
    column = np.repeat(np.arange(len(room)), count)
    row = np.arange(len(column)) - np.repeat(np.cumsum(count) - count, count)
    middle = columns.lo[column, 2] + SILL + width * ROOF / 2.0 + row * every
    for axis in (0, 1) if len(column) else ():
        runs = _runs(columns.square[column, 1 - axis], columns.square[column, axis], middle)
        yield as_manifold(*_diamonds(*runs, columns.grid, width, axis))


def _runs(along: Int64s, across: Int64s, middle: Floats) -> tuple[Int64s, Int64s, Int64s, Floats]:
    """Join windows that line up: first and last square along, square across, height of the middle."""
    level = np.round(middle * 1e6).astype(np.int64)
    order = np.lexsort((along, across, level))
    along, across, level, middle = along[order], across[order], level[order], middle[order]
    new = np.ones(len(order), np.bool_)
    new[1:] = (np.diff(along) != 1) | (np.diff(across) != 0) | (np.diff(level) != 0)
    first = np.flatnonzero(new)
    last = np.concatenate([first[1:], [len(order)]]) - 1
    return along[first], along[last], across[first], middle[first]


def _diamonds(
    first: Int64s, last: Int64s, across: Int64s, middle: Floats, grid: Floats, width: float, axis: int
) -> tuple[Floats, Int64s]:
    """Return closed prisms of diamond section along an axis."""
    side, half = grid[2], np.array([width, width * ROOF]) / 2.0
    begin = grid[axis] + first * side - _PAST
    end = grid[axis] + (last + 1) * side + _PAST
    centre = grid[1 - axis] + (across + 0.5) * side
    section = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]) * half
    points = np.empty((len(first), 2, 4, 3))
    points[..., axis] = np.stack([begin, end], axis=1)[:, :, None]
    points[..., 1 - axis] = (centre[:, None] + section[:, 0])[:, None]
    points[..., 2] = (middle[:, None] + section[:, 1])[:, None]
    here, after = np.arange(4), (np.arange(4) + 1) % 4
    faces = np.concatenate([
        [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]],
        np.column_stack([here, after, after + 4]), np.column_stack([here, after + 4, here + 4]),
    ])  # fmt: skip
    if axis == 1:
        faces = faces[:, ::-1]
    every = faces[None] + (8 * np.arange(len(first)))[:, None, None]
    return points.reshape(-1, 3), every.reshape(-1, 3)
