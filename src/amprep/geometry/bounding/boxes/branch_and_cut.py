"""Cover cells of a grid with few blocks of cells, by branch and cut (thesis 2.3)."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Int64s

_ROOM = 100_000
"""Greatest number of first blocks; with more of them, those of most waste are left out and the gap stays open."""

_CHUNK = 64
"""First blocks between two questions whether to stop."""


class CellCover(NamedTuple):
    """A covering of cells, in cells.

    Attributes
    ----------
    blocks
        ``(k, 6)`` first cell and cell past the end; no rows if none has less waste than the limit.
    cells
        Number of cells in the union of the blocks, or the limit.
    bound
        No covering with as many blocks contains fewer cells.
    """

    blocks: Int64s
    cells: int
    bound: int


class _Budget:
    """Steps of work that are left, and the caller's request to stop."""

    def __init__(self, work: float, stop: Callable[[], bool]) -> None:
        self.left = np.array([int(work * 1e6), 0], np.int64)
        self._stop = stop

    def spent(self) -> bool:
        return bool(self.left[0] <= 0) or self._stop()


def cover_cells(
    required: Bools, count: int, *, limit: int, work: float, stop: Callable[[], bool]
) -> CellCover:
    """Cover cells with `count` blocks of least union.

    Strategy: as in the thesis, the first block is chosen among those that can be part of a least covering, then a
    covering of the rest with one block less; a covering counts only when no cell is left. The volume of a covering
    is that of the cells plus its waste, the other cells it contains. Waste only grows from block to block, so a
    block whose waste reaches the incumbent's is cut with all that follow it in the order by waste. Of n blocks that
    cover m cells one covers m / n; it is the first. For the last two blocks the best pair is found directly
    (Bespamyatnikh and Segal).

    Parameters
    ----------
    required
        ``(nx, ny, nz)`` cells to be covered.
    count
        Number of blocks, at least 2.
    limit
        Coverings with fewer cells than this are sought.
    work
        Millions of steps after which the search ends; about 15 per second.
    stop
        Tells when to end the search.

    Returns
    -------
    CellCover
        The best covering that was found. The search is complete where `bound` equals `cells`.
    """
    needed = int(required.sum())
    budget = _Budget(work, stop)
    waste, blocks, least = _branch(required, ~required, count, limit - needed, budget)
    return CellCover(blocks, needed + waste, needed + min(least, waste))


def _branch(
    required: Bools, waste: Bools, count: int, limit: int, budget: _Budget
) -> tuple[int, Int64s, int]:
    """Return the least waste below the limit or the limit, its blocks, and a lower bound on the waste."""
    from amprep.kernels.bounding.boxes.branch_and_cut import try_blocks

    none = np.empty((0, 6), np.int64)
    if limit <= 0 or not required.any():
        return (min(limit, 0), none, 0)
    if count == 2:
        first, complete = np.zeros((1, 8), np.int64), limit
    else:
        first, complete = _blocks_to_try(required, waste, count, limit, budget)
    if count <= 3:
        cells, sums, found = _outer_cells(required), _sums(waste), np.empty((3, 6), np.int64)
        best, blocks, tried = limit, none, 0
        while tried < len(first) and first[tried, 6] < best and not budget.spent():
            least = try_blocks(cells, sums, first[tried : tried + _CHUNK], best, budget.left, found)
            if found[0, 0] >= 0:
                best, blocks = least, found[3 - count :].copy()
            tried += max(int(budget.left[1]), 0)
        return best, blocks, min(_open(first, tried, complete), best)
    return _each_first_block(required, waste, count, limit, budget, first, complete)


def _each_first_block(
    required: Bools,
    waste: Bools,
    count: int,
    limit: int,
    budget: _Budget,
    first: Int64s,
    complete: int,
) -> tuple[int, Int64s, int]:
    best, blocks, bound = limit, np.empty((0, 6), np.int64), complete
    for number, block in enumerate(first):
        if block[6] >= best:
            break
        if budget.spent():
            bound = min(bound, int(block[6]))
            break
        x, y, z = (slice(int(block[axis]), int(block[axis + 3])) for axis in range(3))
        rest, unwanted = required.copy(), waste.copy()
        rest[x, y, z] = unwanted[x, y, z] = False
        found, others, least = _branch(rest, unwanted, count - 1, best - int(block[6]), budget)
        if found + block[6] < best:
            best, blocks = found + int(block[6]), np.vstack((first[number : number + 1, :6], others))
        bound = min(bound, least + int(block[6]))
    return best, blocks, min(bound, best)


def _open(first: Int64s, tried: int, complete: int) -> int:
    """Return the least waste of first blocks that were not tried."""
    return min(int(first[tried, 6]), complete) if tried < len(first) else complete


def _blocks_to_try(
    required: Bools, waste: Bools, count: int, limit: int, budget: _Budget
) -> tuple[Int64s, int]:
    """Return first blocks by increasing waste, and the waste below which all are listed."""
    from amprep.kernels.bounding.boxes.branch_and_cut import blocks_to_try

    room = np.empty((_ROOM, 8), np.int64)
    least = -(-int(required.sum()) // count)
    sums, unwanted, found = _sums(required), _sums(waste), -1
    budget.left[0] -= int(np.prod([n * (n + 1) // 2 for n in required.shape[:2]])) * required.shape[2]
    while found < 0:
        found = blocks_to_try(sums, unwanted, least, limit, room)
        complete, limit = limit, limit // 2
    blocks = room[:found]
    return np.ascontiguousarray(blocks[np.lexsort((-blocks[:, 7], blocks[:, 6]))]), complete


def _sums(cells: Bools) -> Int64s:
    """Return the number of cells below each corner of the grid, ``(nx + 1, ny + 1, nz + 1)``."""
    return np.pad(cells.astype(np.int64).cumsum(0).cumsum(1).cumsum(2), ((1, 0), (1, 0), (1, 0)))


def _outer_cells(required: Bools) -> Int64s:
    """Return the cells without those that have all six neighbours: blocks that cover these cover those as well."""
    inner = required.copy()
    wide = np.pad(required, 1)
    for axis in range(3):
        for step in (-1, 1):
            inner &= np.roll(wide, step, axis)[1:-1, 1:-1, 1:-1]
    return np.ascontiguousarray(np.argwhere(required & ~inner))
