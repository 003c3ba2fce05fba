"""One worker of `block-building`: beam searches of growing width over blocks of its own."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Int64s
from amprep.kernels.blocks import beam_search as kernel
from amprep.kernels.blocks.push import push
from amprep.plugins.packers.block_building.arrays import room_of, scratch_of, sizes_of, states_of
from amprep.plugins.packers.block_building.blocks import Built, build_blocks
from amprep.plugins.packers.block_building.integer_instance import Whole

WASTEFUL = 0.98
"""Least share of a block's box that its boxes take up where blocks are few."""

MOST_REFILLED, REFILL_WORK = 1000, 2_000_000
"""Boxes around which room is looked for in the end, at most; blocks and spaces looked at to fill it."""

MOST_PAIRS = 50_000_000
"""Pairs of boxes looked at when they are pushed down, at most."""

FEW = 4
"""Blocks for each single box below which there are too few."""


@dataclass(frozen=True)
class Manner:
    """How a worker builds and chooses blocks.

    Attributes
    ----------
    fill
        Least share of a block's box that its boxes take up; `WASTEFUL` when that gives too few blocks.
    grids
        Share of the blocks that are grids of equal boxes, at most.
    power
        Exponent of the share of a block's surface that touches.
    count
        Exponent of the number of boxes that a block's merit is divided by.
    margin
        Distance that counts as touching, as a share of the room's side.
    density
        Exponent of value over volume that a block's merit is multiplied by; when nothing is stacked, one less
        than that of value over area.
    """

    fill: float = WASTEFUL
    grids: float = 0.0
    power: int = 4
    count: float = 0.2
    margin: float = 0.02
    density: float = 0.0


class Filling(NamedTuple):
    """Boxes in a room: which single ``(n,)`` and its corners ``(n, 6)``; their value."""

    single: Int64s
    boxes: Int64s
    value: float


class Worker:
    """Searches until told to stop, out of work, at the goal, or until a wider beam would not differ."""

    def __init__(self, whole: Whole, manner: Manner, *, blocks: int, work: float, flat: bool) -> None:
        self.whole, self.manner, self.flat, self.most_blocks = whole, manner, flat, blocks
        self.control = np.zeros(6, np.int64)
        self.control[kernel.LIMIT] = int(min(work * 1e6, 1e18))
        self.filling = Filling(np.empty(0, np.int64), np.empty((0, 6), np.int64), 0.0)
        self.finished = False

    @property
    def met(self) -> int:
        """Work done when the best was found."""
        return int(self.control[kernel.MET])

    @property
    def reached(self) -> bool:
        """Whether nothing can be better."""
        return self.filling.value >= self.whole.goal

    def run(self) -> None:
        """Search; at once with single boxes, then with blocks and wider and wider beams."""
        self._complete_once()
        built, width = None, 1
        while not (self.finished or self.control[kernel.STOP]):
            built = built or self._build(self.most_blocks)
            self.finished = not self._search(built, width)
            width = max(round(width * math.sqrt(2.0)), width + 1)

    def _complete_once(self) -> None:
        """Fill the room with single boxes, one after the other."""
        limit, self.control[kernel.LIMIT] = int(self.control[kernel.LIMIT]), -1
        self._search(self._build(0), 1)
        self.control[kernel.LIMIT] = limit
        # the first successor is all that was asked for; whoever wants an end sets this again
        self.control[kernel.STOP] = self.reached or self.control[kernel.WORK] > limit

    def settled(self) -> Filling:
        """Return the boxes pushed down and to the corner, and what room that gives filled.

        This comes after the end of the search, so it is left out or cut short when there are very many.
        """
        _push_down(self.filling.boxes, self.whole.obstacles, flat=self.flat)
        if not self.reached and len(self.filling.boxes) <= MOST_REFILLED:
            self.control[kernel.STOP] = 0
            self.control[kernel.LIMIT] = self.control[kernel.WORK] + REFILL_WORK
            self._search(self._build(0), 1, refill=True)
        return self.filling

    def _build(self, most: int) -> Built:
        """Build at most so many blocks."""
        manner = self.manner
        built = self._build_with(most, manner.fill)
        enough = min(FEW * len(self.whole.singles), most)
        return built if len(built.origin) >= enough else self._build_with(most, min(manner.fill, WASTEFUL))

    def _build_with(self, most: int, fill: float) -> Built:
        manner = self.manner
        return build_blocks(
            self.whole,
            most,
            fill=fill,
            grids=manner.grids,
            powers=(manner.count, manner.density + float(self.flat)),
            flat=self.flat,
        )

    def _search(self, built: Built, width: int, *, refill: bool = False) -> bool:
        """Search with a beam of `width`, or refill what is left; return whether a wider one may find more."""
        kept = self.filling if refill else Filling(self.filling.single[:0], self.filling.boxes[:0], 0.0)
        standing = np.concatenate((self.whole.obstacles, kept.boxes))
        sizes = sizes_of(self.whole, len(standing), len(built.origin))
        if width > sizes.widest:
            return False
        manner = self.manner
        room = room_of(self.whole, sizes, margin=manner.margin, power=manner.power, flat=self.flat)
        states, scratch = states_of(sizes, 2 * width + 1), scratch_of(sizes, width)
        states.stock[kernel.FIRST] = self.whole.stock
        np.subtract.at(states.stock[kernel.FIRST], self.whole.kind[kept.single], 1)
        states.counts[kernel.FIRST, kernel.ALIVE] = len(built.origin)
        states.alive[kernel.FIRST] = np.arange(len(built.origin))
        states.value[kernel.FIRST] = kept.value
        columns = len(self.whole.obstacles)
        best, value = np.zeros((sizes.boxes, 7), np.int64), np.array([self.filling.value])
        kernel.search(
            width, standing, columns, states, built.blocks, room, scratch, best, value, self.control
        )
        if value[0] > self.filling.value:
            placed = best[len(standing) : self.control[kernel.LENGTH]]
            self.filling = _filling(self.whole, built, placed, kept, float(value[0]))
        return bool(self.control[kernel.MORE])


def _push_down(boxes: Int64s, obstacles: Int64s, *, flat: bool) -> None:
    """Push boxes ``(n, 6)`` (in place) down, then to the front and the left, a few times or until none moves."""
    rounds = MOST_PAIRS // (3 * len(boxes) * (len(boxes) + len(obstacles)) + 1)
    for _ in range(min(rounds, 4)):
        axes = (1, 0) if flat else (2, 1, 0)
        if not sum(push(boxes, np.argsort(boxes[:, a], kind="stable"), obstacles, a) for a in axes):
            return


def _filling(whole: Whole, built: Built, placed: Int64s, kept: Filling, value: float) -> Filling:
    """Return the boxes of the placed blocks ``(n, 7)`` besides those kept."""
    boxes = [box for row in placed for box in built.boxes(int(row[6]), row[:3])]
    single = np.array([number for number, _ in boxes], dtype=np.int64)
    corner = np.array([at for _, at in boxes], dtype=np.int64).reshape(-1, 3)
    corners = np.hstack((corner, corner + whole.singles[single]))
    return Filling(np.concatenate((kept.single, single)), np.concatenate((kept.boxes, corners)), value)
