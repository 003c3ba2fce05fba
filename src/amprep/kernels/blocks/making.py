"""Blocks of boxes, compiled: grids of equal boxes, and pairs of blocks side by side that leave little unused."""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.places import helper

GRID = -1
"""How a block is made: as a grid of one box; else along 0, 1, 2 two blocks side by side in x, y, z."""

MOST_KINDS = 6
"""Kinds of boxes in one block, at most."""

MOST_PAIRS = 10_000_000
"""Pairs of blocks looked at, at most; some 0.1 s."""


class Making(NamedTuple):
    """Blocks as they are made; the first `count` rows are in use.

    Attributes
    ----------
    size
        ``(b, 3)`` int64 sides of the box around the block.
    made
        ``(b, 5)`` int64 how it is made: `GRID`, single box and its numbers along x, y, z; or the axis and the
        two blocks, the second behind the first.
    kind, number
        ``(b, MOST_KINDS)`` int64 its kinds and how many of each; the number is 0 in unused places.
    full
        ``(b,)`` what its boxes take up: volume, or area when nothing is stacked.
    value
        ``(b,)`` what its boxes are worth.
    table
        ``(t,)`` uint64 hash table of the blocks known, t a power of 2.
    """

    size: Int64s
    made: Int64s
    kind: Int64s
    number: Int64s
    full: Floats
    value: Floats
    table: np.ndarray


@helper
def _known(making, new, salt):
    """Note the block in the hash table; return whether one of the same sides and contents is there."""
    key = np.uint64(0)
    for m in range(MOST_KINDS):
        key += np.uint64(making.number[new, m]) * salt[making.kind[new, m] + 3]
    for axis in range(3):
        key += np.uint64(making.size[new, axis]) * salt[axis]
    key = (key ^ (key >> np.uint64(29))) | np.uint64(1)
    last = np.uint64(making.table.size - 1)
    at = (key >> np.uint64(20)) & last
    while making.table[at] != np.uint64(0):
        if making.table[at] == key:
            return True
        at = (at + np.uint64(1)) & last
    making.table[at] = key
    return False


@helper
def _mixed(making, first, second, new, stock):
    """Write the contents of two blocks together; return whether there are as many boxes."""
    used = 0
    for m in range(MOST_KINDS):
        making.kind[new, m], making.number[new, m] = making.kind[first, m], making.number[first, m]
        used += making.number[first, m] > 0
    for m in range(MOST_KINDS):
        number, kind = making.number[second, m], making.kind[second, m]
        if number == 0:
            break
        at = 0
        while at < used and making.kind[new, at] != kind:
            at += 1
        if at == MOST_KINDS:
            return False
        if at == used:
            making.kind[new, at], making.number[new, at] = kind, 0
            used += 1
        making.number[new, at] += number
        if making.number[new, at] > stock[kind]:
            return False
    return True


@helper
def _is_round(number, most):
    """Whether the number is the most, a power of two or three times one."""
    third = number // 3 if number % 3 == 0 else number
    return number == most or (third & (third - 1)) == 0


@helper
def _add_grid(making, row, single, kind, worth, x, y, z, axes):
    """Write a grid of equal boxes, `single` being their sides."""
    number = x * y * z
    making.size[row, 0], making.size[row, 1], making.size[row, 2] = (
        x * single[0],
        y * single[1],
        z * single[2],
    )
    making.made[row, 2], making.made[row, 3], making.made[row, 4] = x, y, z
    for m in range(MOST_KINDS):
        making.number[row, m] = 0
    making.kind[row, 0], making.number[row, 0] = kind, number
    making.full[row] = float(number) * single[0] * single[1] * (single[2] if axes == 3 else 1)
    making.value[row] = number * worth


@helper
def _grids(singles, kinds, worth, stock, room, most_grids, axes, salt, making, count):
    """Make grids of each single box, about equally many of each; return the number of blocks then."""
    for s in range(singles.shape[0]):
        kind = kinds[s]
        x = min(room[0] // singles[s, 0], stock[kind])
        y = min(room[1] // singles[s, 1], stock[kind])
        z = min(room[2] // singles[s, 2], stock[kind]) if axes == 3 else 1
        last = min(making.table.size, count + most_grids // singles.shape[0])
        many = x * y * z > most_grids // singles.shape[0]
        for i in range(1, x + 1):
            for j in range(1, min(y, stock[kind] // i) + 1):
                for k in range(1, min(z, stock[kind] // (i * j)) + 1):
                    if count >= last or (
                        many and not (_is_round(i, x) and _is_round(j, y) and _is_round(k, z))
                    ):
                        continue
                    making.made[count, 0], making.made[count, 1] = GRID, s
                    _add_grid(making, count, singles[s], kind, worth[s], i, j, k, axes)
                    if not _known(making, count, salt):
                        count += 1
    return count


@njit(cache=True, nogil=True)
def make_blocks(singles, kinds, worth, stock, room, most_grids, fill, axes, salt, making):
    """Make the single boxes, grids of them, then pairs of blocks, until the rows of `making` are used up.

    Pairs are the general blocks of Fanslau and Bortfeldt 2010 (doi:10.1287/ijoc.1090.0338): a pair is kept
    when it fits the room, there are as many boxes, and its boxes take up at least `fill` of the box around it.

    Parameters
    ----------
    singles, kinds, worth
        ``(s, 3)`` sides of each kind of box as it may stand, ``(s,)`` its kind and value.
    stock
        ``(k,)`` number of boxes of each kind.
    room
        ``(3,)`` sides of the room.
    most_grids
        Grids of more than one box, at most.
    axes
        3, or 2 when nothing is stacked.
    salt
        ``(k + 3,)`` odd random uint64 for hashing.
    making
        Written; one row more than the blocks to be made, which are at least the single boxes.

    Returns
    -------
    int
        The number of blocks made.
    """
    # a constant as an argument would make the compiler do it all twice
    most, count, one = making.size.shape[0] - 1, np.int64(0), np.int64(1)
    for s in range(singles.shape[0]):
        making.made[count, 0], making.made[count, 1] = GRID, s
        _add_grid(making, count, singles[s], kinds[s], worth[s], one, one, one, axes)
        if not _known(making, count, salt):
            count += 1
    if most_grids > 0:
        most_grids = min(most_grids, most - count)
        count = _grids(singles, kinds, worth, stock, room, most_grids, axes, salt, making, count)
    looked = 0
    for first in range(most):
        if first >= count or count == most or looked > MOST_PAIRS:
            break
        for second in range(first + 1):
            full = making.full[first] + making.full[second]
            for axis in range(axes):
                around = 1.0
                for a in range(3):
                    one, other = making.size[first, a], making.size[second, a]
                    making.size[count, a] = one + other if a == axis else max(one, other)
                    if a < axes:
                        around *= making.size[count, a]
                if full < fill * around or making.size[count, axis] > room[axis]:
                    continue
                if not _mixed(making, first, second, count, stock) or _known(making, count, salt):
                    continue
                making.made[count, 0], making.made[count, 1], making.made[count, 2] = axis, first, second
                making.full[count] = full
                making.value[count] = making.value[first] + making.value[second]
                count += 1
                if count == most:
                    return count
        looked += first + 1
    return count
