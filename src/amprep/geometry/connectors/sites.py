"""Where the teeth and points of connectors go: one to each cell of a grid with contact in it."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.connectors.columns import ConnectorColumns, Patches, clip_to_columns

_LEAST = 1e-3
"""Share of a cell: less contact than that gets no site, unless its column has no more elsewhere."""

_SLOPING = 0.02
"""mm; contact that reaches so much below its mean has a lowest spot."""

_ON_SIDE = 1e-6


class Sites(NamedTuple):
    """Places of teeth or points.

    Attributes
    ----------
    column
        ``(s,)`` the column each belongs to.
    square
        ``(s, 2)`` its cell in the finer grid: y, x.
    lo, hi
        ``(s, 2)`` mm, corners of the cell in plan.
    spot
        ``(s, 2)`` mm, a place in the contact: of its middle, or of the lowest spot if that is within the cell.
    lowest, highest
        ``(s,)`` mm, of the contact in the cell.
    share
        ``(s,)`` of the cell that the contact covers in plan.
    """

    column: Int64s
    square: Int64s
    lo: Floats
    hi: Floats
    spot: Floats
    lowest: Floats
    highest: Floats
    share: Floats


def find_sites(contact: Floats, columns: ConnectorColumns, count: int, width: float) -> Sites:
    """Choose the sites of `columns`, each of whose squares is cut into `count` x `count` cells.

    Parameters
    ----------
    contact
        ``(t, 3, 3)`` mm, triangles of what the connectors touch; those that look down count.
    width
        mm, of what is to be put there: it keeps so much away from a lowest spot that it lies on the contact.

    Returns
    -------
    sites
        `lowest` is that of the contact within `width` around the spot.
    """
    fine, owner, square = _subdivided(columns, count)
    patches = clip_to_columns(fine, contact, np.arange(len(contact)), np.ones(len(owner), np.bool_))
    cells = _measured(patches, fine)
    area = cells.area / (fine.grid[2] * fine.grid[2])
    best = np.zeros(len(columns.lo))
    np.maximum.at(best, owner, area)
    chosen = np.flatnonzero((area > 0.0) & ((area >= _LEAST) | (area == best[owner])))
    spot = _spots(patches, fine, cells, width)[chosen]
    lowest = _lowest_around(spot, width, contact, fine, chosen, cells.lowest[chosen])
    lo, hi = fine.lo[chosen, :2], fine.hi[chosen, :2]
    return Sites(owner[chosen], square[chosen], lo, hi, spot, lowest, cells.highest[chosen], area[chosen])


def _subdivided(columns: ConnectorColumns, count: int) -> tuple[ConnectorColumns, Int64s, Int64s]:
    """Return the cells of all columns, the column of each, and its place in the finer grid."""
    owner = np.repeat(np.arange(len(columns.lo)), count * count)
    within = np.tile(np.argwhere(np.ones((count, count))), (len(columns.lo), 1))
    square = columns.square[owner] * count + within
    side = columns.grid[2] / count
    grid = np.array([columns.grid[0], columns.grid[1], side])
    lo, hi = columns.lo[owner].copy(), columns.hi[owner].copy()
    lo[:, :2], hi[:, :2] = (grid[:2] + (square[:, ::-1] + more) * side for more in (0, 1))
    ny, nx = columns.shape
    return ConnectorColumns(lo, hi, square, grid, (ny * count, nx * count)), owner, square


class _Cells(NamedTuple):
    """Of each cell: area of the contact in plan, its centroid, mean and least and greatest height."""

    area: Floats
    centroid: Floats
    mean: Floats
    lowest: Floats
    highest: Floats


def _measured(patches: Patches, fine: ConnectorColumns) -> _Cells:
    count = len(fine.lo)
    area, middle = _plan(patches)
    cell = patches.owner[:, 0]
    total = np.asarray(np.bincount(cell, area, count), np.float64)
    safe = np.where(total > 0.0, total, 1.0)
    moments = [np.bincount(cell, area * middle[:, axis], count) / safe for axis in range(3)]
    lowest, highest = np.full(count, np.inf), np.full(count, -np.inf)
    corner = np.repeat(cell, np.diff(patches.start))
    np.minimum.at(lowest, corner, patches.points[:, 2])
    np.maximum.at(highest, corner, patches.points[:, 2])
    return _Cells(total, np.column_stack(moments[:2]), moments[2], lowest, highest)


def _plan(patches: Patches) -> tuple[Floats, Floats]:
    """Return the area of each patch in plan, and the centroid ``(n, 3)`` of that."""
    patch, inner, following = _fans(patches)
    first = patches.points[patches.start[patch]]
    b, c = patches.points[inner], patches.points[following]
    area = np.abs(_turn(b - first, c - first)) / 2.0
    count = len(patches.owner)
    total = np.asarray(np.bincount(patch, area, count), np.float64)
    centre = (first + b + c) / 3.0
    middle = [np.bincount(patch, area * centre[:, axis], count) for axis in range(3)]
    return total, np.column_stack(middle) / np.maximum(total, 1e-15)[:, None]


def _turn(one: Floats, other: Floats) -> Floats:
    """Return the cross product of vectors in plan."""
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _fans(patches: Patches) -> tuple[Int64s, Int64s, Int64s]:
    """Return patch, second and third corner of the triangles that fan out from each patch's first corner."""
    patch = np.repeat(np.arange(len(patches.owner)), np.diff(patches.start))
    here = np.arange(len(patches.points))
    inner = (here > patches.start[:-1][patch]) & (here + 1 < patches.start[1:][patch])
    return patch[inner], here[inner], here[inner] + 1


