"""The builds problem: all items in few builds."""

from functools import partial

import numpy as np

from amprep.kernels.no_fit.records import PositionRange
from amprep.plugins.packers.separation.construct import best_constructed, by_size, construct, random_order
from amprep.plugins.packers.separation.guided import AttemptPool, disturbed, put_at_random, separated
from amprep.plugins.packers.separation.state import Placed, Scene, joined
from amprep.plugins.packers.separation.workers import SearchWorker, run_workers

AFRESH = 0.4
"""Probability that a search begins anew after a failure."""

MISSING = 1e9
"""Value, in builds, of an item that is not placed."""


def pack_builds(scene: Scene, bound: float) -> Placed:
    """Return a layout in few builds, at the bound if possible."""
    return run_workers(scene, bound, _search)


def _search(worker: SearchWorker) -> None:
    """Publish layouts in fewer and fewer builds: constructed, then with one build less again and again.

    The layout with one build less is constructed, evenly filled, and items without room are put in, overlapping; or the
    items of a build with little in it go into the others. Then all are separated.
    """
    scene = worker.scene
    within = scene.full_height
    best = _first_layout(worker, within)
    worker.publish(_value(scene, best), best)
    if _value(scene, best) >= MISSING:
        return
    failures, pool = 0, AttemptPool()
    while not worker.over() and not scene.gives_up(failures):
        news = worker.better_than(best.builds)
        if news is not None:
            best, failures, pool = news.placed, 0, AttemptPool()
        scene.progress(scene.budget.used, f"{best.builds} builds")
        start = _start(worker, best, failures, pool)
        attempt = separated(scene, start, within, best.builds - 1, partial(worker.knows_better, best.builds))
        if attempt.exact is None:
            failures += 1
            pool.add(attempt)
            continue
        best, failures, pool = attempt.exact, 0, AttemptPool()
        worker.publish(_value(scene, best), best)


def _start(worker: SearchWorker, best: Placed, failures: int, pool: AttemptPool) -> Placed:
    """Return a layout with one build less, with overlaps; after failures mostly a failed one, disturbed."""
    scene = worker.scene
    if failures == 0 or scene.rng.random() < AFRESH:
        if (failures + worker.number) % 2 == 0:
            return _evenly_filled(scene, best.builds - 1, failures)
        return _without_build(scene, best, failures)
    return disturbed(scene, pool.choose(scene, best=None))


def _evenly_filled(scene: Scene, builds: int, failures: int) -> Placed:
    """Return a constructed layout in some builds, into which items without room are put at random."""
    within, items = scene.full_height, np.flatnonzero(scene.instance.free)
    order = random_order(scene, items) if failures else by_size(scene, items)
    placed = construct(scene, order, within, builds, even=True)
    left = np.setdiff1d(items, placed.items)
    return joined(placed, put_at_random(scene, left, builds, within)) if len(left) else placed


def _first_layout(worker: SearchWorker, within: PositionRange) -> Placed:
    """Return a constructed layout."""
    scene = worker.scene
    items = np.flatnonzero(scene.instance.free)
    return best_constructed(scene, items, within, len(items) + 1, partial(_value, scene), worker.number)


def _value(scene: Scene, placed: Placed) -> float:
    """Return the number of builds, or more if items are missing."""
    return placed.builds + MISSING * (int(scene.instance.free.sum()) - len(placed.items))


def _without_build(scene: Scene, placed: Placed, failures: int) -> Placed:
    """Return a layout in which the items of a build are in others, chosen at random by the volume that is free.

    The build is the least filled one; after failures at times another one.
    """
    builds, instance, rng = placed.builds, scene.instance, scene.rng
    filled = np.bincount(placed.build, instance.volumes[placed.items], builds)
    order = [build for build in np.argsort(filled).tolist() if build > 0 or not instance.problem.fixed]
    rank = min(int(rng.exponential(0.7)), len(order) - 1) if failures else 0
    gone = order[rank]
    changed, leaving = placed.copy(), placed.build == gone
    changed.build[changed.build > gone] -= 1
    room = np.delete(filled.max() - filled, gone)
    chance = room + 1e-3 * filled.max() + 1e-12
    changed.build[leaving] = rng.choice(builds - 1, int(leaving.sum()), p=chance / chance.sum())
    return changed
