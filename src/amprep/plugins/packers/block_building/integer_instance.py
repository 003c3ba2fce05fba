"""Convert a prepared problem of single boxes to whole numbers for the kernels of block building."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.blocks.records import OrientedBoxes
from amprep.plugins.packers.bounds.combinatorial import fill_bound
from amprep.plugins.packers.instance.prepare import PreparedInstance

RESOLUTION = 1e-6
"""Smallest unit of length (mm)."""

MAX_UNITS = 1 << 30
"""Largest number of units along the container's longest side."""


@dataclass(frozen=True, eq=False)
class IntegerInstance:
    """Boxes, container and obstacles in whole units. The clearance is added to the upper sides of each box.

    Attributes
    ----------
    unit
        Length of a unit (mm): the greatest one that measures every box exactly, at least `RESOLUTION`.
    container
        ``(6,)`` corners; the lower one is the origin.
    obstacles
        ``(m, 6)`` corners of forbidden zones and fixed boxes.
    boxes
        The boxes to place. Their item types are finer than those of the prepared problem: items of one type
        also share their value. The value of a worthless box is tiny instead of 0.
    orientation
        ``(s,)`` orientation of each oriented box in the prepared problem.
    items
        Items of each item type.
    goal
        Upper bound of the value that can be placed.
    """

    unit: float
    container: Int64s
    obstacles: Int64s
    boxes: OrientedBoxes
    orientation: Int64s
    items: tuple[Int64s, ...]
    goal: float


def is_of_single_boxes(prepared: PreparedInstance) -> bool:
    """Return whether every item is one box and the build volume is a box, as block building requires."""
    return prepared.space.radius == 0.0 and all(len(each.lo) == 1 for each in prepared.orientations)


def integer_instance(prepared: PreparedInstance) -> IntegerInstance:
    """Return the problem in whole numbers; rounding only makes boxes larger and the container smaller."""
    gap, space, values = prepared.problem.clearance, prepared.space, _values(prepared)
    groups, items = _groups(prepared, values)
    rows = [
        (group, number)
        for group, item_type in enumerate(groups)
        for number in range(*prepared.first_orientation[item_type : item_type + 2].tolist())
        if prepared.orientations[number].fits
    ]
    sizes = np.array([prepared.orientations[number].size + gap for _, number in rows]).reshape(-1, 3)
    lo = np.concatenate((space.zone_lo + gap, prepared.fixed_lo)) - space.lo
    hi = np.concatenate((space.zone_hi, prepared.fixed_hi + gap)) - space.lo
    far = space.hi + gap - space.lo
    unit = _unit(sizes, lo, hi, float(far.max()))
    fixed = sum(values[placement.item] for placement in prepared.problem.fixed)
    least = 1e-9 * max(float(values.max(initial=0.0)), 1e-3)
    boxes = OrientedBoxes(
        size=np.maximum(_up(sizes, unit), 1),
        item_type=np.array([group for group, _ in rows], dtype=np.int64),
        value=np.array([max(values[items[group][0]], least) for group, _ in rows]),
        demand=np.array([len(members) for members in items], dtype=np.int64),
    )
    return IntegerInstance(
        unit=unit * RESOLUTION,
        container=np.concatenate((np.zeros(3, np.int64), _down(far + space.slack, unit))),
        obstacles=np.hstack((_down(lo + space.slack, unit), _up(hi - space.slack, unit))),
        boxes=boxes,
        orientation=np.array([number for _, number in rows], dtype=np.int64),
        items=tuple(items),
        goal=(fill_bound(prepared) - float(fixed)) * (1.0 - 1e-9),
    )


def _values(prepared: PreparedInstance) -> Floats:
    return np.array([item.value for item in prepared.problem.items], dtype=np.float64)


def _groups(prepared: PreparedInstance, values: Floats) -> tuple[list[int], list[Int64s]]:
    """Return for each pair of item type and value the item type and its free items."""
    free = np.flatnonzero(prepared.free)
    members: dict[tuple[int, float], list[int]] = {}
    for item in free.tolist():
        members.setdefault((int(prepared.type_of[item]), float(values[item])), []).append(item)
    return [item_type for item_type, _ in members], [
        np.array(found, dtype=np.int64) for found in members.values()
    ]


def _unit(sizes: Floats, lo: Floats, hi: Floats, longest: float) -> int:
    """Return the unit in multiples of `RESOLUTION`: the greatest common divisor of all lengths.

    The unit is greater than that if the container would be longer than `MAX_UNITS`.
    """
    lengths = np.concatenate((sizes.ravel(), lo.ravel(), hi.ravel()))
    multiples = np.rint(np.abs(lengths) / RESOLUTION).astype(np.int64)
    divisor = int(np.gcd.reduce(multiples)) if len(multiples) else 1
    return max(divisor, int(np.ceil(longest / RESOLUTION / MAX_UNITS)), 1)


def _up(lengths: Floats, unit: int) -> Int64s:
    return np.asarray(-_down(-lengths, unit))


def _down(lengths: Floats, unit: int) -> Int64s:
    """Return lengths in units, rounded down; a difference of 0.001 `RESOLUTION` counts as rounding error."""
    return np.asarray(np.floor(lengths / RESOLUTION + 1e-3).astype(np.int64) // unit)
