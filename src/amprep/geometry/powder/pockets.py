"""Find trapped powder: flood fill of the free space between solids, for a ball of a given diameter."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Float32s, Floats, Int64s, MeshArrays

MOST_LINES = 12_000_000
"""Greatest number of lines through one group of solids; the spacing grows where more would be needed."""

_OFF = np.array([0.137, 0.291])
"""Offset of the lines, as a fraction of the spacing, from planes that often contain vertices."""

_ABOVE = 1e6
"""Upper end (mm) of intervals that no solid closes above."""


class Pocket(NamedTuple):
    """A connected region of trapped powder.

    Attributes
    ----------
    volume
        Volume of the trapped powder, mm3.
    point
        A point inside, on its highest line.
    lo, hi
        Corners of its bounding box, mm.
    closed
        True if no opening leads outside; else all openings are too narrow.
    """

    volume: float
    point: tuple[float, float, float]
    lo: tuple[float, float, float]
    hi: tuple[float, float, float]
    closed: bool


class LineGrid(NamedTuple):
    """Vertical lines on a square grid: line (y, x) of `shape` is at ``origin + (x + 0.5, y + 0.5) * spacing``."""

    origin: Floats
    spacing: float
    shape: tuple[int, int]


class Intervals(NamedTuple):
    """Free intervals of lines, in mm of height; line i has the intervals ``start[i] .. start[i + 1]``."""

    start: Int64s
    low: Float32s
    high: Float32s

    def at(self, line: Int64s, height: Floats) -> Int64s:
        """Return the interval that contains each height ``(k,)`` on a line ``(k,)``, or -1."""
        index, end = self.start[line], self.start[line + 1]
        last = end.copy()
        while (index < last).any():  # binary search, on all lines at once
            middle = (index + last) // 2
            above = self.high[np.minimum(middle, len(self.high) - 1)] < height
            index, last = np.where(above & (index < last), middle + 1, index), np.where(above, last, middle)
        at = np.minimum(index, len(self.low) - 1)
        return np.where((index < end) & (self.low[at] <= height), index, -1)


class FreeSpace(NamedTuple):
    """The free space between solids, and the part of it that a ball can use.

    Attributes
    ----------
    free, centres
        Intervals where lines are free, and where the centre of the ball can be.
    pocket
        ``(n,)`` number of the pocket of each interval of `centres`, 0 for the outside.
    """

    lines: LineGrid
    free: Intervals
    centres: Intervals
    pocket: Int64s


def spacing_for(diameter: float, size: Floats) -> float:
    """Return the spacing of lines through a box of `size` mm: half a diameter, unless there would be too many."""
    area = float((size[:2] + 6.0 * diameter).prod())
    return max(diameter / 2.0, float(np.sqrt(area / MOST_LINES)))


def find_pockets(
    supports: Sequence[MeshArrays], parts: Sequence[MeshArrays], diameter: float
) -> list[Pocket]:
    """Return the pockets that a ball of the given diameter cannot leave, the largest first.

    The plate, z = 0, closes the space below; above and at the sides it is open. The solids cut vertical lines, half
    a diameter apart, exactly. The centre of the ball can be where its own line is free as far up and down as its
    radius, and the four neighbouring lines are free beside it. Openings narrower than 0.7 diameters count as closed,
    openings wider than 1.5 diameters as open; between these, it depends on the positions of the lines and on the
    direction of the opening. Powder that the parts trap without supports does not count, nor does a pocket that is
    nowhere wide enough for the square around the ball: 1.4 diameters.

    Parameters
    ----------
    supports, parts
        Closed meshes, vertices ``(n, 3)`` mm and triangles ``(m, 3)``.
    diameter
        Diameter of the ball, mm; above 0.
    """
    if not supports:
        return []
    space = flood_fill([*supports, *parts], diameter)
    if not space.pocket.any():
        return []
    found = _describe(*space, diameter / 2.0)
    if not parts:
        return found
    own = _centre_intervals(space.lines, free_intervals_of(space.lines, parts), diameter / 2.0)
    return _without_own(found, space.lines, own, diameter / 2.0)


def flood_fill(solids: Sequence[MeshArrays], diameter: float) -> FreeSpace:
    """Find where a ball can be between solids, and from where it cannot escape."""
    lines = _lines(solids, diameter)
    free = free_intervals_of(lines, solids)
    centres = _centre_intervals(lines, free, diameter / 2.0)
    return FreeSpace(
        lines, free, centres, _with_room(lines, free, centres, _pockets(lines, centres, diameter / 2.0))
    )


def _lines(solids: Sequence[MeshArrays], diameter: float) -> LineGrid:
    """Return lines through all solids, and at least two more on each side of them."""
    low = np.min([points.min(axis=0) for points, _ in solids], axis=0)
    high = np.max([points.max(axis=0) for points, _ in solids], axis=0)
    spacing = spacing_for(diameter, high - low)
    nx, ny = (np.ceil((high - low)[:2] / spacing) + 5).astype(int).tolist()
    return LineGrid(low[:2] - (2.5 + _OFF) * spacing, spacing, (ny, nx))


def free_intervals_of(lines: LineGrid, solids: Sequence[MeshArrays]) -> Intervals:
    """Return the intervals of the lines above the plate that no solid covers."""
    from amprep.kernels.voxels.powder import cross_lines, free_intervals

    meshes = [
        (np.ascontiguousarray(points - (*lines.origin, 0.0)), np.ascontiguousarray(triangles, np.int64))
        for points, triangles in solids
    ]
    count = lines.shape[0] * lines.shape[1]
    place, none = np.zeros(count, np.int64), np.empty(0, np.float32)
    for points, triangles in meshes:
        cross_lines(points, triangles, lines.spacing, lines.shape, place, none, np.empty(0, np.int8))
    first = np.concatenate([[0], np.cumsum(place)])
    heights, signs = np.empty(first[-1], np.float32), np.empty(first[-1], np.int8)
    place = first[:-1].copy()
    for points, triangles in meshes if first[-1] else ():
        cross_lines(points, triangles, lines.spacing, lines.shape, place, heights, signs)
    start = np.empty(count + 1, np.int64)
    low, high = np.empty((2, first[-1] + count), np.float32)
    total = free_intervals(first, heights, signs, _ABOVE, start, low, high)
    return Intervals(start, low[:total], high[:total])


def _centre_intervals(lines: LineGrid, free: Intervals, radius: float) -> Intervals:
    from amprep.kernels.voxels.powder import centre_intervals

    start = np.empty_like(free.start)
    low, high = np.empty((2, 5 * len(free.low)), np.float32)
    most = 5 * int(np.diff(free.start).max())
    spare = np.empty((2, 2, most), np.float32)
    total = centre_intervals(lines.shape, radius, *free, start, low, high, spare)
    return Intervals(start, low[:total], high[:total])


def _pockets(lines: LineGrid, intervals: Intervals, radius: float) -> Int64s:
    """Return the number of each interval's pocket, 0 for the outside."""
    from amprep.kernels.voxels.powder import connect_intervals

    parent = np.empty(len(intervals.low) + 1, np.int32)
    connect_intervals(lines.shape, *intervals, _ABOVE - 2.0 * radius, parent)
    return parent[1:].astype(np.int64)


