"""Find drain holes for trapped powder: the shortest straight holes from each pocket to the outside."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.powder.pockets import FreeSpace, Intervals, flood_fill, free_intervals_of

MOST_DRAIN_HOLES = 2000
"""Greatest number of pockets of one support for which drain holes are searched: those with the longest intervals."""

_INTERVALS = 8
"""Number of longest free intervals per pocket from which drain holes are searched."""

_FARTHEST = 3.0
"""Greatest horizontal length of a drain hole, mm."""

_WIDE = 1.05
"""Half the width of a drain hole, in ball diameters: its sides pass between the lines of the flood fill."""


class _Holes(NamedTuple):
    """The pocket of each hole ``(n,)``, and the two ends of its axis ``(n, 3)`` mm."""

    pocket: Int64s
    start: Floats
    end: Floats


def find_drain_holes(
    support: MeshArrays, parts: Sequence[MeshArrays], diameter: float
) -> list[tuple[Floats, Floats]]:
    """Return boxes (least and greatest corner, mm) that let the powder out when they are subtracted from a support.

    Each box leads from a pocket straight down, or horizontally along an axis, to a point from which a ball of the
    given diameter can escape. It passes through supports only, not through parts, and is a little more than twice
    as wide as the ball. Pockets without such a hole are left out.

    Parameters
    ----------
    support, parts
        Closed meshes, vertices ``(n, 3)`` mm and triangles ``(m, 3)``.
    diameter
        Diameter of the ball, mm.
    """
    space = flood_fill([support, *parts], diameter)
    if not space.pocket.any():
        return []
    around = free_intervals_of(space.lines, parts) if parts else None
    holes = _straight_holes(space, around, _longest(space))
    length = np.abs(holes.end - holes.start).sum(axis=1)
    order = np.lexsort([np.arange(len(length)), np.round(length, 6), holes.pocket])
    _, first = np.unique(holes.pocket[order], return_index=True)
    start, end = holes.start[order[first]], holes.end[order[first]]
    beyond = np.where(np.abs(end - start) < 1e-9, _WIDE, _WIDE / 2.0) * diameter
    return list(zip(np.minimum(start, end) - beyond, np.maximum(start, end) + beyond, strict=True))


def _longest(space: FreeSpace) -> Int64s:
    """Return the longest intervals of each pocket, for the pockets with the longest ones."""
    length = space.centres.high - space.centres.low
    chosen = np.flatnonzero(space.pocket)
    chosen = chosen[np.argsort(-length[chosen], kind="stable")]
    number, first, owner = np.unique(space.pocket[chosen], return_index=True, return_inverse=True)
    within = np.empty(len(chosen), np.int64)  # rank in the pocket
    order = np.argsort(owner, kind="stable")
    sizes = np.bincount(owner, minlength=len(number))
    within[order] = np.arange(len(chosen)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    kept = np.isin(owner, np.argsort(first)[:MOST_DRAIN_HOLES]) & (within < _INTERVALS)
    return np.asarray(chosen[kept])


def _straight_holes(space: FreeSpace, around: Intervals | None, interval: Int64s) -> _Holes:
    """Return straight holes from intervals of pockets to the outside: down, or horizontally at half their height."""
    lines, centres, outside = space.lines, space.centres, space.pocket == 0
    ny, nx = lines.shape
    line = np.searchsorted(centres.start, interval, side="right") - 1
    low = centres.low[interval].astype(np.float64)
    middle = (low + centres.high[interval]) / 2.0

    def place(at: Int64s, z: Floats) -> Floats:
        plan = lines.origin + (np.column_stack([at % nx, at // nx]) + 0.5) * lines.spacing
        return np.column_stack([plan, z])

    below = np.maximum(interval - 1, 0)
    end = centres.high[below].astype(np.float64)
    down = (interval > centres.start[line]) & outside[below]
    if around is not None:
        down &= around.at(line, low) == around.at(line, end)
    found = [_Holes(space.pocket[interval[down]], place(line[down], low[down]), place(line[down], end[down]))]
    for step_y, step_x in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        going = np.arange(len(interval))
        for step in range(1, int(_FARTHEST / lines.spacing) + 1):
            y, x = line[going] // nx + step * step_y, line[going] % nx + step * step_x
            inside = (y >= 0) & (y < ny) & (x >= 0) & (x < nx)
            going, at = going[inside], (y * nx + x)[inside]
            if around is not None:
                open_ = around.at(at, middle[going]) >= 0
                going, at = going[open_], at[open_]
            other = centres.at(at, middle[going])
            out = (other >= 0) & outside[other]
            start, there = going[out], at[out]
            ends = place(line[start], middle[start]), place(there, middle[start])
            found.append(_Holes(space.pocket[interval[start]], *ends))
            going = going[~out]
    return _Holes(*(np.concatenate(column) for column in zip(*found, strict=True)))
