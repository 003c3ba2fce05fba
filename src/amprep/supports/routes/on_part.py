"""Stands supports on the part they hold where no way leads to the plate: straight columns with a foot."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Bytes, Ints
from amprep.model.support_edges import SupportEdges
from amprep.model.supports import Voxel
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.grid.voxel_states import PartVoxels

DEEPEST = 2
"""Cubes below a green square that its foot may pass on its way to the surface."""


class Grounded(NamedTuple):
    """Columns that end on a part.

    Attributes
    ----------
    edges
        The edges of the columns.
    feet
        ``(k, 5)`` int32: the green square (plane, y, x) on top of a occupied voxel, the part, and how many voxels of
        its column the foot may pass downwards.
    served
        ``(m,)`` which red squares they connect.
    """

    edges: SupportEdges
    feet: Ints
    served: Bools


def stand_on_parts(
    voxels: Bytes,
    meeting: Bytes,
    blocks: Sequence[PartVoxels],
    red: RedSquares,
    left: Bools,
    edges: SupportEdges,
) -> Grounded:
    """Lead the red squares that are `left` ``(m,)`` straight down to the first occupied voxel.

    That voxel has to belong to the part that the square holds, and to no other; the voxels on the way are white
    and in no other part's supports.
    """
    users = edges.voxel_parts()
    found: list[list[int]] = []
    feet: dict[tuple[int, int, int], list[int]] = {}
    served = np.zeros(len(left), np.bool_)
    for number in np.flatnonzero(left).tolist():
        (plane, y, x), part = red.square[number].tolist(), int(red.part[number])
        below = plane - 1
        while below >= 0 and voxels[below, y, x] == Voxel.FREE and users.get((below, y, x), part) == part:
            below -= 1
        if below < 0 or below == plane - 1 or not _bears(voxels, meeting, blocks[part], (below, y, x)):
            continue
        served[number] = True
        for k in range(below + 1, plane):
            users[k, y, x] = part
        found += [[k + 1, y, x, 0, 1, 1, part] for k in range(below + 1, plane)]
        deep = 1
        while deep < DEEPEST and _bears(voxels, meeting, blocks[part], (below - deep, y, x)):
            deep += 1
        feet[below + 1, y, x] = [below + 1, y, x, part, deep]
    return Grounded(
        SupportEdges.from_rows(found),
        np.array(list(feet.values()), np.int32).reshape(-1, 5),
        served,
    )


def _bears(voxels: Bytes, meeting: Bytes, block: PartVoxels, voxel: tuple[int, int, int]) -> bool:
    """Tell whether a voxel is black because of the part alone."""
    inner = tuple(at - first for at, first in zip(voxel, block.window.first, strict=True))
    if not all(0 <= at < count for at, count in zip(inner, block.window.shape, strict=True)):
        return False
    return bool(block.black[inner] and meeting[voxel] == 1 and voxels[voxel] == Voxel.OCCUPIED)
