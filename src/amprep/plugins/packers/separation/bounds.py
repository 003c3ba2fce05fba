"""Bounds on the objective for true shapes: volumes of the shapes, and the least height of each item."""

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.measures.objective import greatest_height
from amprep.plugins.packers.separation.shapes import ShapeInstance

# Shapes may penetrate one another, and walls, by CONTACT_TOLERANCE: their volumes count less by a layer of it around
# the enclosing box, and the build volume counts larger by it.


def least_height(instance: ShapeInstance, item: int) -> float:
    """Return the least height (mm) of the shapes of an item."""
    shapes = slice(int(instance.first[item]), int(instance.end[item]))
    return float(instance.size[shapes, 2].min())


def _counted_volumes(instance: ShapeInstance) -> Floats:
    """Return the volume (mm3) that each item takes at least."""
    x, y, z = instance.size[instance.first].T
    layer = 2.0 * CONTACT_TOLERANCE * (x * y + y * z + z * x)
    return np.asarray(np.maximum(instance.volumes - layer, 0.0))


def _base_area(instance: ShapeInstance) -> float:
    side = instance.problem.space.size[:2] + 2.0 * CONTACT_TOLERANCE
    return float(side.prod() * (np.pi / 4.0 if instance.circle else 1.0))


def build_room(instance: ShapeInstance) -> float:
    """Return the volume (mm3) of one build."""
    return _base_area(instance) * (float(instance.problem.space.size[2]) + CONTACT_TOLERANCE)


def counted(instance: ShapeInstance) -> Bools:
    """Return which items are in every complete packing: all but those that are too large."""
    return np.asarray(~instance.too_large)


def builds_bound(instance: ShapeInstance) -> int:
    """Return the least number of builds by volume."""
    if not counted(instance).any():
        return 0
    taken = _counted_volumes(instance)[counted(instance)].sum()
    return max(1, int(np.ceil(taken / build_room(instance) - 1e-9)))


def height_bound(instance: ShapeInstance) -> float:
    """Return the least height (mm) of one build: of the highest item as it lies lowest, and by volume."""
    problem, inside = instance.problem, counted(instance) & instance.free
    by_volume = _counted_volumes(instance)[counted(instance)].sum() / _base_area(instance)
    tallest = max((least_height(instance, item) for item in np.flatnonzero(inside).tolist()), default=0.0)
    lifted = problem.lift + tallest if inside.any() else 0.0
    return max(lifted, float(by_volume) - CONTACT_TOLERANCE, fixed_top(instance))


def fixed_top(instance: ShapeInstance) -> float:
    """Return the height (mm) of the highest fixed item."""
    return greatest_height(instance.problem, instance.problem.fixed)


def fill_bound(instance: ShapeInstance) -> float:
    """Return the greatest value of one build: all of it, or what a fractional knapsack over volume holds."""
    values = np.array([item.value for item in instance.problem.items])
    inside, taken = instance.free, _counted_volumes(instance)
    fixed = float(values[~instance.free & ~instance.too_large].sum())
    room = build_room(instance)
    order = np.flatnonzero(inside)
    order = order[np.argsort(-values[order] / np.maximum(taken[order], 1e-12), kind="stable")]
    full = np.cumsum(taken[order])
    fraction = np.clip((room - (full - taken[order])) / np.maximum(taken[order], 1e-12), 0.0, 1.0)
    return fixed + float((fraction * values[order]).sum())