def _with_room(lines: LineGrid, free: Intervals, centres: Intervals, pocket: Int64s) -> Int64s:
    """Return the pockets; those nowhere as wide as the square around the ball count as outside."""
    from amprep.kernels.voxels.powder import find_wide

    chosen = np.flatnonzero(pocket)
    line = np.searchsorted(centres.start, chosen, side="right") - 1
    spare = np.empty((2, 2, 5 * int(np.diff(free.start).max())), np.float32)
    wide = np.zeros(len(chosen), np.bool_)
    find_wide(lines.shape, *free, line, centres.low[chosen], centres.high[chosen], spare, wide)
    return np.where(np.isin(pocket, pocket[chosen[wide]]), pocket, 0)


def _describe(
    lines: LineGrid, free: Intervals, centres: Intervals, pocket: Int64s, radius: float
) -> list[Pocket]:
    """Describe the pockets: whole cavities if they are closed, else the region that the ball can reach."""
    around = _pockets(lines, free, 0.0)
    chosen = np.flatnonzero(pocket)
    line = np.searchsorted(centres.start, chosen, side="right") - 1
    low, high = centres.low[chosen].astype(np.float64), centres.high[chosen].astype(np.float64)
    order = np.lexsort([low - high, pocket[chosen]])  # the longest interval of each pocket first
    longest = order[np.unique(pocket[chosen][order], return_index=True)[1]]
    middle = (low[longest] + high[longest]) / 2.0
    cavity = around[free.at(line[longest], middle)]
    swept = _swept(lines, line, low, high, np.unique(pocket[chosen], return_inverse=True)[1], radius)
    open_ = [
        _describe_one(lines, *swept, int(n), line[longest[n]], middle[n], False)
        for n in np.flatnonzero(cavity == 0)
    ]
    inside = np.flatnonzero(np.isin(around, cavity[cavity > 0]))
    numbers, label = np.unique(around[inside], return_inverse=True)
    whole = (
        np.searchsorted(free.start, inside, side="right") - 1,
        free.low[inside].astype(np.float64),
        free.high[inside].astype(np.float64),
        label,
    )
    closed = []
    for number, one in enumerate(numbers):
        within = np.flatnonzero(cavity == one)
        best = within[(high - low)[longest[within]].argmax()]
        closed.append(_describe_one(lines, *whole, number, line[longest[best]], middle[best], True))
    return sorted(open_ + closed, key=lambda each: (-each.volume, each.point))


