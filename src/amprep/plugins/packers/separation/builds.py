"""The builds problem: all items in few builds."""

from functools import partial

import numpy as np

from amprep.kernels.no_fit.records import PositionRange
from amprep.plugins.packers.separation.bounds import builds_bound
from amprep.plugins.packers.separation.construct import best_constructed
from amprep.plugins.packers.separation.guided import AttemptPool, disturbed, separated
from amprep.plugins.packers.separation.state import Placed, Scene
from amprep.plugins.packers.separation.workers import SearchWorker, run_workers

MISSING = 1e9
"""Value, in builds, of an item that is not placed."""


def pack_builds(scene: Scene) -> Placed:
    """Return a layout in few builds."""
    return run_workers(scene, float(max(builds_bound(scene.instance), 1)), _search)


def _search(worker: SearchWorker) -> None:
    """Publish layouts in fewer and fewer builds: constructed, then with one build less again and again.

    The items of a build with little in it go into the others, overlapping, and all are separated. After a failure the
    layout is disturbed, or another build is dissolved.
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
        scene.progress(scene.budget.fraction, f"{best.builds} builds")
        dissolved = _without_build(scene, best, failures)
        start = dissolved if failures == 0 else disturbed(scene, pool.choose(scene, dissolved))
        attempt = separated(scene, start, within, best.builds - 1, partial(worker.knows_better, best.builds))
        if attempt.exact is None:
            failures += 1
            pool.add(attempt)
            continue
        best, failures, pool = attempt.exact, 0, AttemptPool()
        worker.publish(_value(scene, best), best)


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
