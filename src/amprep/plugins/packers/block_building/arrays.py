"""Allocate the arrays of a beam search over blocks in the sizes that the instance needs."""

from dataclasses import dataclass

import numpy as np

from amprep.kernels.blocks.records import MAX_SMALLEST, BeamScratch, SearchRules, States
from amprep.plugins.packers.block_building.integer_instance import IntegerInstance

STEPS = 2048
"""Resolution of `States.usable`: number of different lengths along the container's longest side."""

MAX_SPACES = 4000
"""Largest number of maximal empty spaces in one state."""

MAX_BYTES = 300_000_000
"""Largest total size of the states of one search."""


@dataclass(frozen=True)
class ArraySizes:
    """Lengths of the arrays of a search.

    Attributes
    ----------
    shift
        Number of low bits that `States.usable` drops from a length.
    steps
        Number of lengths in `States.usable`.
    boxes
        Largest number of obstacles and placed blocks.
    item_types, spaces, blocks
        Numbers of item types, maximal spaces and blocks.
    """

    shift: int
    steps: int
    boxes: int
    item_types: int
    spaces: int
    blocks: int

    @property
    def max_width(self) -> int:
        """The greatest width of a beam for which there is memory."""
        row = 64 * self.spaces + 56 * self.boxes + 8 * self.item_types + 24 * self.steps + 4 * self.blocks
        return max(MAX_BYTES // row // 2 - 1, 1)


def array_sizes(instance: IntegerInstance, obstacles: int, blocks: int) -> ArraySizes:
    """Return the sizes for a container with a number of obstacles and a set of blocks."""
    longest, boxes = int(instance.container[3:].max()), int(instance.boxes.demand.sum()) + obstacles
    shift = max(longest.bit_length() - STEPS.bit_length() + 1, 0)
    spaces = min(200 + 6 * boxes, MAX_SPACES)
    return ArraySizes(shift, (longest >> shift) + 2, boxes + 1, len(instance.items), spaces, blocks)


def search_rules(
    instance: IntegerInstance, sizes: ArraySizes, *, margin: float, power: int, flat: bool
) -> SearchRules:
    """Return the constants of a search.

    Parameters
    ----------
    instance, sizes
        The instance and the sizes of its arrays.
    margin
        Distance that counts as touching, as a fraction of the container's side.
    power
        Exponent of the touching fraction of a block's surface.
    flat
        True if nothing is stacked.
    """
    half = (1 << sizes.shift) >> 1
    sides = [
        np.unique(np.column_stack((instance.boxes.item_type, (side + half) >> sizes.shift)), axis=0)
        for side in instance.boxes.size.T
    ]
    return SearchRules(
        container=instance.container,
        sides=np.concatenate(sides),
        starts=np.cumsum([0, *map(len, sides)]),
        margin=(instance.container[3:] * margin).astype(np.int64),
        power=power,
        shift=sizes.shift,
        flat=flat,
        goal=instance.goal,
    )


def empty_states(sizes: ArraySizes, rows: int) -> States:
    """Return `rows` empty states."""
    return States(
        spaces=np.zeros((rows, sizes.spaces, 8), np.int64),
        placed=np.zeros((rows, sizes.boxes, 7), np.int64),
        demand=np.zeros((rows, sizes.item_types), np.int64),
        usable=np.zeros((rows, 3, sizes.steps), np.int64),
        candidates=np.zeros((rows, sizes.blocks), np.int32),
        smallest=np.zeros((rows, MAX_SMALLEST, 3), np.int64),
        counts=np.zeros((rows, 4), np.int64),
        value=np.zeros(rows),
    )


def empty_scratch(sizes: ArraySizes, width: int) -> BeamScratch:
    """Return work arrays for a beam of `width` states with `width` successors each."""
    return BeamScratch(
        fresh=np.zeros((2 * sizes.spaces + 1, 8), np.int64),
        touching=np.zeros(sizes.spaces, np.int64),
        near=np.zeros(sizes.boxes, np.int64),
        box=np.zeros(6, np.int64),
        words=np.zeros(sizes.steps // 64 + 1, np.uint64),
        block=np.zeros(width, np.int64),
        score=np.zeros(width),
        parent=np.zeros(width * width, np.int64),
        child=np.zeros(width * width, np.int64),
        space=np.zeros(width * width, np.int64),
        completed=np.zeros(width * width),
    )
