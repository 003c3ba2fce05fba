"""The height problem: the lowest layout in one build."""

import numpy as np

from amprep.model.control import Progress
from amprep.plugins.packers.separation.bounds import fixed_top, height_bound
from amprep.plugins.packers.separation.construct import by_size, construct
from amprep.plugins.packers.separation.guided import AttemptPool, disturbed, separated
from amprep.plugins.packers.separation.programs import compacted, height_of
from amprep.plugins.packers.separation.state import Placed, Scene

MET = 1e-6
"""Height (mm) above the bound at which the search ends."""

SLOWER, LEAST = 0.7, 0.1
"""Factor of the reduction of the height after each failure, and the least one, of `SeparationParams.shrink`."""

FASTER, MOST = 1.5, 0.1
"""Factor of the reduction after each success in a row, and the greatest one."""


def pack_lowest(scene: Scene, progress: Progress) -> Placed:
    """Return a layout of little height; it may be higher than the build volume.

    The height is reduced by a fraction, overlaps are allowed and removed; after a failure the layout is disturbed and
    the reduction is smaller.
    """
    instance, params = scene.instance, scene.params
    items = by_size(scene, np.flatnonzero(instance.free))
    bound, base = height_bound(instance), fixed_top(instance)
    best = construct(scene, items, instance.positions(_any_height(scene)), 1)
    best = compacted(scene, best, instance.positions(_any_height(scene)))
    if len(best.items) < len(items):
        return best
    height, work = height_of(scene, best), scene.budget.left
    start, failures, pool, reduction = best, 0, AttemptPool(), params.shrink
    while height > max(bound, base) + MET and failures < params.failures and not scene.budget.over():
        within = instance.positions(max(bound, height * (1.0 - reduction)))
        attempt = separated(scene, start, within, 1)
        progress(1.0 - max(scene.budget.left, 0.0) / max(work, 1.0), f"height {height:.4g} mm")
        if attempt.exact is None:
            failures += 1
            reduction = params.shrink * max(LEAST, SLOWER**failures)
            pool.add(attempt)
            start = disturbed(scene, pool.choose(scene, best))
            continue
        best = compacted(scene, attempt.exact, within)
        height = height_of(scene, best)
        reduction = min(reduction * FASTER, MOST) if failures == 0 else params.shrink
        start, failures, pool = best, 0, AttemptPool()
    return best


def _any_height(scene: Scene) -> float:
    """Return a height (mm) in which all items stand above one another."""
    instance, problem = scene.instance, scene.instance.problem
    highest = np.array(
        [instance.size[a:b, 2].max() for a, b in zip(instance.first, instance.end, strict=True)]
    )
    zones = float(problem.space.zone_hi[:, 2].max(initial=0.0))
    total = float((highest + problem.clearance + 4.0 * scene.no_fit.fields.step).sum())
    return problem.lift + fixed_top(instance) + zones + total + problem.clearance
