"""Constructive pass: each item at the lowest free position of a grid, in the first build that has one."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import PositionRange, ShapeLayout
from amprep.kernels.no_fit.scan import lowest_free
from amprep.plugins.packers.separation.state import Placed, Scene, nothing_placed, only, placed_from

FREE = 1e-4
"""Total overlap (mm) that counts as none; rounding of samples causes less."""

UNPLACED = -2
"""Build of an item that is in none."""


class LowestPositionPass:
    """Items that are placed one after another, at positions two steps of the fields apart.

    Positions are counted from the least position, so that every sample is exact.
    """

    def __init__(self, scene: Scene, items: Int64s, within: PositionRange, start: Placed) -> None:
        self.scene, self.within = scene, within
        self.spacing = 2.0 * scene.no_fit.fields.step
        n, m = len(start.items) + len(items), len(start.items)
        self.placed = Placed(
            np.concatenate((start.items, items)),
            np.concatenate((start.shape, np.zeros(n - m, np.int64))),
            np.concatenate((start.build, np.full(n - m, UNPLACED))),
            np.concatenate((start.position, np.zeros((n - m, 3)))),
        )
        self.layout: ShapeLayout = scene.layout(self.placed)
        self.weight = np.ones((n, len(self.layout.shape)))
        self.sums = np.empty(1, np.float32)
        self.top: dict[int, float] = {}
        for build, shape, position in zip(start.build, start.shape, start.position, strict=True):
            self._raise_top(int(build), int(shape), position)

    def place(self, k: int, builds: int) -> bool:
        """Place row k in the first of some builds that has a free position; return whether one has."""
        for build in range(builds):
            self.layout.build[k] = build
            found = self._lowest(k, build)
            if (
                found is None
                and build not in self.top
                and not (build == 0 and self.scene.instance.problem.fixed)
            ):
                found = self._alone(int(self.placed.items[k]))
            if found is not None:
                self.layout.shape[k], self.layout.position[k] = found
                self._raise_top(build, *found)
                return True
        self.layout.build[k] = UNPLACED
        return False

    def _lowest(self, k: int, build: int) -> tuple[int, Floats] | None:
        """Return the shape of a row with the lowest top, and its lowest free position; None without one."""
        instance, best, least = self.scene.instance, None, np.inf
        item = int(self.placed.items[k])
        for shape in range(instance.first[item], instance.end[item]):
            grid = self._grid(shape, build)
            if grid is None:
                continue
            self.layout.shape[k] = shape
            fields = self.scene.no_fit.fields
            cell = lowest_free(fields, self.within, self.layout, self.weight, k, grid, FREE, self.sums)
            self.scene.budget.left -= 2.0 * float(grid.prod())
            if cell < 0:
                continue
            at = self.within.lo[shape] + self.spacing * np.array(np.unravel_index(cell, grid))
            if at[2] + instance.size[shape, 2] < least - 1e-9:
                best, least = (shape, at), at[2] + instance.size[shape, 2]
        return best

    def _grid(self, shape: int, build: int) -> Int64s | None:
        """Return the number of cells along each axis, up to the first layer above all items of the build."""
        lo, hi = self.within.lo[shape], self.within.hi[shape]
        if (hi < lo).any():
            return None
        obstacles = self.scene.no_fit.obstacles
        above = [
            self.top.get(build, 0.0),
            *(o.position[2] + np.concatenate(o.pieces)[:, 2].max() for o in obstacles),
        ]
        highest = min(hi[2], max(*above, lo[2]) + self.scene.instance.problem.clearance + self.spacing)
        grid = ((np.array([hi[0], hi[1], highest]) - lo) / self.spacing + 1e-9).astype(np.int64) + 1
        if grid.prod() > len(self.sums):
            self.sums = np.empty(2 * int(grid.prod()), np.float32)
        return np.asarray(grid)

    def _alone(self, item: int) -> tuple[int, Floats]:
        """Return a shape and position of an item in an empty build."""
        instance = self.scene.instance
        shapes = range(instance.first[item], instance.end[item])
        shape = min((s for s in shapes if instance.shapes[s].fits), key=lambda s: float(instance.size[s, 2]))
        return shape, instance.shapes[shape].feasible_position

    def _raise_top(self, build: int, shape: int, position: Floats) -> None:
        top = float(position[2] + self.scene.instance.size[shape, 2])
        self.top[build] = max(self.top.get(build, 0.0), top)


def construct(
    scene: Scene, items: Int64s, within: PositionRange, most_builds: int, start: Placed | None = None
) -> Placed:
    """Place items one after another at their lowest free positions; return those that are placed.

    Parameters
    ----------
    items
        Items in the order in which they are placed.
    most_builds
        Number of builds after which items without a free position are left out.
    start
        Items that are placed before.
    """
    begun = nothing_placed() if start is None else start
    work = LowestPositionPass(scene, items, within, begun)
    builds = max(begun.builds, 1)
    for k in range(len(begun.items), len(work.placed.items)):
        if scene.budget.over():
            break
        if work.place(k, min(builds + 1, most_builds)):
            builds = max(builds, int(work.layout.build[k]) + 1)
    placed = placed_from(work.layout, work.placed.items)
    return only(placed, np.flatnonzero(placed.build >= 0))


def by_size(scene: Scene, items: Int64s) -> Int64s:
    """Return items in the order of decreasing volume of their enclosing boxes, equal ones together."""
    instance = scene.instance
    first = instance.first[items]
    volume = instance.size[first].prod(axis=1)
    return np.asarray(items[np.lexsort((items, first, -volume))])
