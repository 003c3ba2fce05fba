"""Constructive pass: each item at the lowest free position of a grid, in the first build that has one."""

from collections.abc import Callable, Iterator

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import PositionRange, ShapeLayout
from amprep.kernels.no_fit.scan import lowest_free
from amprep.plugins.packers.separation.repair import repaired
from amprep.plugins.packers.separation.state import Placed, Scene, only, placed_from

UNPLACED = -2
"""Build of an item that is in none."""

SPARE = 8
"""Layers of cells by which a grid is higher than needed, so that it can be used again when the layout grows."""

MOST_ORDERS = 20
"""Number of random orders of the items."""

CHEAP = 0.05
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

    def __init__(self, scene: Scene, items: Int64s, within: PositionRange, *, even: bool) -> None:
        self.scene, self.within, self.even = scene, within, even
        self.spacing = 2.0 * scene.no_fit.fields.step
        n = len(items)
        self.placed = Placed(items, np.zeros(n, np.int64), np.full(n, UNPLACED), np.zeros((n, 3)))
        self.layout: ShapeLayout = scene.layout(self.placed)
        self.weight = np.broadcast_to(1.0, (n, len(self.layout.shape)))
        self.top: dict[int, float] = {}
        self.filled: dict[int, float] = {}
        self.scanned: dict[tuple[int, int], ScannedBuild] = {}
        self.full: set[tuple[int, int]] = set()

    def place(self, k: int, builds: int) -> bool:
        """Place row k in the first of some builds that has a free position; return whether one has.

        With `even`, the least filled build comes first.
        """
        item = int(self.placed.items[k])
        first = int(self.scene.instance.first[item])
        if first not in {shape for shape, _ in self.scanned}:
            self.scanned.clear()
        order = sorted(range(builds), key=lambda b: self.filled.get(b, 0.0)) if self.even else range(builds)
        for build in order:
            if (first, build) in self.full:
                continue
            self.layout.build[k] = build
            found = self._lowest(k, build)
            if found is None and build not in self.top and not self._has_fixed(build):
                found = self._alone(item)
            if found is not None:
                self._put(k, build, *found)
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
        top = max(self.top.get(build, 0.0), self.scene.no_fit.obstacle_top, 0.0)
        return top + self.scene.instance.problem.clearance

    def _alone(self, item: int) -> tuple[int, Floats]:
        """Return a shape and position of an item in an empty build."""
        instance = self.scene.instance
        shapes = range(instance.first[item], instance.end[item])
        shape = min((s for s in shapes if instance.shapes[s].fits), key=lambda s: float(instance.size[s, 2]))
        return shape, instance.shapes[shape].feasible_position

    def _put(self, k: int, build: int, shape: int, position: Floats) -> None:
        instance = self.scene.instance
        self.layout.build[k], self.layout.shape[k], self.layout.position[k] = build, shape, position
        top = float(position[2] + instance.size[shape, 2])
        self.top[build] = max(self.top.get(build, 0.0), top)
        volume = float(instance.volumes[self.placed.items[k]])
        self.filled[build] = self.filled.get(build, 0.0) + volume


def construct(
    scene: Scene, items: Int64s, within: PositionRange, most_builds: int, *, even: bool = False
) -> Placed:
    """Place items one after another at their lowest free positions; return those that are placed.

    Parameters
    ----------
    items
        Items in the order in which they are placed.
    most_builds
        Number of builds after which items without a free position are left out.
    even
        Whether items go to the least filled of all of these builds first, instead of to the first one.
    """
    work = LowestPositionPass(scene, items, within, even=even)
    builds = most_builds if even else 1
    for k in range(len(items)):
        if scene.budget.over():
            break
        scene.progress(scene.budget.used, f"{k} of {len(items)} parts placed")
        if work.place(k, min(builds + 1, most_builds)):
            builds = max(builds, int(work.layout.build[k]) + 1)
    placed = placed_from(work.layout, work.placed.items)
    placed = only(placed, np.flatnonzero(placed.build >= 0))
    return placed if scene.no_fit.exact else repaired(scene, placed, within, most_builds)


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
        ``(n,)`` value of each item per volume, where such items come first.
    """
    orders = _orders(scene, items, worker, density)
    begun = scene.budget.used
    best = construct(scene, next(orders), within, most_builds)
    for order in orders:
        if scene.budget.used > begun + CHEAP or scene.budget.over():
            break
        found = construct(scene, order, within, most_builds)
        if value(found) < value(best):
            best = found
    return best


def _orders(scene: Scene, items: Int64s, worker: int, density: Floats | None) -> Iterator[Int64s]:
    """Yield orders of the items by decreasing size, then such with sizes changed at random."""
    keys = _sizes(scene, items)
    if density is not None:
        keys = [density, *(density * np.cbrt(key) for key in keys)]
    for k in range(len(keys)):
        yield _by_key(scene, items, keys[(k + worker) % len(keys)])
    for k in range(MOST_ORDERS):
        yield random_order(scene, items, keys[k % len(keys)])


def _sizes(scene: Scene, items: Int64s) -> list[Floats]:
    """Return measures of size by which items are ordered."""
    size = scene.instance.size[scene.instance.first[items]]
    return [
        size.prod(axis=1),
        size[:, 2] * size[:, :2].max(axis=1),
        scene.instance.volumes[items],
        size[:, 2],
        size[:, :2].prod(axis=1),
        size.max(axis=1),
    ]


def random_order(scene: Scene, items: Int64s, key: Floats | None = None) -> Int64s:
    """Return items by decreasing size (or another key), changed at random for each type."""
    sizes = _sizes(scene, items)[0] if key is None else key
    types = scene.instance.first[items]
    return _by_key(
        scene, items, sizes * np.exp(scene.rng.normal(0.0, 0.3, len(scene.instance.shapes)))[types]
    )


def _by_key(scene: Scene, items: Int64s, key: Floats) -> Int64s:
    """Return items in the order of a decreasing key, those of the same type together."""
    return np.asarray(items[np.lexsort((items, scene.instance.first[items], -key))])


def by_size(scene: Scene, items: Int64s) -> Int64s:
    """Return items in the order of decreasing volume of their enclosing boxes, equal ones together."""
    return _by_key(scene, items, _sizes(scene, items)[0])
