"""The builds problem: all items in few builds."""

import numpy as np

from amprep.model.control import Progress
from amprep.plugins.packers.separation.bounds import builds_bound
from amprep.plugins.packers.separation.construct import by_size, construct
from amprep.plugins.packers.separation.guided import AttemptPool, disturbed, separated
from amprep.plugins.packers.separation.state import Placed, Scene


def pack_builds(scene: Scene, progress: Progress) -> Placed:
    """Return a layout in few builds: constructed, then with one build less again and again.

    The items of the least filled build go into the others, overlapping, and all are separated.
    """
    instance, params = scene.instance, scene.params
    items = by_size(scene, np.flatnonzero(instance.free))
    within = instance.positions(float(instance.problem.space.size[2]) - instance.problem.clearance)
    best = construct(scene, items, within, len(items) + 1)
    work, bound = scene.budget.left, builds_bound(instance)
    while len(best.items) == len(items) and best.builds > max(bound, 1) and not scene.budget.over():
        found = _one_less(scene, best, params.failures)
        progress(1.0 - max(scene.budget.left, 0.0) / max(work, 1.0), f"{best.builds} builds")
        if found is None:
            break
        best = found
    return best


def _one_less(scene: Scene, best: Placed, failures: int) -> Placed | None:
    """Return a layout with one build less; None if none is found."""
    instance, builds, pool = scene.instance, best.builds, AttemptPool()
    within = instance.positions(float(instance.problem.space.size[2]) - instance.problem.clearance)
    emptied = _without_build(scene, best)
    start = emptied
    for _ in range(failures):
        attempt = separated(scene, start, within, builds - 1)
        if attempt.exact is not None or scene.budget.over():
            return attempt.exact
        pool.add(attempt)
        start = disturbed(scene, pool.choose(scene, emptied))
    return None


def _without_build(scene: Scene, placed: Placed) -> Placed:
    """Return a layout in which the items of the least filled build are in others, chosen at random."""
    builds, instance = placed.builds, scene.instance
    filled = np.bincount(placed.build, instance.volumes[placed.items], builds)
    if instance.problem.fixed:
        filled[0] = np.inf
    least = int(np.argmin(filled))
    changed = placed.copy()
    leaving = changed.build == least
    changed.build[changed.build > least] -= 1
    changed.build[leaving] = scene.rng.integers(0, builds - 1, int(leaving.sum()))
    return changed
