"""The height problem: the lowest layout in one build."""

from functools import partial

import numpy as np

from amprep.measures.objective import greatest_height
from amprep.plugins.packers.separation.construct import best_constructed
from amprep.plugins.packers.separation.guided import AttemptPool, disturbed, separated
from amprep.plugins.packers.separation.programs import compacted, height_of
from amprep.plugins.packers.separation.state import Placed, Scene
from amprep.plugins.packers.separation.workers import SearchWorker, run_workers

MET = 1e-6
"""Height (mm) above the bound at which the search ends."""

SLOWER, LEAST = 0.7, 0.1
"""Factor of the reduction of the height after each failure, and the least one, of `SeparationParams.shrink`."""

FASTER, MOST = 1.5, 0.1
"""Factor of the reduction after each success in a row, and the greatest one."""

LEAST_GAIN = 1e-3
"""Fraction by which a layout must at least be lower: programs may use this height, the guided search a lower one."""

MISSING = 1e12
"""Value (mm) of an item that is not placed."""


def pack_lowest(scene: Scene, bound: float) -> Placed:
    """Return a layout of little height (mm), at the bound if possible; it may be higher than the build volume."""
    return run_workers(scene, bound + MET, partial(_search, bound))


def _search(bound: float, worker: SearchWorker) -> None:
    """Publish lower and lower layouts.

    The height is reduced by a fraction, overlaps are allowed and removed; after a failure the layout is disturbed and
    the reduction is smaller.
    """
    scene = worker.scene
    instance, params = scene.instance, scene.params
    best = _first_layout(worker)
    height = _value(scene, best)
    worker.publish(height, best)
    if height >= MISSING:
        return
    start, failures, pool, reduction = best, 0, AttemptPool(), params.shrink
    while not worker.over() and not scene.gives_up(failures):
        news = worker.better_than(height)
        if news is not None:
            best, height = news.placed, news.value
            start, failures, pool, reduction = best, 0, AttemptPool(), params.shrink
        scene.progress(scene.budget.used, f"height {height:.6g} mm")
        within = instance.positions(max(bound, height * (1.0 - reduction)))
        room = instance.positions(max(bound, height * (1.0 - LEAST_GAIN)))
        attempt = separated(scene, start, within, 1, partial(worker.knows_better, height), room)
        if attempt.exact is None:
            failures += 1
            reduction = params.shrink * max(LEAST, SLOWER**failures)
            pool.add(attempt)
            start = disturbed(scene, pool.choose(scene, best))
            continue
        best = compacted(scene, attempt.exact, room)
        height = height_of(scene, best)
        worker.publish(height, best)
        reduction = min(reduction * FASTER, MOST) if failures == 0 else params.shrink
        start, failures, pool = best, 0, AttemptPool()


def _first_layout(worker: SearchWorker) -> Placed:
    """Return a constructed layout, compacted."""
    scene = worker.scene
    items = np.flatnonzero(scene.instance.free)
    within = scene.instance.positions(_any_height(scene))
    best = best_constructed(scene, items, within, 1, partial(_value, scene), worker.number)
    return compacted(scene, best, within)


def _value(scene: Scene, placed: Placed) -> float:
    """Return the height of a layout, or more if items are missing."""
    missing = int(scene.instance.free.sum()) - len(placed.items)
    return height_of(scene, placed) + MISSING * missing


def _any_height(scene: Scene) -> float:
    """Return a height (mm) in which all items stand above one another."""
    instance, problem = scene.instance, scene.instance.problem
    highest = np.array(
        [instance.size[a:b, 2].max() for a, b in zip(instance.first, instance.end, strict=True)]
    )
    zones = float(problem.space.zone_hi[:, 2].max(initial=0.0))
    total = float((highest + problem.clearance + 4.0 * scene.no_fit.fields.step).sum())
    return problem.lift + greatest_height(problem, problem.fixed) + zones + total + problem.clearance
