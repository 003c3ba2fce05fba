"""Generate blocks: grids of equal boxes, and pairs of blocks joined along an axis with little waste."""

import numpy as np
from numba import njit

from amprep.arrays import Int64s
from amprep.kernels.blocks.records import MAX_ITEM_TYPES, BlockTable, OrientedBoxes
from amprep.kernels.helper import helper

GRID = -1
"""Marks in `BlockTable.made` a grid of one oriented box. Joined blocks have their axis (0, 1, 2) there."""

MAX_PAIRS = 10_000_000
"""Largest number of pairs of blocks examined; takes about 0.1 s."""

# Strategy. Row `count` of the table is the block being tried: a generator writes it there, and it is kept by
# adding 1 to `count`. A block is dropped when a block of the same sides and contents exists already; an open
# addressing hash table of 64-bit keys decides that. (Two different blocks with equal keys would only cost one
# block.) The table starts with the single boxes and grids of them. Then each block is joined with itself and
# with all earlier blocks, along each axis: rows are both the queue and the result, so small blocks come first
# and no pair is tried twice. The work is bounded by the number of rows and by `MAX_PAIRS`.


@helper
def _is_known(table: BlockTable, new: int, salt: np.ndarray) -> bool:
    """Return whether a block of the same sides and contents exists; if not, add the block's key."""
    key = np.uint64(0)
    for m in range(MAX_ITEM_TYPES):
        key += np.uint64(table.number[new, m]) * salt[table.item_type[new, m] + 3]
    for axis in range(3):
        key += np.uint64(table.size[new, axis]) * salt[axis]
    key = (key ^ (key >> np.uint64(29))) | np.uint64(1)
    last = np.uint64(table.hashes.size - 1)
    at = (key >> np.uint64(20)) & last
    while table.hashes[at] != np.uint64(0):
        if table.hashes[at] == key:
            return True
        at = (at + np.uint64(1)) & last
    table.hashes[at] = key
    return False


@helper
def _join_contents(table: BlockTable, first: int, second: int, new: int, demand: Int64s) -> bool:
    """Write the contents of two blocks together; return False if they exceed the demand or the columns."""
    used = 0
    for m in range(MAX_ITEM_TYPES):
        table.item_type[new, m], table.number[new, m] = table.item_type[first, m], table.number[first, m]
        used += table.number[first, m] > 0
    for m in range(MAX_ITEM_TYPES):
        number, item_type = table.number[second, m], table.item_type[second, m]
        if number == 0:
            break
        at = 0
        while at < used and table.item_type[new, at] != item_type:
            at += 1
        if at == MAX_ITEM_TYPES:
            return False
        if at == used:
            table.item_type[new, at], table.number[new, at] = item_type, 0
            used += 1
        table.number[new, at] += number
        if table.number[new, at] > demand[item_type]:
            return False
    return True


@helper
def _join_sides(table: BlockTable, first: int, second: int, new: int, axis: int, axes: int) -> float:
    """Write the enclosing box of two blocks joined along an axis; return its volume, or area for 2 axes."""
    measure = 1.0
    for a in range(3):
        one, other = table.size[first, a], table.size[second, a]
        table.size[new, a] = one + other if a == axis else max(one, other)
        if a < axes:
            measure *= table.size[new, a]
    return measure


@helper
def _is_round(number: int, greatest: int) -> bool:
    """Return whether the number is the greatest, a power of two, or three times a power of two."""
    third = number // 3 if number % 3 == 0 else number
    return number == greatest or (third & (third - 1)) == 0


@helper
def _write_grid(
    table: BlockTable, row: int, boxes: OrientedBoxes, s: int, x: int, y: int, z: int, axes: int
) -> None:
    """Write a grid of ``x * y * z`` boxes of the oriented box `s`."""
    number, side = x * y * z, boxes.size[s]
    table.size[row, 0], table.size[row, 1], table.size[row, 2] = x * side[0], y * side[1], z * side[2]
    table.made[row, 0], table.made[row, 1] = GRID, s
    table.made[row, 2], table.made[row, 3], table.made[row, 4] = x, y, z
    for m in range(MAX_ITEM_TYPES):
        table.number[row, m] = 0
    table.item_type[row, 0], table.number[row, 0] = boxes.item_type[s], number
    table.filled[row] = float(number) * side[0] * side[1] * (side[2] if axes == 3 else 1)
    table.value[row] = number * boxes.value[s]


