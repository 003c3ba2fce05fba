"""Records that the kernels of block building take. All lengths are whole numbers of one unit."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int32s, Int64s

MAX_ITEM_TYPES = 6
"""Largest number of item types in one block."""

MAX_SMALLEST = 32
"""Largest number of smallest boxes kept per state; they decide which spaces are too small for any box."""

SPACES, PLACED, CANDIDATES, SMALLEST = 0, 1, 2, 3
"""Columns of `States.counts`."""

STOP, WORK, LIMIT, LENGTH, FOUND_AT, MORE = 0, 1, 2, 3, 4, 5
"""Entries of `BeamSearch.control`: stop request; work done and allowed; number of rows of the best packing, and
the work done when it was found; whether a wider beam might find more. The unit of work is about one block or
space examined."""


class OrientedBoxes(NamedTuple):
    """The boxes to pack: each item type once per orientation.

    Attributes
    ----------
    size
        ``(s, 3)`` sides.
    item_type
        ``(s,)`` item type.
    value
        ``(s,)`` value of one box, above 0.
    demand
        ``(k,)`` number of boxes of each item type.
    """

    size: Int64s
    item_type: Int64s
    value: Floats
    demand: Int64s


class BlockTable(NamedTuple):
    """Blocks while they are generated, one per row. There is one spare row for the block being tried.

    Attributes
    ----------
    size
        ``(b, 3)`` sides of the block's enclosing box.
    made
        ``(b, 5)`` construction: `GRID`, the oriented box and its numbers along x, y, z; or the axis of the
        join and the two blocks joined.
    item_type, number
        ``(b, MAX_ITEM_TYPES)`` item types in the block and the number of boxes of each; unused columns have
        the number 0.
    filled
        ``(b,)`` total volume of its boxes, or their total base area when nothing is stacked.
    value
        ``(b,)`` total value of its boxes.
    hashes
        ``(t,)`` uint64 hash table of the blocks already generated; t is a power of 2.
    """

    size: Int64s
    made: Int64s
    item_type: Int64s
    number: Int64s
    filled: Floats
    value: Floats
    hashes: np.ndarray


class Blocks(NamedTuple):
    """Blocks in order of decreasing `base_score`.

    Attributes
    ----------
    size
        ``(b, 3)`` sides.
    item_type, number
        ``(b, MAX_ITEM_TYPES)`` contents, as in `BlockTable`.
    value
        ``(b,)`` total value of its boxes.
    base_score
        ``(b,)`` upper bound of the block's score: its score with contact on all sides and no wasted space.
    single
        ``(s,)`` the blocks that are one box, in order of increasing volume.
    """

    size: Int64s
    item_type: Int64s
    number: Int64s
    value: Floats
    base_score: Floats
    single: Int64s


class SearchRules(NamedTuple):
    """The container and the constants of the score, fixed during a search.

    Attributes
    ----------
    container
        ``(6,)`` corners of the container.
    sides, starts
        ``(r, 2)`` item type and side length of the boxes, and ``(4,)`` first row for each axis; the lengths
        are in steps of ``1 << shift``, see `usable_lengths`.
    margin
        ``(3,)`` distance up to which two faces count as touching.
    power
        Exponent of the touching fraction of a block's surface.
    shift
        Number of low bits that `usable_lengths` drops from a length.
    flat
        True if nothing may be placed above another box.
    goal
        Value at which the search ends.
    """

    container: Int64s
    sides: Int64s
    starts: Int64s
    margin: Int64s
    power: int
    shift: int
    flat: bool
    goal: float


class States(NamedTuple):
    """Partly filled containers, one per row.

    Attributes
    ----------
    spaces
        ``(w, s, 8)`` maximal empty spaces.
    placed
        ``(w, p, 7)`` corners of each obstacle and placed block, and the block's number (-1 for an obstacle).
    demand
        ``(w, k)`` number of boxes left of each item type.
    usable
        ``(w, 3, l)`` the longest row of boxes along each axis for each length, see `usable_lengths`.
    candidates
        ``(w, b)`` int32 blocks that may still be placed, in order of decreasing `base_score`.
    smallest
        ``(w, MAX_SMALLEST, 3)`` sides of the smallest boxes left; a space that holds none of them is useless.
    counts
        ``(w, 4)`` numbers of spaces, placed boxes, candidates and smallest boxes.
    value
        ``(w,)`` total value of the placed boxes.
    """

    spaces: Int64s
    placed: Int64s
    demand: Int64s
    usable: Int64s
    candidates: Int32s
    smallest: Int64s
    counts: Int64s
    value: Floats


class BeamScratch(NamedTuple):
    """Work arrays of a beam search; their contents do not matter between calls.

    Attributes
    ----------
    fresh, touching
        ``(f, 8)`` new spaces and ``(s,)`` spaces that touch the placed box, see `cut`.
    near
        ``(p,)`` placed boxes near a space.
    box
        ``(6,)`` corners of one block.
    words
        uint64 bit set of reachable lengths, see `usable_lengths`.
    block, score
        ``(m,)`` best blocks for a space and their scores.
    parent, child, space, completed
        ``(w * m,)`` for each successor: the row of its parent state, the block placed, the space it is placed
        in, and the value after the greedy completion.
    """

    fresh: Int64s
    touching: Int64s
    near: Int64s
    box: Int64s
    words: np.ndarray
    block: Int64s
    score: Floats
    parent: Int64s
    child: Int64s
    space: Int64s
    completed: Floats


class BeamSearch(NamedTuple):
    """Everything that one beam search reads and writes.

    Attributes
    ----------
    best, best_value
        ``(p, 7)`` rows of `States.placed` of the best packing found, and ``(1,)`` its value.
    control
        ``(6,)`` int64 counters and flags, see `STOP`. Another thread may write to it.
    """

    blocks: Blocks
    rules: SearchRules
    states: States
    scratch: BeamScratch
    best: Int64s
    best_value: Floats
    control: Int64s
