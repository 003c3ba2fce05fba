"""The records of the beam search over blocks: blocks, room, states and work arrays."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s

MOST_SMALL = 32
"""Small boxes kept for telling which spaces are of no use."""


class Blocks(NamedTuple):
    """The blocks, greatest `base` first.

    Attributes
    ----------
    size
        ``(b, 3)`` int64 sides.
    kind, number
        ``(b, MOST_KINDS)`` int64 contents.
    value
        ``(b,)`` what its boxes are worth.
    base
        ``(b,)`` its merit if it touched something all around and wasted nothing.
    single
        ``(s,)`` int64 which blocks are single boxes, least volume first.
    """

    size: Int64s
    kind: Int64s
    number: Int64s
    value: Floats
    base: Floats
    single: Int64s


class Room(NamedTuple):
    """What does not change in a search.

    Attributes
    ----------
    box
        ``(6,)`` int64 corners of the room.
    sides, starts
        The sides of boxes in steps of ``1 << shift``, see `measure_reach`.
    margin
        ``(3,)`` int64 distances that count as touching.
    power
        Exponent of the share of a block's surface that touches.
    flat
        Whether nothing may lie above anything.
    goal
        Value at which the search ends.
    """

    box: Int64s
    sides: Int64s
    starts: Int64s
    margin: Int64s
    power: int
    shift: int
    flat: bool
    goal: float


class States(NamedTuple):
    """Partly filled rooms, one a row; see `TRIAL` of the search.

    Attributes
    ----------
    spaces
        ``(w, s, 8)`` int64 maximal empty spaces.
    placed
        ``(w, p, 7)`` int64 boxes around what is placed, and the block.
    stock
        ``(w, k)`` int64 boxes left of each kind.
    reach
        ``(w, 3, l)`` int64, see `measure_reach`.
    alive
        ``(w, b)`` int32 blocks of which there may be enough boxes.
    small
        ``(w, MOST_SMALL, 3)`` int64 sides: a space in which none of these fits is of no use.
    counts
        ``(w, 4)`` int64 numbers of spaces, placed boxes, such blocks and small boxes.
    value
        ``(w,)``.
    """

    spaces: Int64s
    placed: Int64s
    stock: Int64s
    reach: Int64s
    alive: np.ndarray
    small: Int64s
    counts: Int64s
    value: Floats


class Scratch(NamedTuple):
    """Work arrays.

    Attributes
    ----------
    fresh, touching, near, box, words
        ``(f, 8)`` cut spaces, ``(s,)`` spaces beside a cut, ``(p,)`` neighbours, ``(6,)`` a box, and the
        bits of `measure_reach`.
    block, merit
        ``(m,)`` the best blocks for a space.
    parent, child, space, worth
        ``(w * m,)`` the successors: row, block, space, and value when completed.
    """

    fresh: Int64s
    touching: Int64s
    near: Int64s
    box: Int64s
    words: np.ndarray
    block: Int64s
    merit: Floats
    parent: Int64s
    child: Int64s
    space: Int64s
    worth: Floats
