"""Branch and cut over blocks of cells: the first block of a covering, and the best two for the rest.

Arrays count cells. A block is a row of its first cell and the cell past its end. ``sums[i, j, k]`` counts the marked
cells with indices below i, j, k, so that a block is counted with eight of them.
"""

import numpy as np
from numba import njit

from amprep.arrays import Int64s
from amprep.kernels.helper import helper

_FAR = 1 << 40


@helper
def _count(sums: Int64s, x0: int, y0: int, z0: int, x1: int, y1: int, z1: int) -> int:
    if x0 >= x1 or y0 >= y1 or z0 >= z1:
        return 0
    upper = sums[x1, y1, z1] - sums[x0, y1, z1] - sums[x1, y0, z1] + sums[x0, y0, z1]
    lower = sums[x1, y1, z0] - sums[x0, y1, z0] - sums[x1, y0, z0] + sums[x0, y0, z0]
    return int(upper - lower)


@helper
def _count_block(sums: Int64s, b: Int64s) -> int:
    return int(_count(sums, b[0], b[1], b[2], b[3], b[4], b[5]))


@helper
def _undominated(required: Int64s, waste: Int64s, b: Int64s, inside: int, wasted: int) -> bool:
    """Tell whether a block is the smallest around what it covers, and cannot be enlarged for nothing."""
    for axis in range(3):
        low, high = b[axis], b[axis + 3]
        b[axis] = low + 1
        loose = _count_block(required, b) == inside
        b[axis] = low
        b[axis + 3] = high - 1
        loose |= _count_block(required, b) == inside
        b[axis + 3] = high
        if loose:
            return False
    for axis in range(3):
        low, high = b[axis], b[axis + 3]
        dominated = False
        if low > 0:
            b[axis] = low - 1
            dominated |= _count_block(required, b) > inside and _count_block(waste, b) == wasted
            b[axis] = low
        if high < required.shape[axis] - 1:
            b[axis + 3] = high + 1
            dominated |= _count_block(required, b) > inside and _count_block(waste, b) == wasted
            b[axis + 3] = high
        if dominated:
            return False
    return True


@njit(cache=True)
def blocks_to_try(required: Int64s, waste: Int64s, least: int, limit: int, blocks: Int64s) -> int:
    """List the blocks that can be the one with most required cells in a covering with little waste.

    A block is left out if a smaller one covers the same cells, or a larger one more of them without more waste:
    an optimal covering with it stays optimal with the other.

    Parameters
    ----------
    required, waste
        Sums of the cells that are to be covered, and of those whose covering is waste.
    least
        Least number of required cells of a block.
    limit
        Waste of a block is below this.
    blocks
        ``(n, 8)``, receives blocks, their waste and their number of required cells.

    Returns
    -------
    int
        Number of blocks; -1 if there is no room for them.
    """
    nx, ny, nz = required.shape[0] - 1, required.shape[1] - 1, required.shape[2] - 1
    b = np.empty(6, np.int64)
    found = 0
    for x0 in range(nx):
        for x1 in range(x0 + 1, nx + 1):
            if _count(required, x0, 0, 0, x1, ny, nz) < least:
                continue
            for y0 in range(ny):
                for y1 in range(y0 + 1, ny + 1):
                    if _count(required, x0, y0, 0, x1, y1, nz) < least:
                        continue
                    for z0 in range(nz):
                        if _count(required, x0, y0, z0, x1, y1, nz) < least:
                            break
                        for z1 in range(z0 + 1, nz + 1):
                            wasted = _count(waste, x0, y0, z0, x1, y1, z1)
                            if wasted >= limit:
                                break
                            inside = _count(required, x0, y0, z0, x1, y1, z1)
                            if inside < least:
                                continue
                            b[0], b[1], b[2], b[3], b[4], b[5] = x0, y0, z0, x1, y1, z1
                            if not _undominated(required, waste, b, inside, wasted):
                                continue
                            if found == len(blocks):
                                return -1
                            for c in range(6):
                                blocks[found, c] = b[c]
                            blocks[found, 6], blocks[found, 7] = wasted, inside
                            found += 1
    return found


@helper
def _enclose_beyond(cells: Int64s, first: Int64s, beyond: Int64s) -> bool:
    """Enclose the cells outside a block, below and above each plane; tell whether there are any."""
    beyond[:, :, :3] = _FAR
    beyond[:, :, 3:] = -_FAR
    some = False
    for i in range(len(cells)):
        inside = True
        for c in range(3):
            inside &= first[c] <= cells[i, c] < first[c + 3]
        if inside:
            continue
        some = True
        for axis in range(3):
            for c in range(3):
                at = cells[i, c]
                k = cells[i, axis]
                beyond[axis, k + 1, c] = min(beyond[axis, k + 1, c], at)
                beyond[axis, k + 1, c + 3] = max(beyond[axis, k + 1, c + 3], at + 1)
                beyond[axis + 3, k, c] = min(beyond[axis + 3, k, c], at)
                beyond[axis + 3, k, c + 3] = max(beyond[axis + 3, k, c + 3], at + 1)
    last = beyond.shape[1] - 1
    for axis in range(3):
        for k in range(1, last + 1):
            for c in range(3):
                beyond[axis, k, c] = min(beyond[axis, k, c], beyond[axis, k - 1, c])
                beyond[axis, k, c + 3] = max(beyond[axis, k, c + 3], beyond[axis, k - 1, c + 3])
                low = last - k
                beyond[axis + 3, low, c] = min(beyond[axis + 3, low, c], beyond[axis + 3, low + 1, c])
                beyond[axis + 3, low, c + 3] = max(
                    beyond[axis + 3, low, c + 3], beyond[axis + 3, low + 1, c + 3]
                )
    return some


