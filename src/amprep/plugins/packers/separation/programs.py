"""Linear programs over the exact no-fit solids: separate a layout that overlaps a little, and compact one."""

from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.contacts import WORK, find_contacts
from amprep.kernels.no_fit.records import PositionRange
from amprep.plugins.packers.separation.state import Placed, Scene

# Strategy. Two convex pieces are apart if the offset of their shapes is beyond one plane of their no-fit polyhedron.
# For a given layout the plane of greatest separation is chosen for each pair of pieces near one another; with the
# planes fixed, "all pairs are apart" is a system of linear inequalities in the positions. One program minimises the
# sum of their violations, another the height; both move items by a limited length, so that pairs that are not near
# stay apart. Then planes are chosen anew (Li, Milenkovic 1995, doi:10.1016/0377-2217(95)00021-H, in three dimensions).

APART = 1e-7
"""Distance (mm) that the programs keep between pieces beyond what is asked."""

EXACT = 2e-6
"""Depth (mm) up to which pieces are apart for the programs: less than the tolerance of the judge by far."""

SNAP = 1e-6
"""Distance (mm) from the end of its range at which a position is moved to the end."""

STEP = 0.06
"""Length of a move of the programs, as a fraction of the mean size of the shapes."""

ATTEMPTS, COMPACTIONS = 6, 100
"""Largest number of programs that separate a layout, and that compact one."""

PROGRESS = 0.7
"""A further program is tried if the violations fell below this fraction of those before."""

ROW_WORK = 3000.0
"""Work of a row of a program, in field values read."""


class Contacts(NamedTuple):
    """Pairs ``(k, 2)`` of near items, planes ``(k, 4)`` between their pieces, and the least separation, mm."""

    pairs: Int64s
    planes: Floats
    apart: float


def contacts_of(scene: Scene, placed: Placed, reach: float) -> Contacts:
    """Return the contacts of a layout within a reach, mm."""
    layout, items, shapes = scene.layout(placed), len(placed.items), scene.no_fit.contacts
    rows = 40 * items + 1000
    while True:
        pairs, planes = np.empty((rows, 2), np.int64), np.empty((rows, 4))
        count, apart = find_contacts(shapes, layout, items, reach, pairs, planes, np.empty(WORK))
        if count <= rows:
            return Contacts(pairs[:count], planes[:count], apart)
        rows = count


def is_exact(scene: Scene, placed: Placed) -> bool:
    """Return whether no pieces overlap by more than `EXACT`."""
    return contacts_of(scene, placed, 0.01).apart >= -EXACT


def make_exact(scene: Scene, placed: Placed, within: PositionRange) -> Placed | None:
    """Return a layout near another without overlaps; None if the programs find none."""
    last = np.inf
    for _ in range(ATTEMPTS):
        if is_exact(scene, placed) and _outside(scene, placed, within) <= EXACT:
            return placed
        found = _solve(scene, placed, within, compact=False)
        if found is None or (found[1] > PROGRESS * last and found[1] > EXACT / 10.0):
            return None
        placed, last = found
        if scene.budget.over():
            return None
    return None


def compacted(scene: Scene, placed: Placed, within: PositionRange) -> Placed:
    """Return a layout of less height, without overlaps if the given one has none."""
    height = height_of(scene, placed)
    for _ in range(COMPACTIONS):
        found = None if scene.budget.over() else _solve(scene, placed, within, compact=True)
        if found is None or not is_exact(scene, found[0]) or _outside(scene, found[0], within) > EXACT:
            return placed
        lower = height_of(scene, found[0])
        if lower > height - 1e-9:
            return placed
        gain, placed, height = height - lower, found[0], lower
        if gain < 1e-4 * height:
            break
    return placed


def height_of(scene: Scene, placed: Placed) -> float:
    """Return the height of the highest item, mm."""
    tops = placed.position[:, 2] + scene.instance.size[placed.shape, 2]
    return float(tops.max(initial=0.0))


def _outside(scene: Scene, placed: Placed, within: PositionRange) -> float:
    """Return the greatest length by which an item is outside its range or beyond a side of a round build volume, mm."""
    below = within.lo[placed.shape] - placed.position
    above = placed.position - within.hi[placed.shape]
    beyond = _beyond_sides(scene, placed)
    return float(max(below.max(initial=0.0), above.max(initial=0.0), beyond.max(initial=0.0)))


