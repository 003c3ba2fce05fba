"""The fill problem: items of great value in one build."""

import numpy as np

from amprep.model.control import Progress
from amprep.plugins.packers.separation.construct import construct
from amprep.plugins.packers.separation.guided import separated
from amprep.plugins.packers.separation.state import Placed, Scene, joined


def pack_most(scene: Scene, progress: Progress) -> Placed:
    """Return a layout of great value: constructed by value per volume, then one more item again and again.

    Each item that is left out is put into the build, overlapping, and all are separated.
    """
    instance = scene.instance
    values = np.array([item.value for item in instance.problem.items])
    free = np.flatnonzero(instance.free)
    density = values[free] / np.maximum(instance.volumes[free], 1e-12)
    items = free[np.lexsort((free, instance.first[free], -density))]
    within = instance.positions(float(instance.problem.space.size[2]) - instance.problem.clearance)
    best, work = construct(scene, items, within, 1), scene.budget.left
    left = [item for item in items.tolist() if item not in set(best.items.tolist()) and values[item] > 0.0]
    for item in left[: scene.params.failures]:
        if scene.budget.over():
            break
        shape = int(instance.first[item])
        lo, hi = within.lo[shape], within.hi[shape]
        position = lo + scene.rng.random(3) * np.maximum(hi - lo, 0.0)
        one = Placed(np.array([item]), np.array([shape]), np.zeros(1, np.int64), position[None])
        attempt = separated(scene, joined(best, one), within, 1)
        best = best if attempt.exact is None else attempt.exact
        progress(1.0 - max(scene.budget.left, 0.0) / max(work, 1.0), f"{len(best.items)} items")
    return best
