"""Guided separation within fixed builds, and the disturbance of layouts from which it starts again."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Int64s
from amprep.kernels.no_fit.records import PositionRange
from amprep.plugins.packers.separation.programs import make_exact
from amprep.plugins.packers.separation.state import Placed, Scene, only, placed_from

PROGRESS = 0.98
"""The total overlap must fall below this fraction of the least one to count as progress."""

PATIENCE = 0.1
"""Fraction of the work or time that may pass without progress in one layout of many parts."""

RESIDUE = 0.1
"""Total overlap, in mean sizes of the shapes, at which the linear program is tried."""

SMALL = 1e-4
"""Total overlap (mm) at which the linear program is tried in any case."""


class Attempt:
    """Result of a separation: the layout of least overlap, and the one without any if it was found."""

    def __init__(self, overlap: float, nearest: Placed, exact: Placed | None) -> None:
        self.overlap, self.nearest, self.exact = overlap, nearest, exact


def separated(
    scene: Scene,
    start: Placed,
    within: PositionRange,
    builds: int,
    useless: Callable[[], bool] = lambda: False,
    room: PositionRange | None = None,
) -> Attempt:
    """Move overlapping items until nothing overlaps, or until there is no progress for a while.

    `useless` tells after each span whether the attempt has become pointless, because a better layout is known. The
    programs that make a layout exact may use the positions of `room` as well, which contain those `within`.
    """
    layout = scene.layout(_clipped(scene, start, within))
    best = scene.layout(start)
    items = start.items
    state, rules = scene.work_arrays(len(items), within), scene.rules(items, builds)
    least, nearest, idle, since = np.inf, start, 0, scene.budget.used
    residue = RESIDUE * scene.instance.mean_size
    while not (scene.budget.over() or useless()):
        if idle >= scene.params.persistence or scene.budget.used > since + PATIENCE:
            break
        overlap = scene.run(layout, best, rules, within, state)
        idle, since = (0, scene.budget.used) if overlap < PROGRESS * least else (idle + 1, since)
        if overlap < least:
            least, nearest = overlap, placed_from(best, items)
        if overlap < residue and (overlap < SMALL or overlap <= least):
            exact = _exact(scene, placed_from(best, items), within if room is None else room)
            if exact is not None:
                return Attempt(0.0, nearest, exact)
            if overlap <= rules.enough:
                break
    return Attempt(least, nearest, None)


def _exact(scene: Scene, placed: Placed, within: PositionRange) -> Placed | None:
    """Return a layout near another without overlaps, found for each build on its own; None if none is found."""
    position = placed.position.copy()
    for build in range(placed.builds):
        rows = np.flatnonzero(placed.build == build)
        found = make_exact(scene, only(placed, rows), within) if len(rows) else None
        if found is None and len(rows):
            return None
        if found is not None:
            position[rows] = found.position
    return placed._replace(position=position)


def _clipped(scene: Scene, placed: Placed, within: PositionRange) -> Placed:
    """Return a layout with all items inside the build volume, as far as its sides are planes.

    Items in a shape that is too high get the lowest one.
    """
    instance, shape = scene.instance, placed.shape.copy()
    for row in np.flatnonzero((within.hi < within.lo)[shape].any(axis=1)).tolist():
        first, end = int(instance.first[placed.items[row]]), int(instance.end[placed.items[row]])
        shape[row] = first + int(np.argmin(instance.size[first:end, 2]))
    position = np.maximum(np.minimum(placed.position, within.hi[shape]), within.lo[shape])
    return placed._replace(shape=shape, position=position)


def disturbed(scene: Scene, placed: Placed) -> Placed:
    """Exchange the places of two items, large ones more often; of two pairs in half of all cases."""
    changed, size, rng = placed.copy(), scene.instance.size, scene.rng
    n = len(placed.items)
    if n < 2:
        return changed
    for _ in range(int(rng.integers(1, 3))):
        chance = size[changed.shape].prod(axis=1) ** (2.0 / 3.0)
        i, j = rng.choice(n, 2, replace=False, p=chance / chance.sum()).tolist()
        middle = changed.position + size[changed.shape] / 2.0
        changed.position[[i, j]] = middle[[j, i]] - size[changed.shape[[i, j]]] / 2.0
        changed.build[[i, j]] = changed.build[[j, i]]
    return changed


def put_at_random(scene: Scene, items: Int64s, builds: int, within: PositionRange) -> Placed:
    """Return items at random positions in random builds, each in one of its shapes."""
    instance, rng = scene.instance, scene.rng
    shape = np.array(
        [int(rng.integers(instance.first[item], instance.end[item])) for item in items], np.int64
    )
    lo, hi = within.lo[shape], np.maximum(within.hi, within.lo)[shape]
    position = lo + rng.random((len(items), 3)) * (hi - lo)
    return Placed(items, shape, rng.integers(0, builds, len(items)), position)


class AttemptPool:
    """The attempts with the least overlap, from which the search starts again."""

    SIZE = 8

    def __init__(self) -> None:
        self.attempts: list[Attempt] = []

    def add(self, attempt: Attempt) -> None:
        """Add a failed attempt; the worst one leaves a full pool."""
        self.attempts.append(attempt)
        self.attempts.sort(key=lambda each: each.overlap)
        del self.attempts[self.SIZE :]

    def choose(self, scene: Scene, best: Placed | None) -> Placed:
        """Return the best layout so far or, as often, one of the attempts, those of little overlap more often.

        Without a best layout it is always one of the attempts.
        """
        if best is not None and (scene.rng.random() < 0.5 or not self.attempts):
            return best
        number = min(int(scene.rng.exponential(1.5)), len(self.attempts) - 1)
        return self.attempts[number].nearest
