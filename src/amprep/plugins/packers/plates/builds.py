"""The builds problem: all items on few plates."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.control import Progress
from amprep.plugins.packers.plates.bounds import builds_bound
from amprep.plugins.packers.plates.construct import by_area, construct
from amprep.plugins.packers.plates.guided import PlateAttempts, disturbed, separated
from amprep.plugins.packers.plates.state import OnPlates, PlateScene

DIRECTIONS = ((0.0, 1.0), (1.0, 0.0), (0.7, 0.7), (0.1, 1.0), (1.0, 0.1))
"""Directions of the constructive passes."""

SPREAD = 0.15
"""Spread of the areas by which later passes order items."""


def pack_fewest(scene: PlateScene, start: OnPlates, progress: Progress) -> OnPlates:
    """Return a layout on few plates, from one that is given: constructed, then with one plate less again and again.

    The items of the least filled plate go to the others, overlapping, and all are separated.
    """
    items = np.flatnonzero(scene.instance.free)
    best = _constructed(scene, items, start)
    work, bound = scene.budget.left, builds_bound(scene.instance)
    while len(best.items) == len(items) and best.plates > max(bound, 1) and not scene.budget.over():
        progress(1.0 - max(scene.budget.left, 0.0) / max(work, 1.0), f"{best.plates} builds")
        found = _one_less(scene, best)
        if found is None:
            break
        best = found
    return best


def _constructed(scene: PlateScene, items: Int64s, start: OnPlates) -> OnPlates:
    """Return the best of some constructive passes, if it is better than a layout."""
    best = start
    for number in range(scene.params.passes):
        direction = np.array(DIRECTIONS[number % len(DIRECTIONS)])
        order = by_area(scene, items, SPREAD if number >= 2 else 0.0)
        found = construct(scene, order, direction, len(items) + 1)
        if scene.budget.over():
            break
        complete = len(found.items) == len(items)
        if complete and (len(best.items) < len(items) or _key(scene, found) < _key(scene, best)):
            best = found
    return best


def _key(scene: PlateScene, placed: OnPlates) -> tuple[int, float]:
    """Return the number of plates and the area of the items on the least filled one."""
    return placed.plates, float(_filled(scene, placed).min(initial=np.inf))


def _filled(scene: PlateScene, placed: OnPlates) -> Floats:
    area = np.array([need.area for need in scene.instance.needs])
    return np.asarray(np.bincount(placed.plate, area[placed.items], placed.plates), np.float64)


def _one_less(scene: PlateScene, best: OnPlates) -> OnPlates | None:
    """Return a layout with one plate less; None if none is found."""
    plates, pool = best.plates - 1, PlateAttempts()
    emptied = _without_plate(scene, best)
    start = emptied
    for _ in range(scene.params.failures):
        attempt = separated(scene, start, plates)
        if attempt.exact is not None or scene.budget.over():
            return attempt.exact
        pool.add(attempt)
        start = disturbed(scene, pool.choose(scene.rng, emptied))
    return None


def _without_plate(scene: PlateScene, placed: OnPlates) -> OnPlates:
    """Return a layout in which the items of the least filled plate are on others, chosen at random."""
    filled, plates = _filled(scene, placed), placed.plates
    if scene.instance.problem.fixed:
        filled[0] = np.inf
    least = int(np.argmin(filled))
    changed = placed.copy()
    leaving = changed.plate == least
    changed.plate[changed.plate > least] -= 1
    changed.plate[leaving] = scene.rng.integers(0, plates - 1, int(leaving.sum()))
    return changed
