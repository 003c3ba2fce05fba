"""The arrays of a beam search over blocks, in the sizes that a problem needs."""

from dataclasses import dataclass

import numpy as np

from amprep.kernels.blocks.records import MOST_SMALL, Room, Scratch, States
from amprep.plugins.packers.block_building.integer_instance import Whole

STEPS = 2048
"""Lengths told apart along the longest side when it is asked what fits beside a block."""

MOST_SPACES = 4000
"""Maximal empty spaces of one state, at most."""

MOST_BYTES = 300_000_000
"""Size of the states of one search, at most."""


@dataclass(frozen=True)
class Sizes:
    """How long the arrays are.

    Attributes
    ----------
    shift
        Bits by which lengths in `States.reach` are shorter.
    boxes
        Boxes that may be placed or stand.
    """

    shift: int
    steps: int
    boxes: int
    kinds: int
    spaces: int
    blocks: int

    @property
    def widest(self) -> int:
        """The greatest width of a beam for which there is memory."""
        row = 64 * self.spaces + 56 * self.boxes + 8 * self.kinds + 24 * self.steps + 4 * self.blocks
        return max(MOST_BYTES // row // 2 - 1, 1)


def sizes_of(whole: Whole, standing: int, blocks: int) -> Sizes:
    """Return the sizes for a room in which `standing` boxes stand."""
    longest, boxes = int(whole.room[3:].max()), int(whole.stock.sum()) + standing
    shift = max(longest.bit_length() - STEPS.bit_length() + 1, 0)
    spaces = min(200 + 6 * boxes, MOST_SPACES)
    return Sizes(shift, (longest >> shift) + 2, boxes + 1, len(whole.items), spaces, blocks)


def room_of(whole: Whole, sizes: Sizes, *, margin: float, power: int, flat: bool) -> Room:
    """Return what does not change in a search; see `block_building_worker.Manner`."""
    half = (1 << sizes.shift) >> 1
    sides = [
        np.unique(np.column_stack((whole.kind, (side + half) >> sizes.shift)), axis=0)
        for side in whole.singles.T
    ]
    return Room(
        box=whole.room,
        sides=np.concatenate(sides),
        starts=np.cumsum([0, *map(len, sides)]),
        margin=(whole.room[3:] * margin).astype(np.int64),
        power=power,
        shift=sizes.shift,
        flat=flat,
        goal=whole.goal,
    )


def states_of(sizes: Sizes, rows: int) -> States:
    """Return empty states."""
    return States(
        spaces=np.zeros((rows, sizes.spaces, 8), np.int64),
        placed=np.zeros((rows, sizes.boxes, 7), np.int64),
        stock=np.zeros((rows, sizes.kinds), np.int64),
        reach=np.zeros((rows, 3, sizes.steps), np.int64),
        alive=np.zeros((rows, sizes.blocks), np.int32),
        small=np.zeros((rows, MOST_SMALL, 3), np.int64),
        counts=np.zeros((rows, 4), np.int64),
        value=np.zeros(rows),
    )


def scratch_of(sizes: Sizes, width: int) -> Scratch:
    """Return work arrays for a beam of `width` states with as many successors each."""
    return Scratch(
        fresh=np.zeros((2 * sizes.spaces + 1, 8), np.int64),
        touching=np.zeros(sizes.spaces, np.int64),
        near=np.zeros(sizes.boxes, np.int64),
        box=np.zeros(6, np.int64),
        words=np.zeros(sizes.steps // 64 + 1, np.uint64),
        block=np.zeros(width, np.int64),
        merit=np.zeros(width),
        parent=np.zeros(width * width, np.int64),
        child=np.zeros(width * width, np.int64),
        space=np.zeros(width * width, np.int64),
        worth=np.zeros(width * width),
    )