@helper
def _join(a: Int64s, b: Int64s, out: Int64s) -> None:
    for c in range(3):
        out[c] = min(a[c], b[c])
        out[c + 3] = max(a[c + 3], b[c + 3])


@helper
def _new_waste(waste: Int64s, block: Int64s, first: Int64s, common: Int64s) -> int:
    """Count the waste of a block outside the first block."""
    for c in range(3):
        common[c] = max(block[c], first[c])
        common[c + 3] = min(block[c + 3], first[c + 3])
    return int(_count_block(waste, block) - _count_block(waste, common))


@njit(cache=True)
def try_blocks(cells: Int64s, waste: Int64s, blocks: Int64s, limit: int, work: Int64s, found: Int64s) -> int:
    """For each first block, find the two blocks that cover the other cells with the least waste.

    Strategy: as for two boxes in space, one of the two blocks has three faces of the enclosing block of what is
    left, its three other faces are tried on all planes, and the other block encloses what is beyond them. Waste
    only grows with a block, which ends each loop at the incumbent.

    Parameters
    ----------
    cells
        ``(m, 3)`` cells to be covered; those that have all six neighbours among them may be left out.
    waste
        Sums of the cells whose covering is waste.
    blocks
        ``(n, 8)`` first blocks with their waste, least first.
    limit
        Only coverings with less waste are wanted.
    work
        ``(1,)`` steps that are allowed; receives what is left of them.
    found
        ``(3, 6)``, receives the three blocks of the best covering.

    Returns
    -------
    int
        Least waste, or `limit`. ``found[0, 0] = -1`` if there is none. ``work[0] <= 0`` if the work did not suffice;
        ``work[1]`` receives the number of first blocks that were tried completely.
    """
    longest = max(waste.shape[0], waste.shape[1], waste.shape[2])
    beyond = np.empty((6, longest, 6), np.int64)
    one, two, pair = np.empty(6, np.int64), np.empty(6, np.int64), np.empty(6, np.int64)
    common, whole = np.empty(6, np.int64), np.empty(6, np.int64)
    best = limit
    found[0, 0] = -1
    work[1] = 0
    for number in range(len(blocks)):
        first = blocks[number]
        if first[6] >= best:
            work[1] = len(blocks)
            break
        if work[0] <= 0:
            break
        work[0] -= len(cells)
        if not _enclose_beyond(cells, first, beyond):
            best = first[6]
            for c in range(6):
                found[0, c] = first[c]
                found[1, c] = first[c]
                found[2, c] = first[c]
            work[1] += 1
            continue
        for c in range(6):
            whole[c] = beyond[3, 0, c]
        for f in range(6):
            for g in range(f + 1, 6):
                for h in range(g + 1, 6):
                    for c in range(6):
                        one[c] = whole[c]
                    span_f = whole[f % 3 + 3] - whole[f % 3]
                    span_g = whole[g % 3 + 3] - whole[g % 3]
                    span_h = whole[h % 3 + 3] - whole[h % 3]
                    for i in range(span_f):
                        one[f] = whole[f % 3] + 1 + i if f >= 3 else whole[f % 3 + 3] - 1 - i
                        for j in range(span_g):
                            one[g] = whole[g % 3] + 1 + j if g >= 3 else whole[g % 3 + 3] - 1 - j
                            if (g - f == 3) and one[f] >= one[g]:
                                continue
                            _join(beyond[f, one[f]], beyond[g, one[g]], pair)
                            if (
                                pair[0] < pair[3]
                                and first[6] + _new_waste(waste, pair, first, common) >= best
                            ):
                                continue
                            for k in range(span_h):
                                one[h] = whole[h % 3] + 1 + k if h >= 3 else whole[h % 3 + 3] - 1 - k
                                if (h - f == 3 and one[f] >= one[h]) or (h - g == 3 and one[g] >= one[h]):
                                    continue
                                work[0] -= 1
                                total = first[6] + _new_waste(waste, one, first, common)
                                if total >= best:
                                    break
                                _join(pair, beyond[h, one[h]], two)
                                if two[0] < two[3]:
                                    total += _new_waste(waste, two, first, common)
                                    for c in range(3):
                                        two[c] = max(two[c], one[c])
                                        two[c + 3] = min(two[c + 3], one[c + 3])
                                    if two[0] < two[3] and two[1] < two[4] and two[2] < two[5]:
                                        total -= _new_waste(waste, two, first, common)
                                    _join(pair, beyond[h, one[h]], two)
                                if total < best:
                                    best = total
                                    for c in range(6):
                                        found[0, c] = first[c]
                                        found[1, c] = one[c]
                                        found[2, c] = two[c] if two[0] < two[3] else one[c]
        work[1] += 1
    return best