def _swept(
    lines: LineGrid, line: Int64s, low: Floats, high: Floats, label: Int64s, radius: float
) -> tuple[Int64s, Floats, Floats, Int64s]:
    """Return the intervals covered by balls with centres on the given ones: on the same and on neighbouring lines."""
    nx = lines.shape[1]
    sides = np.array([0, -1, 1, -nx, nx])
    up = np.where(sides == 0, radius, 0.0)
    at = (line[:, None] + sides).ravel()
    bottom, top = (low[:, None] - up).ravel(), (high[:, None] + up).ravel()
    owner = np.repeat(label, len(sides))
    order = np.lexsort([bottom, at, owner])
    at, bottom, top, owner = at[order], bottom[order], top[order], owner[order]
    # merge intervals that overlap on one line: a running maximum of the tops, separate for each line and pocket
    group = np.cumsum(np.concatenate([[0], (np.diff(at) != 0) | (np.diff(owner) != 0)]))
    span = 2.0 * (np.abs(top).max() + np.abs(bottom).max() + 1.0)
    reach = np.maximum.accumulate(top + group * span)
    begins = np.concatenate([[True], bottom[1:] + group[1:] * span > reach[:-1]])
    ends = np.concatenate([np.flatnonzero(begins)[1:] - 1, [len(at) - 1]])
    return at[begins], bottom[begins], reach[ends] - group[ends] * span, owner[begins]


def _describe_one(
    lines: LineGrid,
    line: Int64s,
    low: Floats,
    high: Floats,
    label: Int64s,
    number: int,
    at: int,
    z: float,
    closed: bool,
) -> Pocket:
    own = label == number
    x, y = line[own] % lines.shape[1], line[own] // lines.shape[1]
    half = lines.spacing / 2.0
    plan = lines.origin + (np.array([[x.min(), y.min()], [x.max(), y.max()]]) + 0.5) * lines.spacing
    point = lines.origin + (np.array([at % lines.shape[1], at // lines.shape[1]]) + 0.5) * lines.spacing
    return Pocket(
        float((high[own] - low[own]).sum()) * lines.spacing**2,
        (float(point[0]), float(point[1]), float(z)),
        (float(plan[0, 0]) - half, float(plan[0, 1]) - half, float(low[own].min())),
        (float(plan[1, 0]) + half, float(plan[1, 1]) + half, float(high[own].max())),
        closed,
    )


def _without_own(found: list[Pocket], lines: LineGrid, parts: Intervals, radius: float) -> list[Pocket]:
    """Return the pockets without those that the parts enclose by themselves."""
    pocket = _pockets(lines, parts, radius)
    place = np.array([each.point for each in found]).reshape(-1, 3)
    x, y = np.floor((place[:, :2] - lines.origin) / lines.spacing).astype(np.int64).T
    interval = parts.at(y * lines.shape[1] + x, place[:, 2])
    locked = (interval >= 0) & (pocket[interval] != 0)
    return [each for each, own in zip(found, locked.tolist(), strict=True) if not own]
