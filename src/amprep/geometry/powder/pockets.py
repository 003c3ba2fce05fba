"""Finds loose powder that cannot leave: flood fill of the space that solids leave free, for a ball of a given width."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Float32s, Floats, Int64s, MeshArrays

MOST_LINES = 12_000_000
"""Lines through one group of solids; beyond that they stand further apart than asked."""

_OFF = np.array([0.137, 0.291])
"""Of the spacing: lines keep off planes in which vertices tend to lie."""

_ABOVE = 1e6
"""mm; where runs end that nothing closes above."""


class Pocket(NamedTuple):
    """Powder that cannot leave.

    Attributes
    ----------
    volume
        mm3.
    point
        A point in it, where it is highest.
    lo, hi
        Corners of its box.
    closed
        Whether it has no way out at all; else its ways out are too narrow.
    """

    volume: float
    point: tuple[float, float, float]
    lo: tuple[float, float, float]
    hi: tuple[float, float, float]
    closed: bool


class Lines(NamedTuple):
    """Upright lines: ``(y, x)`` of `shape` stands at ``origin + (x + 0.5, y + 0.5) * spacing``."""

    origin: Floats
    spacing: float
    shape: tuple[int, int]


class Runs(NamedTuple):
    """Free intervals of lines: those of line i are ``start[i] .. start[i + 1]``."""

    start: Int64s
    low: Float32s
    high: Float32s

    def at(self, line: Int64s, height: Floats) -> Int64s:
        """Return the run at each height ``(k,)`` of a line ``(k,)``, or -1."""
        index, end = self.start[line], self.start[line + 1]
        last = end.copy()
        while (index < last).any():  # halving, on every line at once
            middle = (index + last) // 2
            above = self.high[np.minimum(middle, len(self.high) - 1)] < height
            index, last = np.where(above & (index < last), middle + 1, index), np.where(above, last, middle)
        at = np.minimum(index, len(self.low) - 1)
        return np.where((index < end) & (self.low[at] <= height), index, -1)


class Void(NamedTuple):
    """The space that solids leave free, as a ball of some width can use it.

    Attributes
    ----------
    free, roomy
        Where lines are free, and where the ball's centre may be.
    pocket
        ``(n,)`` for each roomy run the number of its pocket, 0 for the outside.
    """

    lines: Lines
    free: Runs
    roomy: Runs
    pocket: Int64s


def spacing_for(hole: float, size: Floats) -> float:
    """Return how far apart lines through a box of `size` stand: half of the hole, unless they get too many."""
    area = float((size[:2] + 6.0 * hole).prod())
    return max(hole / 2.0, float(np.sqrt(area / MOST_LINES)))


def find_pockets(supports: Sequence[MeshArrays], parts: Sequence[MeshArrays], hole: float) -> list[Pocket]:
    """Return the pockets that a ball of diameter `hole` cannot leave, the largest first.

    The plate, z = 0, closes the space below; above and sideways it is open. Upright lines half of the hole
    apart are cut by the solids exactly; a ball's centre is where its own line is free as far up and down as
    its radius, and the four lines around it beside it. Ways less than 0.7 of `hole` wide count as closed and
    ways half as wide again as open; in between it depends on where the lines fall and how the way runs. What
    the parts would lock in without supports does not count, nor does a pocket that is nowhere wide enough for
    the square around the ball: 1.4 times `hole`.

    Parameters
    ----------
    supports, parts
        Closed meshes, vertices ``(n, 3)`` mm and triangles ``(m, 3)``.
    hole
        mm, above 0.
    """
    if not supports:
        return []
    void = flood([*supports, *parts], hole)
    if not void.pocket.any():
        return []
    found = _listed(*void, hole / 2.0)
    if not parts:
        return found
    own = _roomy_runs(void.lines, free_runs_of(void.lines, parts), hole / 2.0)
    return _unless_own(found, void.lines, own, hole / 2.0)


def flood(solids: Sequence[MeshArrays], hole: float) -> Void:
    """Find where a ball of diameter `hole` mm may be between solids, and from where it does not get out."""
    lines = _lines(solids, hole)
    free = free_runs_of(lines, solids)
    roomy = _roomy_runs(lines, free, hole / 2.0)
    return Void(lines, free, roomy, _with_room(lines, free, roomy, _pockets(lines, roomy, hole / 2.0)))


def _lines(solids: Sequence[MeshArrays], hole: float) -> Lines:
    """Stand lines over all solids and at least two beside them on each side."""
    low = np.min([points.min(axis=0) for points, _ in solids], axis=0)
    high = np.max([points.max(axis=0) for points, _ in solids], axis=0)
    spacing = spacing_for(hole, high - low)
    nx, ny = (np.ceil((high - low)[:2] / spacing) + 5).astype(int).tolist()
    return Lines(low[:2] - (2.5 + _OFF) * spacing, spacing, (ny, nx))


def free_runs_of(lines: Lines, solids: Sequence[MeshArrays]) -> Runs:
    """Return where lines are free of solids, above the plate."""
    from amprep.kernels.voxels.powder import cross_lines, free_runs

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
    total = free_runs(first, heights, signs, _ABOVE, start, low, high)
    return Runs(start, low[:total], high[:total])


def _roomy_runs(lines: Lines, free: Runs, radius: float) -> Runs:
    from amprep.kernels.voxels.powder import roomy_runs

    start = np.empty_like(free.start)
    low, high = np.empty((2, 5 * len(free.low)), np.float32)
    most = 5 * int(np.diff(free.start).max())
    spare = np.empty((2, 2, most), np.float32)
    total = roomy_runs(lines.shape, radius, *free, start, low, high, spare)
    return Runs(start, low[:total], high[:total])


def _pockets(lines: Lines, runs: Runs, radius: float) -> Int64s:
    """Return the number of each run's pocket, 0 for the outside."""
    from amprep.kernels.voxels.powder import join_runs

    parent = np.empty(len(runs.low) + 1, np.int32)
    join_runs(lines.shape, *runs, _ABOVE - 2.0 * radius, parent)
    return parent[1:].astype(np.int64)


