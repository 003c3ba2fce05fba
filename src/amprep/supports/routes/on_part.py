"""Ground supports on parts: straight columns that stand on the part they support."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Ints
from amprep.model.supports import Voxel
from amprep.model.supports.edges import SupportEdges
from amprep.supports.grid.red_squares import SupportGrid
from amprep.supports.grid.territory import PartTerritory

LARGEST_DEPTH = 2
"""Number of voxels below the lowest square of a column through which its foot may reach the surface."""

Index = tuple[int, int, int]


class Grounded(NamedTuple):
    """Columns that end on a part.

    Attributes
    ----------
    edges
        The edges of the columns.
    feet
        ``(k, 5)`` int32: lowest square of a column (plane, y, x), the part it stands on, and the number of voxels
        below the square that its foot may pass.
    connected
        ``(m,)`` bool, the red squares that the columns connect.
    """

    edges: SupportEdges
    feet: Ints
    connected: Bools


def stand_on_parts(
    laid: SupportGrid, left: Bools, edges: SupportEdges, territories: Sequence[PartTerritory] = ()
) -> Grounded:
    """Connect red squares by straight columns down to the first occupied voxel.

    The voxel must be occupied by the part that the red square belongs to, and by no other part. The voxels above
    it must be free, in the territory of the part, and not used by the supports of other parts.

    Parameters
    ----------
    laid
        Position and size of the voxels.
    left
        ``(m,)`` bool, the red squares to connect.
    edges
        The edges routed so far.
    territories
        Where the supports of each part may be; none where parts share all space.
    """
    users = edges.voxel_parts()
    rows: list[list[int]] = []
    feet: dict[Index, list[int]] = {}
    connected = np.zeros(len(left), np.bool_)
    for number in np.flatnonzero(left).tolist():
        (plane, y, x), part = laid.red.square[number].tolist(), int(laid.red.part[number])
        below = plane - 1
        while (
            below >= 0 and laid.voxels[below, y, x] == Voxel.FREE and users.get((below, y, x), part) == part
        ):
            below -= 1
        if below < 0 or below == plane - 1 or not _is_bearing(laid, part, (below, y, x)):
            continue
        column = np.array([[k, y, x] for k in range(below + 1, plane)])
        if territories and not territories[part].allows(column).all():
            continue
        connected[number] = True
        for k in range(below + 1, plane):
            users[k, y, x] = part
        rows += [[k + 1, y, x, 0, 1, 1, part] for k in range(below + 1, plane)]
        depth = 1
        while depth < LARGEST_DEPTH and _is_bearing(laid, part, (below - depth, y, x)):
            depth += 1
        feet[below + 1, y, x] = [below + 1, y, x, part, depth]
    return Grounded(
        SupportEdges.from_rows(rows), np.array(list(feet.values()), np.int32).reshape(-1, 5), connected
    )


def _is_bearing(laid: SupportGrid, part: int, voxel: Index) -> bool:
    """Tell whether a voxel is occupied by this part alone."""
    own = laid.parts[part]
    inner = tuple(at - first for at, first in zip(voxel, own.block.first, strict=True))
    if not all(0 <= at < count for at, count in zip(inner, own.block.shape, strict=True)):
        return False
    return bool(own.occupied[inner] and laid.part_count[voxel] == 1 and laid.voxels[voxel] == Voxel.OCCUPIED)
