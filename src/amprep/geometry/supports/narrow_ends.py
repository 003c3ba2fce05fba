"""Find the narrow ends and the waists of regions from their outlines."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.supports.outlines import Contours, as_outlines
from amprep.kernels.supports.outlines import PlaneOutlines

if TYPE_CHECKING:
    from amprep.kernels.supports.narrow_ends import OutlineBoxes, OutlineTurns
    from amprep.kernels.supports.narrow_places import SideGrids

CORNER = 1.3
"""Distance (in widths) by which corners may reach beyond the discs that fit into a region."""

NARROW = 0.7
"""Twice the area over the perimeter (in widths) up to which a piece of any size may be too thin everywhere."""

_SQUARE = 2.0
"""Size (in widths) of the squares in which sides are listed; pieces of sides are at most half as long."""

_MOST_SQUARES = 1_000_000
"""Largest number of squares; they are larger where there would be more."""

# Strategy. Kernels look at all sections of a support at once, because nearly all of them have no thin place, and then
# calls of array functions for each section would take longer than the work. Where a region becomes narrower and then
# wider again, one of its two sides turns inwards. So only such corners, and the ends at which an outline turns back,
# are compared with the sides near them. What a disc of the width near it covers is not thin.


def everywhere(points: Floats) -> Bools:
    """Choose all points ``(k, 2)``."""
    return np.ones(len(points), np.bool_)


def narrow_ends(
    region: Contours,
    width: float,
    area: float = 0.0,
    judged: Callable[[Floats], Bools] = everywhere,
    *,
    waists: bool = True,
) -> Floats:
    """Return the points ``(k, 2)`` mm at which the outline of a region turns back within a width.

    Those of pieces that are smaller than an area (mm2), those of small pieces that may be too thin, and the corners at
    waists are among them.

    Parameters
    ----------
    region
        A region.
    width, area
        Length (mm) of the outline within which it turns, and area (mm2).
    judged
        Tells which points ``(k, 2)`` mm are looked at.
    waists
        Whether corners at waists are among the points.
    """
    if not region.contours:
        return np.empty((0, 2))
    outlines = as_outlines(region)
    narrow, small = _narrow_vertices(outlines, [waists], width, area, judged)
    return np.concatenate([outlines.points[narrow], outlines.points[small]])


def narrow_ends_in(
    outlines: PlaneOutlines, waists: Sequence[bool], width: float, area: float
) -> dict[int, Floats]:
    """Return the narrow ends in all sections that have any, by their planes, see `narrow_ends`.

    Parameters
    ----------
    outlines
        The outlines of all sections.
    waists
        ``(p,)`` whether corners at waists are among the points of a section.
    width, area
        Length (mm) of the outline within which it turns, and area (mm2).
    """
    if not len(outlines.points):
        return {}
    narrow, small = _narrow_vertices(outlines, waists, width, area, everywhere)
    own = np.concatenate([np.flatnonzero(narrow), np.flatnonzero(small)])
    plane = np.searchsorted(outlines.first[outlines.begin], own, side="right") - 1
    return {each: outlines.points[own[plane == each]] for each in np.unique(plane).tolist()}


def _narrow_vertices(
    outlines: PlaneOutlines,
    waists: Sequence[bool],
    width: float,
    area: float,
    judged: Callable[[Floats], Bools],
) -> tuple[Bools, Bools]:
    """Return which vertices are at narrow ends or waists ``(n,)``, and which are of small pieces ``(n,)``."""
    from amprep.kernels.supports.narrow_ends import (
        NarrowVertices,
        OutlineBoxes,
        OutlineTurns,
        ThinLimits,
        find_narrow_vertices,
    )
    from amprep.kernels.supports.narrow_places import keep_narrow_places

    points = outlines.points
    vertices, contours = len(points), len(outlines.first) - 1
    turns = OutlineTurns(*np.empty((2, vertices), np.int64), *np.empty((2, vertices)))
    boxes = OutlineBoxes(*np.empty((2, contours, 2)), *np.empty((2, contours), np.bool_))
    inwards, ends, small = np.zeros((3, vertices), np.bool_)
    limits = ThinLimits(width, area, CORNER, NARROW)
    find_narrow_vertices(
        outlines, np.array(waists, np.bool_), limits, turns, boxes, NarrowVertices(inwards, ends, small)
    )
    asked = np.flatnonzero(inwards | ends | small)
    left_out = asked[~judged(points[asked])]
    for each in (inwards, ends, small):
        each[left_out] = False
    if inwards.any() or ends.any():
        keep_narrow_places(outlines, turns, _grids(outlines, boxes, turns, width), ends, inwards, width)
    return ends, small


def _grids(
    outlines: PlaneOutlines, boxes: "OutlineBoxes", turns: "OutlineTurns", width: float
) -> "SideGrids":
    """Return the grids of squares for the sides in each plane, with room for one of them."""
    from amprep.kernels.supports.narrow_places import SideGrids

    first, begin = outlines.first, outlines.begin
    plane = np.repeat(np.arange(len(begin) - 1), np.diff(begin))
    low, high = np.full((len(begin) - 1, 2), np.inf), np.full((len(begin) - 1, 2), -np.inf)
    np.minimum.at(low, plane, boxes.low)
    np.maximum.at(high, plane, boxes.high)
    low[np.diff(begin) == 0] = high[np.diff(begin) == 0] = 0.0
    square = np.maximum(_SQUARE * width, np.sqrt((high - low).prod(axis=1) / _MOST_SQUARES))
    squares = ((high - low) / square[:, None]).astype(np.int64) + 1
    around = np.diff(np.append(0.0, np.cumsum(turns.length))[first[begin]])
    pieces = int((np.diff(first[begin]) + 2.0 * around / square).max()) + 2
    room = np.empty(int(squares.prod(axis=1).max()) + 2, np.int64)
    return SideGrids(
        low, square, squares, np.empty(2), np.empty(2, np.int64), room, np.empty(pieces, np.int64)
    )
