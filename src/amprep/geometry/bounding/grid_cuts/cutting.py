"""Cut a solid in the cells of a grid into sets of cells, and merge these."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int32s, Int64s
from amprep.geometry.bounding.grid_cuts.cells import SolidCells
from amprep.geometry.bounding.grid_cuts.directions import sphere_directions
from amprep.kernels.bounding.grid_cuts.records import DIRECTIONS, CutWork, GridCells, MeasuredSets

MOST_COMPONENTS = 500
"""Largest number of components that a plane may leave of a set."""

CONVEX = 1e-6
"""Excess of a set, as a fraction of the volume of the solid, up to which it is not cut.

The estimate is exact for boxes, and may be negative for round sets, which are cut.
"""


@dataclass(frozen=True, eq=False)
class SetOfCells:
    """A connected set of cells.

    Attributes
    ----------
    members
        ``(n,)`` cells.
    frame
        ``(6,)`` least corner of the box around the solid in them, and the reciprocals of its sides.
    points
        ``(DIRECTIONS,)`` its extreme points.
    hull, volume
        Volume of its hull, nearly, and of the solid in the cells.
    """

    members: Int32s
    frame: Floats
    points: Int32s
    hull: float
    volume: float

    @property
    def excess(self) -> float:
        """Volume of the hull outside the solid."""
        return self.hull - self.volume


def cut_cells_apart(solid: SolidCells, most: int, stop: Callable[[], bool]) -> list[SetOfCells]:
    """Cut the cells of a solid into about `most` sets; the set whose hull has the greatest excess is cut next."""
    from amprep.kernels.bounding.grid_cuts.cut import cut_cells

    cells, directions = solid.cells, sphere_directions()
    work, found = _work(cells), _measured_sets()
    numbers = np.zeros(2, np.int64)
    members = np.arange(len(cells.place), dtype=np.int32)
    count = cut_cells(cells, work, directions, members, np.empty(6), numbers, found)
    todo = _sets(members, found, count)
    done: list[SetOfCells] = []
    convex = CONVEX * float(cells.volume.sum())
    while todo and len(todo) + len(done) < most and not stop():
        worst = todo.pop(max(range(len(todo)), key=lambda k: todo[k].excess))
        count = 1
        if abs(worst.excess) > convex:
            count = cut_cells(cells, work, directions, worst.members, worst.frame, numbers, found)
        if count > 1:
            todo += _sets(worst.members, found, count)
        else:
            done.append(worst)
    return todo + done


def _work(cells: GridCells) -> CutWork:
    n, longest = len(cells.place), max(cells.number.shape)
    zeros = [np.zeros(n, np.int32) for _ in range(4)]
    flags = [np.zeros(n, np.uint8) for _ in range(2)]
    values = [np.empty((n, DIRECTIONS)) for _ in range(2)]
    indices = [np.empty((n, DIRECTIONS), np.int32) for _ in range(2)]
    return CutWork(
        zeros[0],
        flags[0],
        values[0],
        indices[0],
        zeros[1],
        zeros[2],
        values[1],
        indices[1],
        flags[1],
        np.empty(n),
        zeros[3],
        np.zeros(longest + 2, np.int64),
        np.zeros((6, longest + 1)),
        np.empty((DIRECTIONS, 3)),
    )


def _measured_sets() -> MeasuredSets:
    k = MOST_COMPONENTS
    end, frame, points = np.empty(k, np.int64), np.empty((k, 6)), np.empty((k, DIRECTIONS), np.int32)
    return MeasuredSets(end, frame, points, np.empty(k), np.empty(k))


def _sets(members: Int32s, found: MeasuredSets, count: int) -> list[SetOfCells]:
    parts = np.split(members, found.end[: count - 1])
    frames, points = found.frame[:count].copy(), found.points[:count].copy()
    hulls, volumes = found.hull[:count].tolist(), found.volume[:count].tolist()
    return [SetOfCells(*each) for each in zip(parts, frames, points, hulls, volumes, strict=True)]


def merge_order(solid: SolidCells, sets: list[SetOfCells]) -> tuple[Int64s, Floats]:
    """Merge sets in pairs until one is left.

    Returns
    -------
    merged
        ``(n - 1, 2)`` sets that are merged, in this order; the first gets the place of both.
    hulls
        ``(n,)`` total volume of the hulls of 1, 2, ... n sets, nearly.
    """
    from amprep.kernels.bounding.grid_cuts.merge import merge_sets

    n = len(sets)
    places = [solid.cells.place[each.members] for each in sets]
    low, high = np.array([p.min(axis=0) for p in places]), np.array([p.max(axis=0) + 1 for p in places])
    near = ((low[:, None] <= high) & (high[:, None] >= low)).all(axis=2)
    total, merged = np.empty(n), np.empty((n - 1, 2), np.int64)
    volume = np.array([each.hull for each in sets])
    points = np.array([each.points for each in sets])
    merge_sets(solid.cells.points, points, near, sphere_directions(), volume, merged, total)
    return merged, total
