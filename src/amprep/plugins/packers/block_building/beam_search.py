"""One worker of `block-building`: beam searches of increasing width over its own set of blocks."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Int64s
from amprep.kernels.blocks import records
from amprep.kernels.blocks.beam_search import FIRST, run_search
from amprep.kernels.blocks.push import push
from amprep.kernels.blocks.records import BeamSearch
from amprep.plugins.packers.block_building.arrays import (
    array_sizes,
    empty_scratch,
    empty_states,
    search_rules,
)
from amprep.plugins.packers.block_building.blocks import BlockSet, build_blocks
from amprep.plugins.packers.block_building.integer_instance import IntegerInstance

RELAXED_FILL = 0.98
"""Smallest filled fraction of a block when a stricter one gives too few blocks."""

MIN_BLOCKS_PER_BOX = 4
"""Number of blocks per oriented box below which blocks are generated again with `RELAXED_FILL`."""

MAX_REFILLED = 1000
"""Largest number of boxes for which free space is refilled after the boxes were pushed down."""

REFILL_WORK = 2_000_000
"""Work limit of the refill; the unit is that of `kernels.blocks.records.WORK`."""

MAX_PUSH_PAIRS = 50_000_000
"""Largest number of pairs of boxes compared while boxes are pushed down."""


@dataclass(frozen=True)
class SearchSettings:
    """Settings of a worker: which blocks it builds and how it scores them.

    Attributes
    ----------
    min_fill
        Smallest filled fraction of a block's enclosing box; see `RELAXED_FILL`.
    grids
        Largest fraction of the blocks that are grids of equal boxes.
    power
        Exponent of the touching fraction of a block's surface.
    count
        Exponent of the number of boxes, by which a block's score is divided.
    margin
        Distance that counts as touching, as a fraction of the container's side.
    density
        Exponent of the value density, by which a block's score is multiplied. When nothing is stacked, the
        density is value per area and the exponent is greater by 1.
    """

    min_fill: float = RELAXED_FILL
    grids: float = 0.0
    power: int = 4
    count: float = 0.2
    margin: float = 0.02
    density: float = 0.0


class PackedBoxes(NamedTuple):
    """Boxes in the container, in units: the oriented box ``(n,)`` and its corners ``(n, 6)``; their total value."""

    box: Int64s
    corners: Int64s
    value: float


class Worker:
    """Searches until it is stopped, has used up its work, reaches the goal, or a wider beam changes nothing."""

    def __init__(
        self, instance: IntegerInstance, settings: SearchSettings, *, blocks: int, work: float, flat: bool
    ) -> None:
        self.instance, self.settings, self.flat, self.max_blocks = instance, settings, flat, blocks
        self.control = np.zeros(6, np.int64)
        self.control[records.LIMIT] = int(min(work * 1e6, 1e18))
        self.packed = PackedBoxes(np.empty(0, np.int64), np.empty((0, 6), np.int64), 0.0)
        self.finished = False

    @property
    def found_at(self) -> int:
        """Work done when the best packing was found."""
        return int(self.control[records.FOUND_AT])

    @property
    def reached_goal(self) -> bool:
        """Whether no packing can be better."""
        return self.packed.value >= self.instance.goal

    def run(self) -> None:
        """Complete the empty container with single boxes, then search with blocks and wider and wider beams."""
        self._complete_once()
        blocks, width = None, 1
        while not (self.finished or self.control[records.STOP]):
            blocks = blocks or self._build(self.max_blocks)
            self.finished = not self._search(blocks, width)
            width = max(round(width * math.sqrt(2.0)), width + 1)

    def _complete_once(self) -> None:
        """Fill the container greedily with single boxes."""
        limit, self.control[records.LIMIT] = int(self.control[records.LIMIT]), -1
        self._search(self._build(0), 1)
        self.control[records.LIMIT] = limit
        # the limit of -1 stopped the search after its first successor; a request to stop is made again
        self.control[records.STOP] = self.reached_goal or self.control[records.WORK] > limit

    def compacted(self) -> PackedBoxes:
        """Return the boxes pushed down and to the corner, with the space gained refilled.

        This runs after the search, so it is shortened or left out when there are very many boxes.
        """
        _push_down(self.packed.corners, self.instance.obstacles, flat=self.flat)
        if not self.reached_goal and len(self.packed.corners) <= MAX_REFILLED:
            self.control[records.STOP] = 0
            self.control[records.LIMIT] = self.control[records.WORK] + REFILL_WORK
            self._search(self._build(0), 1, refill=True)
        return self.packed

    def _build(self, count: int) -> BlockSet:
        """Build up to `count` blocks."""
        min_fill = self.settings.min_fill
        blocks = self._build_with(count, min_fill)
        enough = min(MIN_BLOCKS_PER_BOX * len(self.instance.boxes.size), count)
        return (
            blocks if len(blocks.origin) >= enough else self._build_with(count, min(min_fill, RELAXED_FILL))
        )

    def _build_with(self, count: int, min_fill: float) -> BlockSet:
        return build_blocks(
            self.instance,
            count,
            min_fill=min_fill,
            grids=self.settings.grids,
            exponents=(self.settings.count, self.settings.density + float(self.flat)),
            flat=self.flat,
        )

    def _search(self, blocks: BlockSet, width: int, *, refill: bool = False) -> bool:
        """Search with a beam of `width`, or refill the free space; return whether a wider beam may find more."""
        best = self.packed
        kept = best if refill else PackedBoxes(best.box[:0], best.corners[:0], 0.0)
        obstacles = np.concatenate((self.instance.obstacles, kept.corners))
        search = self._arrays(blocks, width, kept, len(obstacles))
        if search is None:
            return False
        run_search(search, width, obstacles, len(self.instance.obstacles))
        value = float(search.best_value[0])
        if value > best.value:
            placed = search.best[len(obstacles) : self.control[records.LENGTH]]
            self.packed = _with_blocks(kept, blocks, placed, value)
        return bool(self.control[records.MORE])

    def _arrays(self, blocks: BlockSet, width: int, kept: PackedBoxes, obstacles: int) -> BeamSearch | None:
        """Return the arrays of a search that starts from the boxes kept; None if memory does not suffice."""
        instance, count = self.instance, len(blocks.origin)
        sizes = array_sizes(instance, obstacles, count)
        if width > sizes.max_width:
            return None
        settings, states = self.settings, empty_states(sizes, 2 * width + 1)
        states.demand[FIRST] = instance.boxes.demand
        np.subtract.at(states.demand[FIRST], instance.boxes.item_type[kept.box], 1)
        states.counts[FIRST, records.CANDIDATES] = count
        states.candidates[FIRST] = np.arange(count)
        states.value[FIRST] = kept.value
        return BeamSearch(
            blocks=blocks.blocks,
            rules=search_rules(instance, sizes, margin=settings.margin, power=settings.power, flat=self.flat),
            states=states,
            scratch=empty_scratch(sizes, width),
            best=np.zeros((sizes.boxes, 7), np.int64),
            best_value=np.array([self.packed.value]),
            control=self.control,
        )


def _push_down(boxes: Int64s, obstacles: Int64s, *, flat: bool) -> None:
    """Push boxes ``(n, 6)`` (in place) down, then to the front and to the left, until none moves.

    There are at most four rounds, and fewer with many boxes.
    """
    rounds = MAX_PUSH_PAIRS // (3 * len(boxes) * (len(boxes) + len(obstacles)) + 1)
    for _ in range(min(rounds, 4)):
        axes = (1, 0) if flat else (2, 1, 0)
        if not sum(push(boxes, np.argsort(boxes[:, a], kind="stable"), obstacles, a) for a in axes):
            return


def _with_blocks(kept: PackedBoxes, blocks: BlockSet, placed: Int64s, value: float) -> PackedBoxes:
    """Return the boxes kept, followed by those of the placed blocks ``(n, 7)``."""
    boxes = [box for row in placed for box in blocks.boxes(int(row[6]), row[:3])]
    box = np.array([number for number, _ in boxes], dtype=np.int64)
    lower = np.array([at for _, at in boxes], dtype=np.int64).reshape(-1, 3)
    corners = np.hstack((lower, lower + blocks.box_size[box]))
    return PackedBoxes(np.concatenate((kept.box, box)), np.concatenate((kept.corners, corners)), value)
