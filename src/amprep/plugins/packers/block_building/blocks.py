"""Generate the set of blocks for a search, sort it by score, and take blocks apart into boxes."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Int64s
from amprep.kernels.blocks.making import GRID, make_blocks
from amprep.kernels.blocks.records import MAX_ITEM_TYPES, Blocks, BlockTable
from amprep.plugins.packers.block_building.integer_instance import IntegerInstance


@dataclass(frozen=True, eq=False)
class BlockSet:
    """Blocks as the search reads them, with their construction.

    Attributes
    ----------
    origin
        ``(b,)`` row of each block in `table`.
    box_size
        ``(s, 3)`` sides of the oriented boxes.
    """

    blocks: Blocks
    table: BlockTable
    origin: Int64s
    box_size: Int64s

    def boxes(self, block: int, corner: Int64s) -> list[tuple[int, Int64s]]:
        """Return the oriented box and the lower corner of each box of a block placed at `corner`."""
        found: list[tuple[int, Int64s]] = []
        pending = [(int(self.origin[block]), corner)]
        while pending:
            row, at = pending.pop()
            how = self.table.made[row]
            if how[0] == GRID:
                steps = np.indices(how[2:5]).reshape(3, -1).T * self.box_size[how[1]]
                found += [(int(how[1]), at + step) for step in steps]
                continue
            behind = at.copy()
            behind[how[0]] += self.table.size[how[1], how[0]]
            pending += [(int(how[1]), at), (int(how[2]), behind)]
        return found


def build_blocks(
    instance: IntegerInstance,
    count: int,
    *,
    min_fill: float,
    grids: float,
    exponents: tuple[float, float],
    flat: bool,
) -> BlockSet:
    """Return a block for each oriented box, and up to `count` blocks in total.

    Parameters
    ----------
    instance
        The boxes and the container.
    count
        Largest number of blocks, unless there are more oriented boxes.
    min_fill
        Smallest filled fraction of a block's enclosing box.
    grids
        Largest fraction of the blocks that are grids of equal boxes.
    exponents
        Exponents of the number of boxes, by which a block's score is divided, and of its value density (value
        per volume, or per area when flat), by which it is multiplied.
    flat
        True if nothing is stacked.
    """
    boxes = instance.boxes
    count = max(count, len(boxes.size))
    table = _empty(count)
    # odd numbers for the hash; any seed serves
    salt = np.random.default_rng(0).integers(0, 2**62, len(boxes.demand) + 3).astype(np.uint64) * 2 + 1
    made = make_blocks(
        boxes, instance.container[3:], int(grids * count), min_fill, 2 if flat else 3, salt, table
    )
    density = table.value[:made] / table.filled[:made]
    score = table.value[:made] * (density / density.max(initial=0.0)) ** exponents[1]
    score *= table.number[:made].sum(axis=1) ** -exponents[0]
    order = np.argsort(-score, kind="stable")
    size, number = table.size[order], table.number[order]
    single = np.flatnonzero(number.sum(axis=1) == 1)
    single = single[np.argsort(size[single].astype(np.float64).prod(axis=1), kind="stable")]
    blocks = Blocks(size, table.item_type[order], number, table.value[order], score[order], single)
    return BlockSet(blocks, table, order, boxes.size)


def _empty(count: int) -> BlockTable:
    """Return a table for `count` blocks and the one being tried."""
    rows = count + 1
    return BlockTable(
        size=np.zeros((rows, 3), np.int64),
        made=np.zeros((rows, 5), np.int64),
        item_type=np.zeros((rows, MAX_ITEM_TYPES), np.int64),
        number=np.zeros((rows, MAX_ITEM_TYPES), np.int64),
        filled=np.zeros(rows),
        value=np.zeros(rows),
        hashes=np.zeros(1 << (2 * rows).bit_length(), np.uint64),
    )
