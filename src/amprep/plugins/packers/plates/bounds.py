"""Bounds on the objective for shadows: their areas, and the least height of each item."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.plates.areas import plate_area
from amprep.measures.objective import greatest_height
from amprep.plugins.packers.plates.shapes import PlateInstance


def _areas(instance: PlateInstance) -> Floats:
    return np.array([need.area for need in instance.needs])


def _room(instance: PlateInstance) -> float:
    """Return the area of a plate that shadows with their clearance may take."""
    problem = instance.problem
    return plate_area(problem.space.size[:2], problem.clearance, round_plate=bool(instance.radius))


def builds_bound(instance: PlateInstance) -> int:
    """Return the least number of builds by area."""
    counted = instance.free | instance.alone
    if not (counted.any() or instance.problem.fixed):
        return 0
    return max(1, int(np.ceil(_areas(instance)[counted].sum() / max(_room(instance), 1e-9) - 1e-9)))


def height_bound(instance: PlateInstance) -> float:
    """Return the least height (mm) of one build with all items that can be built."""
    counted = np.flatnonzero(instance.free | instance.alone).tolist()
    tallest = max((instance.needs[item].height for item in counted), default=-np.inf)
    return max(instance.problem.lift + tallest if counted else 0.0, fixed_top(instance))


def fixed_top(instance: PlateInstance) -> float:
    """Return the height (mm) of the highest fixed item."""
    return greatest_height(instance.problem, instance.problem.fixed)


def fill_bound(instance: PlateInstance) -> float:
    """Return the greatest value of one build: of all items, or what a fractional knapsack over area holds."""
    values = np.array([item.value for item in instance.problem.items])
    fixed = float(sum(values[placement.item] for placement in instance.problem.fixed))
    counted, area = np.flatnonzero(instance.free | instance.alone), _areas(instance)
    order = counted[np.argsort(-values[counted] / np.maximum(area[counted], 1e-12), kind="stable")]
    taken = np.maximum(area[order], 1e-12)
    full = np.cumsum(taken)
    fraction = np.clip((_room(instance) - (full - taken)) / taken, 0.0, 1.0)
    return fixed + float((fraction * values[order]).sum())