@helper
def _add_grids(
    boxes: OrientedBoxes,
    container: Int64s,
    max_grids: int,
    axes: int,
    salt: np.ndarray,
    table: BlockTable,
    count: int,
) -> int:
    """Add grids of each oriented box, about equally many of each; return the number of blocks.

    If a box has more grids than its part of `max_grids`, only grids with round numbers are made.
    """
    each = max_grids // boxes.size.shape[0]
    for s in range(boxes.size.shape[0]):
        left = boxes.demand[boxes.item_type[s]]
        x = min(container[0] // boxes.size[s, 0], left)
        y = min(container[1] // boxes.size[s, 1], left)
        z = min(container[2] // boxes.size[s, 2], left) if axes == 3 else 1
        last = min(table.hashes.size, count + each)
        only_round = x * y * z > each
        for i in range(1, x + 1):
            for j in range(1, min(y, left // i) + 1):
                for k in range(1, min(z, left // (i * j)) + 1):
                    if count >= last:
                        continue
                    if only_round and not (_is_round(i, x) and _is_round(j, y) and _is_round(k, z)):
                        continue
                    _write_grid(table, count, boxes, s, i, j, k, axes)
                    if not _is_known(table, count, salt):
                        count += 1
    return count


@helper
def _add_pairs(
    demand: Int64s,
    container: Int64s,
    min_fill: float,
    axes: int,
    salt: np.ndarray,
    table: BlockTable,
    count: int,
) -> int:
    """Join pairs of blocks until the table is full or no pair is left; return the number of blocks."""
    most, examined = table.size.shape[0] - 1, 0
    for first in range(most):
        if first >= count or count == most or examined > MAX_PAIRS:
            break
        for second in range(first + 1):
            filled = table.filled[first] + table.filled[second]
            for axis in range(axes):
                measure = _join_sides(table, first, second, count, axis, axes)
                if filled < min_fill * measure or table.size[count, axis] > container[axis]:
                    continue
                if not _join_contents(table, first, second, count, demand) or _is_known(table, count, salt):
                    continue
                table.made[count, 0], table.made[count, 1], table.made[count, 2] = axis, first, second
                table.filled[count] = filled
                table.value[count] = table.value[first] + table.value[second]
                count += 1
                if count == most:
                    return count
        examined += first + 1
    return count


@njit(cache=True, nogil=True)
def make_blocks(
    boxes: OrientedBoxes,
    container: Int64s,
    max_grids: int,
    min_fill: float,
    axes: int,
    salt: np.ndarray,
    table: BlockTable,
) -> int:
    """Generate the single boxes, grids of them, then joined pairs of blocks; return the number of blocks.

    Pairs are the general blocks of Fanslau and Bortfeldt 2010 (doi:10.1287/ijoc.1090.0338): a pair is kept if
    it fits the container, does not exceed the demand, and fills at least `min_fill` of its enclosing box.

    Parameters
    ----------
    boxes
        The boxes to pack.
    container
        ``(3,)`` sides of the container.
    max_grids
        Largest number of grids of more than one box.
    min_fill
        Smallest filled fraction of a block's enclosing box.
    axes
        3, or 2 when nothing is stacked.
    salt
        ``(k + 3,)`` odd random uint64 for hashing.
    table
        Written. It has at least one row more than there are oriented boxes.
    """
    # literal integers would compile each helper a second time
    most, count, one = table.size.shape[0] - 1, int(np.int64(0)), int(np.int64(1))
    for s in range(boxes.size.shape[0]):
        _write_grid(table, count, boxes, s, one, one, one, axes)
        if not _is_known(table, count, salt):
            count += 1
    if max_grids > 0:
        count = _add_grids(boxes, container, min(max_grids, most - count), axes, salt, table, count)
    return int(_add_pairs(boxes.demand, container, min_fill, axes, salt, table, count))