def _beyond_sides(scene: Scene, placed: Placed) -> Floats:
    """Return the length by which each item is beyond each side of the polygon around the circle, ``(n, k)`` mm."""
    sides = scene.instance.sides
    if not len(sides):
        return np.zeros((len(placed.items), 0))
    reach = scene.instance.side_reach[placed.shape]
    return np.asarray(placed.position[:, :2] @ sides[:, :2].T + reach - sides[:, 2])


def _rows(scene: Scene, placed: Placed, move: float) -> tuple[Int64s, Int64s, Floats, Floats]:
    """Return row and column numbers, values and right sides of the inequalities ``rows @ positions <= right``."""
    contacts = contacts_of(scene, placed, 2.0 * np.sqrt(3.0) * move)
    n, m = len(placed.items), len(contacts.planes)
    row, axis = np.repeat(np.arange(m), 3), np.tile(np.arange(3), m)
    normal = contacts.planes[:, :3].ravel()
    moving = contacts.pairs[:, 1] < n
    right = -contacts.planes[:, 3] - APART
    layout = scene.layout(placed).position
    right[~moving] -= (contacts.planes[~moving, :3] * layout[contacts.pairs[~moving, 1]]).sum(axis=1)
    second = np.repeat(moving, 3)
    rows = [row, row[second]]
    columns = [3 * contacts.pairs[row, 0] + axis, (3 * contacts.pairs[row, 1] + axis)[second]]
    values = [-normal, normal[second]]
    item, side = np.nonzero(_beyond_sides(scene, placed) > -2.0 * move)
    sides = scene.instance.sides
    number = m + np.arange(len(item))
    for k in range(2):
        rows.append(number)
        columns.append(3 * item + k)
        values.append(sides[side, k])
    if len(item):
        right = np.concatenate((right, sides[side, 2] - scene.instance.side_reach[placed.shape[item], side]))
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(values), right


def _solve(
    scene: Scene, placed: Placed, within: PositionRange, *, compact: bool
) -> tuple[Placed, float] | None:
    """Return the layout of a program and its value; None if the program has no solution.

    With `compact`, a further variable is the height; else there is one for the violation of each inequality.
    """
    from scipy.optimize import linprog
    from scipy.sparse import coo_array

    n, move = len(placed.items), STEP * scene.instance.mean_size
    row, column, value, right = _rows(scene, placed, move)
    m = len(right)
    size = scene.instance.size[placed.shape]
    lower = np.maximum(placed.position - move, within.lo[placed.shape])
    upper = np.minimum(placed.position + move, within.hi[placed.shape])
    lower = np.minimum(lower, upper)
    cost, low, high = [np.zeros(3 * n)], [lower.ravel()], [upper.ravel()]
    if compact:
        each = np.arange(n)
        row = np.concatenate((row, m + each, m + each))
        column = np.concatenate((column, 3 * each + 2, np.full(n, 3 * n)))
        value = np.concatenate((value, np.ones(n), -np.ones(n)))
        right = np.concatenate((right, -size[:, 2]))
        cost[0][2::3] = 1e-3 / n
        further = 1
    else:
        row, column = np.concatenate((row, np.arange(m))), np.concatenate((column, 3 * n + np.arange(m)))
        value = np.concatenate((value, -np.ones(m)))
        further = m
    cost.append(np.ones(further))
    low.append(np.zeros(further))
    high.append(np.full(further, np.inf))
    scene.budget.left -= ROW_WORK * (len(right) + n)
    matrix: Any = coo_array((value, (row, column)), shape=(len(right), 3 * n + further)).tocsr()
    limits: Any = np.column_stack((np.concatenate(low), np.concatenate(high)))
    found = linprog(
        np.concatenate(cost),
        A_ub=matrix,
        b_ub=right,
        bounds=limits,
        method="highs-ds",
        options={"time_limit": min(max(scene.budget.stop.remaining(), 0.01), 1e6)},
    )
    if found.status != 0 or found.x is None:
        return None
    position = found.x[: 3 * n].reshape(n, 3)
    position = np.where(position < within.lo[placed.shape] + SNAP, lower, position)
    position = np.where(position > within.hi[placed.shape] - SNAP, upper, position)
    return placed._replace(position=position), float(found.fun or 0.0)
