"""Items of several boxes as single boxes, for methods that pack only those."""

from dataclasses import replace

import numpy as np

from amprep.kernels.boxes.records import Arrangement
from amprep.model.bounding_volume import Boxes
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare

DECIMALS = 6
"""Decimals of sizes in mm, as many as the resolution of block building has."""


def enclosing_instance(instance: PreparedInstance) -> PreparedInstance | None:
    """Return the instance with each item in its enclosing box; None if the build is round or has fixed items.

    A packing of the enclosing boxes is a packing of the items. Sizes are rounded to the resolution of block building:
    volume makers enlarge boxes by less than counts as contact, and such sizes have no common unit.
    """
    problem = instance.problem
    if problem.fixed or instance.space.radius:
        return None
    boxes = (item.volume.enclosing() for item in problem.items)
    items = (
        replace(item, volume=Boxes(lo[None], (lo + np.round(hi - lo, DECIMALS))[None]))
        for item, (lo, hi) in zip(problem.items, boxes, strict=True)
    )
    return prepare(replace(problem, items=tuple(items)))


def with_own_boxes(
    instance: PreparedInstance, enclosed: PreparedInstance, packed: Arrangement
) -> Arrangement:
    """Return the arrangement of the items that an arrangement of their enclosing boxes means.

    Positions are the same; orientations of the items are counted in the instance. Each orientation of an enclosing
    box is one of the item's: the first of those that give this box.
    """
    found = packed.copy()
    first = instance.first_orientation
    for item in np.flatnonzero(packed.build >= 0).tolist():
        rotation = enclosed.orientations[packed.orientation[item]].rotation
        item_type = instance.type_of[item]
        found.orientation[item] = next(
            number
            for number in range(first[item_type], first[item_type + 1])
            if np.array_equal(instance.orientations[number].rotation, rotation)
        )
    return found
