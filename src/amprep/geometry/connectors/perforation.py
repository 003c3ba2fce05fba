"""Cut rows of diamond-shaped openings through connectors along both axes, so that powder can leave."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.meshes.manifold import as_manifold

if TYPE_CHECKING:
    from manifold3d import Manifold


ROOF = float(np.tan(np.radians(55.0)))
"""Slope of the upper sides of the diamonds: steep enough to print without support."""

WIDEST = 0.6
"""Largest width of an opening as a fraction of the side of the square; posts remain in the corners."""

SILL, LINTEL = 0.2, 0.3
"""Height (mm) of the material below each row of openings, and least height above the uppermost row."""

_PAST = 0.01
"""Length (mm) by which openings extend beyond the first and last square of a row."""


def perforations(columns: ConnectorColumns, height: Floats, width: float) -> "Iterator[Manifold]":
    """Yield the solids to subtract from connectors: openings along x, then openings along y.

    Above all squares of one plane the rows have the same heights, so openings of neighbouring squares form one
    straight channel.

    Parameters
    ----------
    columns
        Columns above the red squares.
    height
        ``(m,)`` height (mm) above each red square up to which the connector fills the whole square; 0 where it does
        not fill it.
    width
        Width (mm) of an opening; it is limited to `WIDEST` times the side of the square.
    """
    side = float(columns.grid[2])
    width = min(width, WIDEST * side)
    spacing = width * ROOF + SILL
    count = np.maximum(np.floor((height - LINTEL) / spacing), 0).astype(np.int64)
    column = np.repeat(np.arange(len(height)), count)
    row = np.arange(len(column)) - np.repeat(np.cumsum(count) - count, count)
    middle = columns.lo[column, 2] + SILL + width * ROOF / 2.0 + row * spacing
    for axis in (0, 1) if len(column) else ():
        runs = _runs(columns.square[column, 1 - axis], columns.square[column, axis], middle)
        yield as_manifold(*_diamonds(*runs, columns.grid, width, axis))


def _runs(along: Int64s, across: Int64s, middle: Floats) -> tuple[Int64s, Int64s, Int64s, Floats]:
    """Join openings of consecutive squares: first and last square along, square across, height of the centre."""
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
    """Return closed prisms with a diamond section along an axis."""
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
