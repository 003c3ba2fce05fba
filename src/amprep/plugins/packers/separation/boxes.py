"""Packing of the enclosing boxes, for when time is too short for the true shapes."""

from dataclasses import replace

import numpy as np

from amprep.model.bounding_volume import Boxes
from amprep.model.control import Stop, silent
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.extreme_points import pack_extreme_points
from amprep.plugins.packers.params import ExtremePointsParams


def better_as_boxes(
    problem: PackingProblem, packing: Packing, rng: np.random.Generator, stop: Stop
) -> Packing:
    """Return a packing of the enclosing boxes if it places more items, or more value for `fill`; else the other one.

    Its bound, and the reason to stop, are those of the packing of shapes.
    """
    boxes = pack_extreme_points(
        _box_problem(problem), params=ExtremePointsParams(), rng=rng, stop=stop, progress=silent
    )
    if _placed(problem, boxes) <= _placed(problem, packing):
        return packing
    unplaced = {each.item: each for each in packing.unplaced}
    return replace(
        packing,
        builds=boxes.builds,
        unplaced=tuple(unplaced.get(each.item, each) for each in boxes.unplaced),
        status="infeasible" if packing.status == "infeasible" else "feasible",
        found_by="extreme-points",
        excess={},
    )


def _placed(problem: PackingProblem, packing: Packing) -> float:
    """Return the number of items that are placed, or their value for `fill`."""
    items = [placement.item for build in packing.builds for placement in build]
    return sum(problem.items[item].value if problem.objective == "fill" else 1.0 for item in items)


def _box_problem(problem: PackingProblem) -> PackingProblem:
    """Return the problem with enclosing boxes in place of the volumes."""
    known = {id(item.volume): item.volume for item in problem.items}
    boxes = {
        key: volume if isinstance(volume, Boxes) else Boxes(*volume.enclosing())
        for key, volume in known.items()
    }
    return replace(
        problem, items=tuple(replace(item, volume=boxes[id(item.volume)]) for item in problem.items)
    )