def _spots(patches: Patches, fine: ConnectorColumns, cells: _Cells, width: float) -> Floats:
    """Return a place in the contact of every cell.

    The middle of the cell if contact is there, else the centroid of the contact, else that of the nearest of its
    pieces. Where the contact has a lowest spot inside the cell, beside it.
    """
    area, middle = _plan(patches)
    owner = patches.owner[:, 0]
    away = np.linalg.norm(middle[:, :2] - cells.centroid[owner], axis=1)
    order = np.lexsort((away, owner))
    order = order[area[order] > 0.0]
    held, first = np.unique(owner[order], return_index=True)
    spot = (fine.lo + fine.hi)[:, :2] / 2.0
    nearest = np.zeros_like(spot)
    nearest[held] = middle[order[first], :2]
    covered = _contains(patches, spot)
    spot = np.where(covered[:, None], spot, cells.centroid)
    covered |= _contains(patches, spot)
    spot = np.where(covered[:, None], spot, nearest)
    cell, bottom = _lowest_inside(patches, fine, cells)
    inward = cells.centroid[cell] - bottom
    length = np.linalg.norm(inward, axis=1)
    share = np.minimum(1.0, width / 2.0 / np.maximum(length, 1e-9))
    spot[cell] = bottom + inward * share[:, None]
    return np.asarray(spot)


def _contains(patches: Patches, spot: Floats) -> Bools:
    """Tell which cells have a patch over their spot ``(c, 2)``."""
    found = np.zeros(len(spot), np.bool_)
    if not len(patches.owner):
        return found
    owner = patches.owner[:, 0]
    patch = np.repeat(np.arange(len(owner)), np.diff(patches.start))
    here = np.arange(len(patches.points))
    after = np.where(here + 1 == patches.start[1:][patch], patches.start[:-1][patch], here + 1)
    start, end = patches.points[here, :2], patches.points[after, :2]
    left = _turn(end - start, spot[owner[patch]] - start) >= -1e-12
    inside = np.logical_and.reduceat(left, patches.start[:-1])
    found[owner[inside]] = True
    return found


def _lowest_inside(patches: Patches, fine: ConnectorColumns, cells: _Cells) -> tuple[Int64s, Floats]:
    """Return cells whose contact slopes down to a spot inside them, and that spot ``(n, 2)``."""
    cell = np.repeat(patches.owner[:, 0], np.diff(patches.start))
    plan, height = patches.points[:, :2], patches.points[:, 2]
    on_side = ((plan <= fine.lo[cell, :2] + _ON_SIDE) | (plan >= fine.hi[cell, :2] - _ON_SIDE)).any(axis=1)
    rim = np.full(len(cells.area), np.inf)
    np.minimum.at(rim, cell[on_side], height[on_side])
    dips = np.minimum(cells.mean, rim) > cells.lowest + _SLOPING
    bottom = np.flatnonzero(dips[cell] & (height == cells.lowest[cell]))
    chosen, first = np.unique(cell[bottom], return_index=True)
    return chosen, plan[bottom[first]]


def _lowest_around(
    spot: Floats, width: float, contact: Floats, fine: ConnectorColumns, chosen: Int64s, otherwise: Floats
) -> Floats:
    """Return the least height of the contact within `width` around spots, in their cells."""
    low, high = fine.lo[chosen].copy(), fine.hi[chosen].copy()
    low[:, :2], high[:, :2] = within(spot, width, low[:, :2], high[:, :2])
    around = ConnectorColumns(low, high, fine.square[chosen], fine.grid, fine.shape)
    patches = clip_to_columns(around, contact, np.arange(len(contact)), np.ones(len(chosen), np.bool_))
    lowest = np.full(len(chosen), np.inf)
    np.minimum.at(lowest, np.repeat(patches.owner[:, 0], np.diff(patches.start)), patches.points[:, 2])
    return np.where(np.isfinite(lowest), lowest, otherwise)


def within(spot: Floats, width: float, lo: Floats, hi: Floats) -> tuple[Floats, Floats]:
    """Return squares of `width` around spots, pushed into the cells from `lo` to `hi`."""
    corner = np.clip(spot - width / 2.0, lo, np.maximum(hi - width, lo))
    return corner, np.minimum(corner + width, hi)
