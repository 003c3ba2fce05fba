"""Builds as columns of a set covering: the item types of each build, and their orientations and positions."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.records import Arrangement
from amprep.plugins.packers.instance.prepare import PreparedInstance


@dataclass(frozen=True, eq=False)
class Column:
    """A build of m items, in which any item of the same type may take each position.

    Attributes
    ----------
    type_of, orientation
        ``(m,)`` int64, as in the instance.
    position
        ``(m, 3)`` mm, least corners.
    """

    type_of: Int64s
    orientation: Int64s
    position: Floats

    def counts(self, types: int) -> Int64s:
        """Return the number of items of each type, ``(types,)``."""
        return np.bincount(self.type_of, minlength=types)


def columns_of(
    instance: PreparedInstance, found: Arrangement, part: PreparedInstance, items: Int64s
) -> list[Column]:
    """Return the builds of an arrangement of some items as columns.

    Parameters
    ----------
    found
        Arrangement of `part`, which holds nothing fixed.
    part
        The instance of the items alone, or `instance` itself.
    items
        ``(m,)`` the item of `instance` for each item of `part`.
    """
    of_type = found.orientation - part.first_orientation[part.type_of]
    orientation = of_type + instance.first_orientation[instance.type_of[items]]
    builds = [np.flatnonzero(found.build == build) for build in range(found.builds)]
    return [Column(instance.type_of[items[own]], orientation[own], found.position[own]) for own in builds]


def single_columns(instance: PreparedInstance) -> list[Column]:
    """Return a build with one item for each type to be placed; together they are a cover."""
    columns = []
    for item_type in np.flatnonzero(instance.demand).tolist():
        first = int(instance.first_orientation[item_type])
        chosen = first + next(i for i, each in enumerate(instance.types[item_type]) if each.fits)
        position = instance.orientations[chosen].feasible_position[None]
        columns.append(Column(np.array([item_type]), np.array([chosen]), position))
    return columns


def remaining_items(instance: PreparedInstance, taken: Int64s) -> Int64s:
    """Return the items to be placed after `taken` ``(types,)`` items of each type, ascending."""
    left = np.maximum(instance.demand - taken, 0).tolist()
    kept = [np.flatnonzero(instance.free & (instance.type_of == k))[:n] for k, n in enumerate(left)]
    return np.sort(np.concatenate(kept)) if kept else np.empty(0, np.int64)


def arrangement_from(instance: PreparedInstance, columns: Iterable[Column]) -> Arrangement:
    """Return a cover as an arrangement: each item takes the first position of its type that is left."""
    found = Arrangement.unassigned(len(instance.type_of))
    waiting = [
        np.flatnonzero(instance.free & (instance.type_of == k)).tolist() for k in range(len(instance.types))
    ]
    build = 0
    for column in columns:
        used = False
        for n, item_type in enumerate(column.type_of.tolist()):
            if waiting[item_type]:
                item, used = waiting[item_type].pop(0), True
                found.build[item], found.orientation[item] = build, column.orientation[n]
                found.position[item] = column.position[n]
        build += used
    return found


def count_of(columns: Sequence[Column], types: int) -> Int64s:
    """Return the number of items of each type in all columns together, ``(types,)``."""
    total = np.zeros(types, np.int64)
    for column in columns:
        total += column.counts(types)
    return total
