"""Decompose a solid into convex pieces: cut it into cells, then merge cells."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.convex.cells import CutCell
from amprep.geometry.bounding.convex.merge import merge_cells
from amprep.geometry.bounding.convex.recursive_cuts import cut_into_cells

if TYPE_CHECKING:
    from manifold3d import Manifold

CELLS_A_PIECE = 4
"""Number of cells that are cut for each piece before cells are merged."""

LEAST_CELLS = 8
"""Number of cells up to which a solid is cut in any case."""

CUT_FRACTION = 0.1
"""Part of the permitted excess at which cutting ends; merging uses the rest."""


@dataclass(frozen=True)
class PieceGoal:
    """What the pieces should be like.

    Attributes
    ----------
    pieces
        Largest number of pieces.
    excess
        Excess of the total volume of the pieces over the volume of the solid, as a fraction of it, up to which
        fewer pieces are preferred.
    concavity
        Cells no deeper (mm) below their hull than this are not cut; 0 for no such limit.
    """

    pieces: int
    excess: float
    concavity: float = 0.0


def decompose_by_cuts(solid: "Manifold", goal: PieceGoal, stop: Callable[[], bool]) -> list[Floats]:
    """Return for each piece the points ``(k, 3)`` of which it is the convex hull; together the hulls contain the solid.

    Cavities are filled. At least one piece is made, and after an early end there may be more than `goal.pieces`.
    """
    volume = sum(part.volume() for part in solid.decompose() if part.volume() > 0.0)
    most = max(LEAST_CELLS, CELLS_A_PIECE * goal.pieces)
    cells = cut_into_cells(solid, most, CUT_FRACTION * goal.excess * volume, goal.concavity, stop)
    return merged_points(cells, goal, volume, stop)


def merged_points(
    cells: list[CutCell], goal: PieceGoal, volume: float, stop: Callable[[], bool]
) -> list[Floats]:
    """Merge cells into pieces; return the vertices of the cells of each piece."""
    groups = merge_cells([cell.corners for cell in cells], goal.pieces, (1.0 + goal.excess) * volume, stop)
    return [np.concatenate([cells[k].vertices for k in group]) for group in groups]
