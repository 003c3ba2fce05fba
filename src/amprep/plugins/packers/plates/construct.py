"""Constructive passes: each item at the first free position on the first plate that has one."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.guided_search import READ
from amprep.kernels.plates.scan import first_free
from amprep.plugins.packers.plates.programs import is_exact, make_plate_exact
from amprep.plugins.packers.plates.state import OnPlates, PlateScene, none_on_plates, placed_from

OFF_PLATE = -2
"""Plate of an item that is on none."""

FREE = 1e-5
"""Weighted overlap (mm) of a free position."""


def construct(
    scene: PlateScene, items: Int64s, direction: Floats, most: int, start: OnPlates | None = None
) -> OnPlates:
    """Place items one after another, each at its first free position along a direction.

    The fields decide what is free, up to their precision; a linear program makes each plate exact, and where it does
    not, the last items of the plate are left out. Items that are placed are returned.

    Parameters
    ----------
    items
        In the order in which they are placed.
    direction
        ``(2,)`` unit vector.
    most
        Number of plates after which items without a free position are left out.
    start
        Items that are placed before.
    """
    begun = none_on_plates() if start is None else start
    n, instance = len(items), scene.instance
    rest = OnPlates(items, instance.first[items].copy(), np.full(n, OFF_PLATE, np.int64), np.zeros((n, 2)))
    placed = begun.with_rows(rest)
    layout, rules = scene.layout(placed), scene.rules(placed.items, most)
    state = scene.state(len(placed.items))
    for k in range(len(begun.items), len(placed.items)):
        used = max(int(layout.plate[: len(placed.items)].max(initial=-1)) + 1, 1)
        for plate in range(min(used + 1, most)):
            if scene.budget.over():
                break
            before = int(state.spent[READ])
            layout.plate[k] = plate
            shape = first_free(
                scene.outlines, scene.cache, instance.arrays, layout, state, rules, k, direction, FREE
            )
            scene.budget.left -= int(state.spent[READ]) - before + 40_000.0
            if shape >= 0:
                break
            layout.plate[k] = OFF_PLATE
    done = placed_from(layout, placed.items)
    return _exact(scene, done.rows(np.flatnonzero(done.plate >= 0)))


def _exact(scene: PlateScene, placed: OnPlates) -> OnPlates:
    """Return a layout without overlaps: items that keep a plate from being exact are left out, the last ones first."""
    for plate in range(placed.plates):
        while not is_exact(scene, placed, plate):
            found = make_plate_exact(scene, placed, plate)
            if found is not None:
                placed = found
                break
            last = int(np.flatnonzero(placed.plate == plate)[-1])
            placed = placed.rows(np.delete(np.arange(len(placed.items)), last))
    return placed


def by_area(scene: PlateScene, items: Int64s, spread: float = 0.0) -> Int64s:
    """Return items in the order of decreasing area, equal ones together; with a spread, areas vary at random."""
    instance = scene.instance
    first = instance.first[items]
    area = instance.half[first].prod(axis=1)
    types, row = np.unique(first, return_inverse=True)
    area = area * np.exp(spread * scene.rng.normal(size=len(types)))[row.reshape(-1)]
    return np.asarray(items[np.lexsort((items, first, -area))])
