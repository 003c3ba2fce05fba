"""The fill problem: items of great value in one build."""

from functools import partial

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import PositionRange
from amprep.plugins.packers.separation.construct import best_constructed
from amprep.plugins.packers.separation.guided import put_at_random, separated
from amprep.plugins.packers.separation.state import Placed, Scene, joined, only
from amprep.plugins.packers.separation.workers import SearchWorker, run_workers

REMOVED = (0.4, 0.4, 0.2)
"""Probabilities that an exchange takes no item, one, and two out of the layout."""

SPREAD = 0.5
"""Standard deviation of the logarithm by which the order of items to put in differs from that of their density."""

MOST_ADDED, TRIES = 4, 20
"""Largest number of items that an exchange puts in, and tries to find an exchange that would gain."""


def pack_most(scene: Scene, bound: float) -> Placed:
    """Return a layout of great value in one build; the bound applies to it together with the fixed items."""
    fixed = sum(scene.item_values[placement.item] for placement in scene.instance.problem.fixed)
    goal = float(fixed) - bound + 1e-9 * max(1.0, abs(bound))
    return run_workers(scene, goal, _search)


def _search(worker: SearchWorker) -> None:
    """Publish layouts of greater and greater value: constructed, then improved by exchanges.

    An exchange takes no, one or two items out, puts items of greater value into the build, overlapping, and separates
    all; if this fails, another exchange is tried.
    """
    scene = worker.scene
    values, within = scene.item_values, scene.full_height
    best = _first_layout(worker, within)
    worker.publish(_value(values, best), best)
    failures = 0
    while not worker.over() and not scene.gives_up(failures):
        news = worker.better_than(_value(values, best))
        best = best if news is None else news.placed
        reached = _value(values, best)
        scene.progress(scene.budget.used, f"{len(best.items)} parts")
        start = exchanged(scene, best, within)
        if start is None:
            break
        attempt = separated(scene, start, within, 1, partial(worker.knows_better, reached))
        failures += 1
        if attempt.exact is not None:
            best, failures = attempt.exact, 0
            worker.publish(_value(values, best), best)


def _first_layout(worker: SearchWorker, within: PositionRange) -> Placed:
    """Return a constructed layout: by value per volume of the enclosing box, or in another order."""
    scene = worker.scene
    free = np.flatnonzero(scene.instance.free & (scene.item_values > 0.0))
    value = partial(_value, scene.item_values)
    return best_constructed(scene, free, within, 1, value, worker.number, _density(scene)[free])


def _density(scene: Scene) -> Floats:
    """Return the value of each item per volume of its enclosing box."""
    boxes = scene.instance.size[scene.instance.first].prod(axis=1)
    return np.asarray(scene.item_values / np.maximum(boxes, 1e-12))


def _value(values: Floats, placed: Placed) -> float:
    """Return the value of a layout, negative: less is better."""
    return -float(values[placed.items].sum())


def exchanged(scene: Scene, best: Placed, within: PositionRange) -> Placed | None:
    """Return a layout of greater value, with overlaps; None if there is none."""
    values, volumes = scene.item_values, scene.instance.volumes
    left = np.setdiff1d(np.flatnonzero(scene.instance.free & (values > 0.0)), best.items)
    if not len(left):
        return None
    room = scene.free_volume(best)
    for _ in range(TRIES):
        count = min(int(scene.rng.choice(3, p=REMOVED)), len(best.items))
        rows = scene.rng.choice(len(best.items), count, replace=False) if count else np.zeros(0, np.int64)
        gone = best.items[rows]
        added = _added(scene, left, float(values[gone].sum()), room + float(volumes[gone].sum()))
        if len(added):
            kept = only(best, np.setdiff1d(np.arange(len(best.items)), rows))
            return joined(kept, _put(scene, added, best.position[rows], within))
    return None


def _added(scene: Scene, left: Int64s, lost: float, room: float) -> Int64s:
    """Return some of the items left out that fit by volume and gain value, dense ones more often; or none."""
    values, volumes = scene.item_values[left], scene.instance.volumes[left]
    order = np.argsort(-_density(scene)[left] * np.exp(scene.rng.normal(0.0, SPREAD, len(left))))
    chosen: list[int] = []
    gained = taken = 0.0
    for k in order.tolist():
        if gained > lost * (1.0 + 1e-9) or len(chosen) == MOST_ADDED:
            break
        if taken + volumes[k] <= room:
            chosen.append(k)
            gained, taken = gained + float(values[k]), taken + float(volumes[k])
    return left[chosen] if gained > lost * (1.0 + 1e-9) else left[:0]


def _put(scene: Scene, items: Int64s, places: Floats, within: PositionRange) -> Placed:
    """Return items at given places, as far as these suffice, and at random ones, each in one of its shapes."""
    put = put_at_random(scene, items, 1, within)
    put.position[: len(places)] = places[: len(items)]
    return put
