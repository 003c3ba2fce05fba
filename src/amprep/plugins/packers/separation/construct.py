"""Constructive pass: each item at the lowest free position of a grid, in the first build that has one."""

from collections.abc import Callable, Iterator

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import PositionRange, ShapeLayout
from amprep.kernels.no_fit.scan import lowest_free
from amprep.plugins.packers.separation.state import Placed, Scene, nothing_placed, only, placed_from

UNPLACED = -2
"""Build of an item that is in none."""

SPARE = 8
"""Layers of cells by which a grid is higher than needed, so that it can be used again when the layout grows."""

MOST_ORDERS = 20
"""Number of random orders of the items."""

CHEAP = 0.03
"""Fraction of the work or time up to which further orders of the items are tried."""


class ScannedBuild:
    """Sums of overlaps of one shape in one build, and the row of the layout up to which they are known."""

    def __init__(self, grid: Int64s) -> None:
        self.grid = grid
        self.sums = np.empty(int(grid.prod()), np.float32)
        self.rows = 0


class LowestPositionPass:
    """Items that are placed one after another, at multiples of the step of the fields from the least position.

    Identical items that follow one another share scans: only items placed in the meantime are added. A build without
    room for an item has none for an identical one.
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
        self.weight = np.broadcast_to(1.0, (n, len(self.layout.shape)))
        self.top: dict[int, float] = {}
        self.scanned: dict[tuple[int, int], ScannedBuild] = {}
        self.full: set[tuple[int, int]] = set()
        for build, shape, position in zip(start.build, start.shape, start.position, strict=True):
            self._raise_top(int(build), int(shape), position)

    def place(self, k: int, builds: int) -> bool:
        """Place row k in the first of some builds that has a free position; return whether one has."""
        item = int(self.placed.items[k])
        first = int(self.scene.instance.first[item])
        if first not in {shape for shape, _ in self.scanned}:
            self.scanned.clear()
        for build in range(builds):
            if (first, build) in self.full:
                continue
            self.layout.build[k] = build
            found = self._lowest(k, build)
            if found is None and build not in self.top and not self._has_fixed(build):
                found = self._alone(item)
            if found is not None:
                self.layout.shape[k], self.layout.position[k] = found
                self._raise_top(build, *found)
                return True
            self.full.add((first, build))
        self.layout.build[k] = UNPLACED
        return False

    def _has_fixed(self, build: int) -> bool:
        return build == 0 and bool(self.scene.instance.problem.fixed)

    def _lowest(self, k: int, build: int) -> tuple[int, Floats] | None:
        """Return the shape of a row with the lowest top, and its lowest free position; None without one."""
        instance, best, least = self.scene.instance, None, np.inf
        item = int(self.placed.items[k])
        for shape in range(instance.first[item], instance.end[item]):
            scan = self._scan_of(shape, build)
            if scan is None:
                continue
            self.layout.shape[k] = shape
            fields, within = self.scene.no_fit.fields, self.within
            read = lowest_free(fields, within, self.layout, self.weight, k, scan.rows, scan.grid, scan.sums)
            scan.rows = k
            self.scene.budget.left -= abs(read)
            top = self.layout.position[k, 2] + instance.size[shape, 2]
            if read > 0 and top < least - 1e-9:
                best, least = (shape, self.layout.position[k].copy()), top
        return best

    def _scan_of(self, shape: int, build: int) -> ScannedBuild | None:
        """Return the sums of a shape in a build, as far as known; None if the shape does not fit."""
        lo, hi = self.within.lo[shape], self.within.hi[shape]
        if (hi < lo).any():
            return None
        counts = ((hi - lo) / self.spacing + 1e-9).astype(np.int64) + 1
        above = max(self._above(build) - float(lo[2]), 0.0)
        needed = min(int(above / self.spacing) + 2, int(counts[2]))
        known = self.scanned.get((shape, build))
        if known is None or known.grid[2] < needed:
            known = ScannedBuild(np.array([counts[0], counts[1], min(needed + SPARE, int(counts[2]))]))
            self.scanned[shape, build] = known
        return known

    def _above(self, build: int) -> float:
        """Return the position (mm) from which on an item is above all others and the obstacles."""
        obstacles = self.scene.no_fit.obstacles
        tops = [float(o.position[2] + np.concatenate(o.pieces)[:, 2].max()) for o in obstacles]
        return max(self.top.get(build, 0.0), *tops, 0.0) + self.scene.instance.problem.clearance

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
        scene.progress(scene.budget.fraction, f"{k} of {len(work.placed.items)} parts placed")
        if work.place(k, min(builds + 1, most_builds)):
            builds = max(builds, int(work.layout.build[k]) + 1)
    placed = placed_from(work.layout, work.placed.items)
    return only(placed, np.flatnonzero(placed.build >= 0))


def best_constructed(
    scene: Scene,
    items: Int64s,
    within: PositionRange,
    most_builds: int,
    value: Callable[[Placed], float],
    worker: int,
    density: Floats | None = None,
) -> Placed:
    """Return the layout of least value of some passes; the passes of each worker begin with another order.

    Parameters
    ----------
    value
        Value of a layout; less is better.
    worker
        Number of the worker.
    density
        ``(n,)`` value of each item per volume, where items of greater value come first.
    """
    orders = _orders(scene, items, worker, density)
    best = construct(scene, next(orders), within, most_builds)
    for order in orders:
        if scene.budget.fraction > CHEAP or scene.budget.over():
            break
        found = construct(scene, order, within, most_builds)
        if value(found) < value(best):
            best = found
    return best


def _orders(scene: Scene, items: Int64s, worker: int, density: Floats | None) -> Iterator[Int64s]:
    """Yield orders of the items by decreasing size, equal ones together, then such with sizes changed at random."""
    instance = scene.instance
    first = instance.first[items]
    size = instance.size[first]
    keys = [
        size.prod(axis=1),
        size[:, 2] * size[:, :2].max(axis=1),
        instance.volumes[items],
        size[:, 2],
        size[:, :2].prod(axis=1),
        size.max(axis=1),
    ]
    if density is not None:
        keys = [density, density * keys[0], *(density * np.sqrt(key) for key in keys)]
    for k in range(len(keys)):
        yield _by_key(items, first, keys[(k + worker) % len(keys)])
    for k in range(MOST_ORDERS):
        changed = np.exp(scene.rng.normal(0.0, 0.3, len(instance.shapes)))[first]
        yield _by_key(items, first, keys[k % len(keys)] * changed)


def _by_key(items: Int64s, first: Int64s, key: Floats) -> Int64s:
    """Return items in the order of a decreasing key, those of the same type together."""
    return np.asarray(items[np.lexsort((items, first, -key))])


def by_size(scene: Scene, items: Int64s) -> Int64s:
    """Return items in the order of decreasing volume of their enclosing boxes, equal ones together."""
    first = scene.instance.first[items]
    return _by_key(items, first, scene.instance.size[first].prod(axis=1))