def _with_room(lines: Lines, free: Runs, roomy: Runs, pocket: Int64s) -> Int64s:
    """Return the pockets, but for those nowhere as wide as the square around the ball: they count as outside."""
    from amprep.kernels.voxels.powder import find_wide

    chosen = np.flatnonzero(pocket)
    line = np.searchsorted(roomy.start, chosen, side="right") - 1
    spare = np.empty((2, 2, 5 * int(np.diff(free.start).max())), np.float32)
    wide = np.zeros(len(chosen), np.bool_)
    find_wide(lines.shape, *free, line, roomy.low[chosen], roomy.high[chosen], spare, wide)
    return np.where(np.isin(pocket, pocket[chosen[wide]]), pocket, 0)


def _listed(lines: Lines, free: Runs, roomy: Runs, pocket: Int64s, radius: float) -> list[Pocket]:
    """Describe the pockets of roomy runs: whole cavities if they are closed, else what the ball can reach."""
    around = _pockets(lines, free, 0.0)
    chosen = np.flatnonzero(pocket)
    line = np.searchsorted(roomy.start, chosen, side="right") - 1
    low, high = roomy.low[chosen].astype(np.float64), roomy.high[chosen].astype(np.float64)
    order = np.lexsort([low - high, pocket[chosen]])  # the longest run of each pocket first
    longest = order[np.unique(pocket[chosen][order], return_index=True)[1]]
    middle = (low[longest] + high[longest]) / 2.0
    cavity = around[free.at(line[longest], middle)]
    swept = _swept(lines, line, low, high, np.unique(pocket[chosen], return_inverse=True)[1], radius)
    open_ = [
        _pocket(lines, *swept, int(n), line[longest[n]], middle[n], False)
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
        closed.append(_pocket(lines, *whole, number, line[longest[best]], middle[best], True))
    return sorted(open_ + closed, key=lambda each: (-each.volume, each.point))


def _swept(
    lines: Lines, line: Int64s, low: Floats, high: Floats, label: Int64s, radius: float
) -> tuple[Int64s, Floats, Floats, Int64s]:
    """Return the runs that balls cover whose centres are on the given ones: those and the lines beside them."""
    nx = lines.shape[1]
    sides = np.array([0, -1, 1, -nx, nx])
    up = np.where(sides == 0, radius, 0.0)
    at = (line[:, None] + sides).ravel()
    bottom, lid = (low[:, None] - up).ravel(), (high[:, None] + up).ravel()
    owner = np.repeat(label, len(sides))
    order = np.lexsort([bottom, at, owner])
    at, bottom, lid, owner = at[order], bottom[order], lid[order], owner[order]
    # what overlaps on one line is one run: a running maximum of the lids, kept apart by line and pocket
    group = np.cumsum(np.concatenate([[0], (np.diff(at) != 0) | (np.diff(owner) != 0)]))
    span = 2.0 * (np.abs(lid).max() + np.abs(bottom).max() + 1.0)
    reach = np.maximum.accumulate(lid + group * span)
    begins = np.concatenate([[True], bottom[1:] + group[1:] * span > reach[:-1]])
    ends = np.concatenate([np.flatnonzero(begins)[1:] - 1, [len(at) - 1]])
    return at[begins], bottom[begins], reach[ends] - group[ends] * span, owner[begins]


def _pocket(
    lines: Lines,
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


def _unless_own(found: list[Pocket], lines: Lines, parts: Runs, radius: float) -> list[Pocket]:
    """Leave out pockets that parts lock in by themselves."""
    pocket = _pockets(lines, parts, radius)
    place = np.array([each.point for each in found]).reshape(-1, 3)
    x, y = np.floor((place[:, :2] - lines.origin) / lines.spacing).astype(np.int64).T
    run = parts.at(y * lines.shape[1] + x, place[:, 2])
    locked = (run >= 0) & (pocket[run] != 0)
    return [each for each, own in zip(found, locked.tolist(), strict=True) if not own]
