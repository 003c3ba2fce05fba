"""The fill problem: items of great value on one plate. The height problem is one of these: all items count."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.control import Progress
from amprep.plugins.packers.plates.construct import construct
from amprep.plugins.packers.plates.guided import separated
from amprep.plugins.packers.plates.state import OnPlates, PlateScene

DIRECTIONS = ((0.0, 1.0), (1.0, 0.0), (0.7, 0.7))
"""Directions of the constructive passes."""

REPEATS = 4
"""How often each item that is left out is tried."""


def pack_most(scene: PlateScene, start: OnPlates, values: Floats, progress: Progress) -> OnPlates:
    """Return a layout of great value, from one that is given.

    It is constructed by value per area, and then one more item is put on the plate, overlapping, and all are separated;
    again and again, those of great value first.

    Parameters
    ----------
    values
        ``(n,)`` value of each item.
    """
    instance, best, work = scene.instance, start, scene.budget.left
    free = np.flatnonzero(instance.free)
    area = np.array([need.area for need in instance.needs])
    for key in (values / np.maximum(area, 1e-12), values):
        order = free[np.lexsort((free, instance.first[free], -key[free]))]
        for direction in DIRECTIONS:
            found = construct(scene, order, np.array(direction), 1)
            if values[found.items].sum() > values[best.items].sum() * (1.0 + 1e-12):
                best = found
            if len(best.items) == len(free):
                return best
    tried = dict.fromkeys(free.tolist(), 0)
    while not scene.budget.over() and (item := _next(best, free, values, tried)) is not None:
        tried[item] += 1
        larger = _inserted(scene, best, item)
        best = best if larger is None else larger
        progress(1.0 - max(scene.budget.left, 0.0) / max(work, 1.0), f"{len(best.items)} items")
    return best


def _next(best: OnPlates, free: Int64s, values: Floats, tried: dict[int, int]) -> int | None:
    """Return the item of greatest value among those that were tried least often; None after all."""
    left = [i for i in np.setdiff1d(free, best.items).tolist() if values[i] > 0.0 and tried[i] < REPEATS]
    return min(left, key=lambda i: (tried[i], -values[i], i), default=None)


def _inserted(scene: PlateScene, best: OnPlates, item: int) -> OnPlates | None:
    """Return a layout with one more item, None if none is found."""
    shape = int(scene.instance.first[item])
    lo, hi = scene.instance.arrays.lo[shape], scene.instance.arrays.hi[shape]
    position = lo + scene.rng.random(2) * np.maximum(hi - lo, 0.0)
    one = OnPlates(np.array([item]), np.array([shape]), np.zeros(1, np.int64), position[None])
    return separated(scene, best.with_rows(one), 1).exact
