"""The blocks of a worker: made by the kernel, sorted by merit, and taken apart again."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Int64s
from amprep.kernels.blocks.making import GRID, MOST_KINDS, Making, make_blocks
from amprep.kernels.blocks.records import Blocks
from amprep.plugins.packers.block_building.integer_instance import Whole


@dataclass(frozen=True, eq=False)
class Built:
    """Blocks as the search reads them, and how each was made.

    Attributes
    ----------
    origin
        ``(b,)`` row of `making` of each block.
    """

    blocks: Blocks
    making: Making
    origin: Int64s
    singles: Int64s

    def boxes(self, block: int, corner: Int64s) -> list[tuple[int, Int64s]]:
        """Return the single and the least corner of each box of a block that lies at `corner`."""
        found: list[tuple[int, Int64s]] = []
        pending = [(int(self.origin[block]), corner)]
        while pending:
            row, at = pending.pop()
            how = self.making.made[row]
            if how[0] == GRID:
                steps = np.indices(how[2:5]).reshape(3, -1).T * self.singles[how[1]]
                found += [(int(how[1]), at + step) for step in steps]
                continue
            beyond = at.copy()
            beyond[how[0]] += self.making.size[how[1], how[0]]
            pending += [(int(how[1]), at), (int(how[2]), beyond)]
        return found


def build_blocks(
    whole: Whole, most: int, *, fill: float, grids: float, powers: tuple[float, float], flat: bool
) -> Built:
    """Return at least a block for each single box, and up to `most` in all.

    Parameters
    ----------
    fill
        Least share of a block's box that its boxes take up.
    grids
        Share of the blocks that are grids of equal boxes, at most.
    powers
        Exponents of the number of boxes, which a block's merit is divided by, and of its value over volume
        (area when flat).
    """
    most = max(most, len(whole.singles))
    making = _empty(most)
    # any odd numbers do
    salt = np.random.default_rng(0).integers(0, 2**62, len(whole.items) + 3).astype(np.uint64) * 2 + 1
    made = make_blocks(
        whole.singles, whole.kind, whole.worth, whole.stock, whole.room[3:],
        int(grids * most), fill, 2 if flat else 3, salt, making,
    )  # fmt: skip
    density = making.value[:made] / making.full[:made]
    base = making.value[:made] * (density / density.max(initial=0.0)) ** powers[1]
    base *= making.number[:made].sum(axis=1) ** -powers[0]
    order = np.argsort(-base, kind="stable")
    size, number = making.size[order], making.number[order]
    single = np.flatnonzero(number.sum(axis=1) == 1)
    single = single[np.argsort(size[single].astype(np.float64).prod(axis=1), kind="stable")]
    blocks = Blocks(size, making.kind[order], number, making.value[order], base[order], single)
    return Built(blocks, making, order, whole.singles)


def _empty(most: int) -> Making:
    """Return room for `most` blocks and one that is being tried."""
    rows = most + 1
    return Making(
        size=np.zeros((rows, 3), np.int64),
        made=np.zeros((rows, 5), np.int64),
        kind=np.zeros((rows, MOST_KINDS), np.int64),
        number=np.zeros((rows, MOST_KINDS), np.int64),
        full=np.zeros(rows),
        value=np.zeros(rows),
        table=np.zeros(1 << (2 * rows).bit_length(), np.uint64),
    )
