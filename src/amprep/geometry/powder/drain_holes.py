"""Ways out for powder that supports lock in: the shortest straight ones from each pocket to the outside."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.powder.pockets import Runs, Void, flood, free_runs_of

MOST_DRAINS = 2000
"""Ways that are sought in one support at most, for the largest pockets."""

_RUNS = 8
"""Of a pocket, the longest, from which ways are sought."""

_FARTHEST = 3.0
"""mm sideways."""

_WIDE = 1.05
"""Half the width of a way, as a share of the hole: its sides lie between the lines of the flood, not in them."""


class _Ways(NamedTuple):
    """Of which pocket each way is ``(n,)``, and its two ends ``(n, 3)`` mm."""

    pocket: Int64s
    start: Floats
    end: Floats


def find_drains(support: MeshArrays, parts: Sequence[MeshArrays], hole: float) -> list[tuple[Floats, Floats]]:
    """Return boxes (least and greatest corner, mm) which, cut out of a support, let powder out.

    Each leads from a pocket straight down, or straight aside along an axis, to where a ball of diameter `hole`
    gets out; through supports alone, not through parts. It is a little more than twice as wide as the hole.
    Pockets without such a way are left.
    """
    void = flood([support, *parts], hole)
    if not void.pocket.any():
        return []
    around = free_runs_of(void.lines, parts) if parts else None
    ways = _ways(void, around, _longest(void))
    length = np.abs(ways.end - ways.start).sum(axis=1)
    order = np.lexsort([np.arange(len(length)), np.round(length, 6), ways.pocket])
    _, first = np.unique(ways.pocket[order], return_index=True)
    start, end = ways.start[order[first]], ways.end[order[first]]
    beyond = np.where(np.abs(end - start) < 1e-9, _WIDE, _WIDE / 2.0) * hole
    return list(zip(np.minimum(start, end) - beyond, np.maximum(start, end) + beyond, strict=True))


def _longest(void: Void) -> Int64s:
    """Return the longest runs of each pocket, of those pockets that have the longest."""
    length = void.roomy.high - void.roomy.low
    chosen = np.flatnonzero(void.pocket)
    chosen = chosen[np.argsort(-length[chosen], kind="stable")]
    number, first, owner = np.unique(void.pocket[chosen], return_index=True, return_inverse=True)
    within = np.empty(len(chosen), np.int64)  # rank in its own pocket
    order = np.argsort(owner, kind="stable")
    sizes = np.bincount(owner, minlength=len(number))
    within[order] = np.arange(len(chosen)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    kept = np.isin(owner, np.argsort(first)[:MOST_DRAINS]) & (within < _RUNS)
    return np.asarray(chosen[kept])


def _ways(void: Void, around: Runs | None, run: Int64s) -> _Ways:
    """Return straight ways from runs of pockets to the outside: downwards, or aside at half their height."""
    lines, roomy, outside = void.lines, void.roomy, void.pocket == 0
    ny, nx = lines.shape
    line = np.searchsorted(roomy.start, run, side="right") - 1
    low = roomy.low[run].astype(np.float64)
    middle = (low + roomy.high[run]) / 2.0

    def place(at: Int64s, z: Floats) -> Floats:
        plan = lines.origin + (np.column_stack([at % nx, at // nx]) + 0.5) * lines.spacing
        return np.column_stack([plan, z])

    below = np.maximum(run - 1, 0)
    end = roomy.high[below].astype(np.float64)
    down = (run > roomy.start[line]) & outside[below]
    if around is not None:
        down &= around.at(line, low) == around.at(line, end)
    found = [_Ways(void.pocket[run[down]], place(line[down], low[down]), place(line[down], end[down]))]
    for step_y, step_x in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        going = np.arange(len(run))
        for step in range(1, int(_FARTHEST / lines.spacing) + 1):
            y, x = line[going] // nx + step * step_y, line[going] % nx + step * step_x
            inside = (y >= 0) & (y < ny) & (x >= 0) & (x < nx)
            going, at = going[inside], (y * nx + x)[inside]
            if around is not None:
                open_ = around.at(at, middle[going]) >= 0
                going, at = going[open_], at[open_]
            other = roomy.at(at, middle[going])
            out = (other >= 0) & outside[other]
            start, there = going[out], at[out]
            ends = place(line[start], middle[start]), place(there, middle[start])
            found.append(_Ways(void.pocket[run[start]], *ends))
            going = going[~out]
    return _Ways(*(np.concatenate(column) for column in zip(*found, strict=True)))
