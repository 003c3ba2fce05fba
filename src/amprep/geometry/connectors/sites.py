"""Choose the places of teeth and points: one in each cell of a fine grid that touches the part."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.connectors.columns import ConnectorColumns, clip_to_columns
from amprep.geometry.connectors.fitting import WHOLE, fit_tips, surfaces_of, unfitted
from amprep.kernels.meshes.patches import Patches

_LEAST = 1e-3
"""Least fraction of a cell that contact must cover; smaller contact counts only if its column has none larger."""

_SLOPING = 0.02
"""Height (mm) by which the lowest point of contact must be below the mean to be treated as a lowest point."""

_ON_SIDE = 1e-6
"""Distance (mm) at which a point counts as on the side of a cell."""


class Sites(NamedTuple):
    """Places of teeth or points.

    Attributes
    ----------
    column
        ``(s,)`` column of each site.
    square
        ``(s, 2)`` cell of the fine grid: y, x.
    lo, hi
        ``(s, 2)`` mm, corners of the cell in plan.
    spot
        ``(s, 2)`` mm, a point of the contact in plan: near its lowest point if that is inside the cell, otherwise near
        its centre.
    lowest, highest
        ``(s,)`` mm, least and greatest height of the contact in the cell.
    fraction
        ``(s,)`` fraction of the cell that the contact covers in plan.
    width
        ``(s,)`` mm, width of the tip at the part.
    spread
        ``(s,)`` fraction of the widening towards the whole cell that the root of the tip has.
    inside
        ``(s,)`` whether the tip is moved into its cell; otherwise its centre is exactly at the spot.
    whole
        ``(s,)`` whether contact covers the whole cell, and where tips are fitted, one surface of it.
    """

    column: Int64s
    square: Int64s
    lo: Floats
    hi: Floats
    spot: Floats
    lowest: Floats
    highest: Floats
    fraction: Floats
    width: Floats
    spread: Floats
    inside: Bools
    whole: Bools


def find_sites(
    contact: Floats, columns: ConnectorColumns, count: int, width: float, narrow: float | None = None
) -> Sites:
    """Choose sites in columns whose squares are divided into `count` x `count` cells.

    Parameters
    ----------
    contact
        ``(t, 3, 3)`` mm, triangles of the part inside the connectors; only faces that point down are used.
    columns
        Columns of the connectors.
    count
        Number of cells along each side of a square.
    width
        Width (mm) of a tip. A tip at a lowest point is moved inwards by half of it, so that it is on the contact.
    narrow
        Width (mm) of the narrowest tips, with which the tips are placed such that they are whole (see `fit_tips`); None
        to leave them at their spots.

    Returns
    -------
    sites
        Their field `lowest` is that of the contact within `width` around the spot.
    """
    fine, owner, square = _subdivided(columns, count)
    patches = clip_to_columns(fine, contact, np.arange(len(contact)), np.ones(len(owner), np.bool_))
    cells = _measured(patches, fine)
    area = cells.area / (fine.grid[2] * fine.grid[2])
    best = np.zeros(len(columns.lo))
    np.maximum.at(best, owner, area)
    chosen = np.flatnonzero((area > 0.0) & ((area >= _LEAST) | (area == best[owner])))
    tips = unfitted(_spots(patches, fine, cells, width)[chosen], width)
    whole = area >= WHOLE
    if narrow is not None:
        surface, corners = surfaces_of(contact), (fine.lo[chosen, :2], fine.hi[chosen, :2])
        whole &= _have_one_surface(patches, surface, len(area))
        tips = fit_tips(tips, whole[chosen], corners, owner[chosen], contact, surface, narrow)
        chosen, tips = chosen[tips.kept], tips.those_kept()
    lowest = _lowest_around(tips.spot, width, contact, fine, chosen, cells.lowest[chosen])
    # the part is no steeper than 45 degrees above a tip that is partly in the next cell
    highest = cells.highest[chosen] + np.where(tips.inside, 0.0, tips.width)
    lo, hi = fine.lo[chosen, :2], fine.hi[chosen, :2]
    return Sites(
        owner[chosen],
        square[chosen],
        lo,
        hi,
        tips.spot,
        lowest,
        highest,
        area[chosen],
        tips.width,
        tips.spread,
        tips.inside,
        whole[chosen],
    )


def _have_one_surface(patches: Patches, surface: Int64s, count: int) -> Bools:
    """Tell in which of `count` cells all patches belong to one surface; `surface` ``(t,)`` of each triangle."""
    cell, own = patches.owner[:, 0], surface[patches.owner[:, 1]]
    least, greatest = np.full(count, np.iinfo(np.int64).max), np.full(count, -1)
    np.minimum.at(least, cell, own)
    np.maximum.at(greatest, cell, own)
    return np.asarray(least >= greatest)


def _subdivided(columns: ConnectorColumns, count: int) -> tuple[ConnectorColumns, Int64s, Int64s]:
    """Return the cells of all columns, the column of each, and its indices in the fine grid."""
    owner = np.repeat(np.arange(len(columns.lo)), count * count)
    inner = np.tile(np.argwhere(np.ones((count, count))), (len(columns.lo), 1))
    square = columns.square[owner] * count + inner
    side = columns.grid[2] / count
    grid = np.array([columns.grid[0], columns.grid[1], side])
    lo, hi = columns.lo[owner].copy(), columns.hi[owner].copy()
    lo[:, :2], hi[:, :2] = (grid[:2] + (square[:, ::-1] + more) * side for more in (0, 1))
    ny, nx = columns.shape
    return ConnectorColumns(lo, hi, square, grid, (ny * count, nx * count)), owner, square


class _CellContacts(NamedTuple):
    """Contact in each cell: area in plan, centroid in plan, and mean, least and greatest height."""

    area: Floats
    centroid: Floats
    mean: Floats
    lowest: Floats
    highest: Floats


def _measured(patches: Patches, fine: ConnectorColumns) -> _CellContacts:
    count = len(fine.lo)
    area, middle = areas_in_plan(patches)
    cell = patches.owner[:, 0]
    total = np.asarray(np.bincount(cell, area, count), np.float64)
    safe = np.where(total > 0.0, total, 1.0)
    moments = [np.bincount(cell, area * middle[:, axis], count) / safe for axis in range(3)]
    lowest, highest = np.full(count, np.inf), np.full(count, -np.inf)
    corner = np.repeat(cell, np.diff(patches.start))
    np.minimum.at(lowest, corner, patches.points[:, 2])
    np.maximum.at(highest, corner, patches.points[:, 2])
    return _CellContacts(total, np.column_stack(moments[:2]), moments[2], lowest, highest)


def areas_in_plan(patches: Patches) -> tuple[Floats, Floats]:
    """Return the area in plan of each patch, ``(n,)``, and its centroid, ``(n, 3)``."""
    patch, inner, following = fans_of(patches)
    first = patches.points[patches.start[patch]]
    b, c = patches.points[inner], patches.points[following]
    area = np.abs(_turn(b - first, c - first)) / 2.0
    count = len(patches.owner)
    total = np.asarray(np.bincount(patch, area, count), np.float64)
    centre = (first + b + c) / 3.0
    middle = [np.bincount(patch, area * centre[:, axis], count) for axis in range(3)]
    return total, np.column_stack(middle) / np.maximum(total, 1e-15)[:, None]


def _turn(one: Floats, other: Floats) -> Floats:
    """Return the z component of the cross products of vectors in plan."""
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def fans_of(patches: Patches) -> tuple[Int64s, Int64s, Int64s]:
    """Divide patches into triangles from their first corner; return the patch, second and third corner of each."""
    patch = np.repeat(np.arange(len(patches.owner)), np.diff(patches.start))
    here = np.arange(len(patches.points))
    inner = (here > patches.start[:-1][patch]) & (here + 1 < patches.start[1:][patch])
    return patch[inner], here[inner], here[inner] + 1


def _spots(patches: Patches, fine: ConnectorColumns, cells: _CellContacts, width: float) -> Floats:
    """Return a point in plan of the contact in every cell.

    It is the centre of the cell if contact is there, otherwise the centroid of the contact, otherwise the centroid of
    the patch nearest to that. If the contact has a lowest point inside the cell, it is next to that point instead.
    """
    area, middle = areas_in_plan(patches)
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
    fraction = np.minimum(1.0, width / 2.0 / np.maximum(length, 1e-9))
    spot[cell] = bottom + inward * fraction[:, None]
    return np.asarray(spot)


def _contains(patches: Patches, spot: Floats) -> Bools:
    """Tell which cells have a patch above their point `spot` ``(c, 2)``."""
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


def _lowest_inside(patches: Patches, fine: ConnectorColumns, cells: _CellContacts) -> tuple[Int64s, Floats]:
    """Return the cells whose contact has its lowest point inside them, and these points in plan ``(n, 2)``."""
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
    """Return the least height of the contact within `width` around each spot, inside its cell."""
    low, high = fine.lo[chosen].copy(), fine.hi[chosen].copy()
    low[:, :2], high[:, :2] = squares_in_cells(spot, width, low[:, :2], high[:, :2])
    around = ConnectorColumns(low, high, fine.square[chosen], fine.grid, fine.shape)
    patches = clip_to_columns(around, contact, np.arange(len(contact)), np.ones(len(chosen), np.bool_))
    lowest = np.full(len(chosen), np.inf)
    np.minimum.at(lowest, np.repeat(patches.owner[:, 0], np.diff(patches.start)), patches.points[:, 2])
    return np.where(np.isfinite(lowest), lowest, otherwise)


def squares_in_cells(spot: Floats, width: Floats | float, lo: Floats, hi: Floats) -> tuple[Floats, Floats]:
    """Return squares of side `width` around points, moved into the cells from `lo` to `hi`; lower and upper corners.

    The width is one number, or ``(s, 1)`` mm.
    """
    corner = np.clip(spot - width / 2.0, lo, np.maximum(hi - width, lo))
    return corner, np.minimum(corner + width, hi)
