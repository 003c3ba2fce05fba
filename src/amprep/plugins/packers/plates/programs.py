"""Linear programs over separating lines, which remove small overlaps exactly."""

from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.plates.contacts import find_line_contacts
from amprep.plugins.packers.plates.state import OnPlates, PlateScene

# Strategy. As in `packers.separation.programs`, in the plane: for each pair of near convex pieces the line of greatest
# separation is fixed; the program moves the items of a plate by a limited length and minimises the sum over pairs of
# items of their greatest violation. Then lines are chosen anew. The line through the nearest points of two pieces is
# among those tried, so that the clearance is exact at corners too.

APART = 1e-6
"""Distance (mm) that the programs keep beyond what is asked."""

EXACT = 2e-5
"""Overlap (mm) that counts as none: less than the tolerance of the judge by far."""

STEP = 0.06
"""Length of a move of the programs, as a fraction of the mean size of the shapes."""

ATTEMPTS = 8
"""Largest number of programs for a plate."""

PROGRESS = 0.8
"""A further program is tried if the violations fell below this fraction of those before."""

ROW_WORK = 2000.0
"""Work of a row of a program, in field values read."""


class LineContacts(NamedTuple):
    """Pairs ``(k, 2)`` of near rows of a layout, lines ``(k, 3)`` between their pieces, least distance, mm."""

    pairs: Int64s
    lines: Floats
    apart: float


def contacts_on(scene: PlateScene, placed: OnPlates, plate: int, reach: float) -> LineContacts:
    """Return the contacts of the items on a plate within a reach, mm."""
    instance, layout, n = scene.instance, scene.layout(placed), len(placed.items)
    items = np.flatnonzero(placed.plate == plate)
    others = np.array([o.plate in (plate, -1) for o in instance.obstacles], bool)
    rows = np.concatenate((items, n + np.flatnonzero(others)))
    corners = int(np.diff(scene.pieces.first_point).max(initial=1))
    work, size = np.empty((2, corners, 2)), 100 * len(items) + 1000
    conflict = instance.conflict if not instance.radius else _without_edge(instance.conflict)
    while True:
        pairs, lines = np.empty((size, 2), np.int64), np.empty((size, 3))
        count, apart = find_line_contacts(
            scene.pieces, instance.arrays, layout, conflict, rows, len(items), reach, work, pairs, lines
        )
        if count <= size:
            return LineContacts(pairs[:count], lines[:count], apart)
        size = count


def _without_edge(conflict: Any) -> Any:
    """Return conflicts without those with the edge of a round plate, which is kept by its sides."""
    changed = conflict.copy()
    changed[:, -1] = changed[-1] = False
    return changed


def is_exact(scene: PlateScene, placed: OnPlates, plate: int) -> bool:
    """Return whether the items on a plate are apart and inside."""
    outside = outside_of(scene, placed)[placed.plate == plate]
    if outside.max(initial=0.0) > EXACT:
        return False
    return contacts_on(scene, placed, plate, 0.01).apart >= -EXACT


def make_exact(scene: PlateScene, placed: OnPlates) -> OnPlates | None:
    """Return a layout near another without overlaps; None if the programs find none."""
    for plate in range(placed.plates):
        found = make_plate_exact(scene, placed, plate)
        if found is None:
            return None
        placed = found
    return placed


def make_plate_exact(scene: PlateScene, placed: OnPlates, plate: int) -> OnPlates | None:
    """Return a layout in which the items on a plate do not overlap; None if the programs find none."""
    last = np.inf
    for _ in range(ATTEMPTS):
        if is_exact(scene, placed, plate):
            return placed
        found = None if scene.budget.over() else _solve(scene, placed, plate)
        if found is None or (found[1] > PROGRESS * last and found[1] > EXACT):
            return None
        placed, last = found
    return placed if is_exact(scene, placed, plate) else None


def outside_of(scene: PlateScene, placed: OnPlates) -> Floats:
    """Return the greatest length by which each item is outside its range or beyond the edge of a round plate, mm."""
    shapes = scene.instance.arrays
    below = shapes.lo[placed.shape] - placed.position
    above = placed.position - shapes.hi[placed.shape]
    beyond = np.concatenate((below, above, _beyond_sides(scene, placed)), axis=1)
    return np.asarray(beyond.max(axis=1))


def _beyond_sides(scene: PlateScene, placed: OnPlates) -> Floats:
    """Return the length by which each item is beyond each side of the polygon around a round plate, ``(n, k)`` mm."""
    sides = scene.instance.sides
    if not len(sides):
        return np.zeros((len(placed.items), 0))
    reach = scene.instance.side_reach[placed.shape]
    return np.asarray(placed.position @ sides[:, :2].T + reach - sides[:, 2])


class _Rows(NamedTuple):
    """Inequalities ``normal @ (second position - first position) >= right``, and the pair of items of each."""

    first: Int64s
    second: Int64s
    normal: Floats
    right: Floats
    pair: Int64s


def _solve(scene: PlateScene, placed: OnPlates, plate: int) -> tuple[OnPlates, float] | None:
    """Return the layout of a program and its value, the sum of the violations; None without a solution."""
    from scipy.optimize import linprog
    from scipy.sparse import coo_array

    move = STEP * scene.instance.mean_size
    items = np.flatnonzero(placed.plate == plate)
    rows, pairs = _rows(scene, placed, items, move)
    n, m = len(items), len(rows.right)
    entries = [(np.arange(m), 2 * n + rows.pair, -np.ones(m))]
    for column, sign in ((rows.first, 1.0), (rows.second, -1.0)):
        moving = np.flatnonzero(column >= 0)
        for axis in range(2):
            entries.append((moving, 2 * column[moving] + axis, sign * rows.normal[moving, axis]))
    row, column, value = (np.concatenate(part) for part in zip(*entries, strict=True))
    scene.budget.left -= ROW_WORK * (m + n)
    matrix: Any = coo_array((value, (row, column)), shape=(m, 2 * n + pairs)).tocsr()
    shapes, position = scene.instance.arrays, placed.position[items]
    lo, hi = shapes.lo[placed.shape[items]], shapes.hi[placed.shape[items]]
    lower = np.minimum(np.maximum(position - move, lo), hi)
    upper = np.maximum(np.minimum(position + move, hi), lower)
    low, high = np.append(lower.ravel(), np.zeros(pairs)), np.append(upper.ravel(), np.full(pairs, np.inf))
    limits: Any = np.column_stack((low, high))
    found = linprog(
        np.append(np.zeros(2 * n), np.ones(pairs)),
        A_ub=matrix,
        b_ub=-rows.right,
        bounds=limits,
        method="highs-ds",
        options={"time_limit": min(max(scene.budget.stop.remaining(), 0.01), 1e6)},
    )
    if found.status != 0 or found.x is None:
        return None
    changed = placed.copy()
    changed.position[items] = np.clip(found.x[: 2 * n].reshape(n, 2), lower, upper)
    return changed, float(found.fun or 0.0)


def _rows(scene: PlateScene, placed: OnPlates, items: Int64s, move: float) -> tuple[_Rows, int]:
    """Return the inequalities of the items of a plate, numbered among these, and the number of pairs.

    For the second of a pair that is an obstacle, or a side of a round plate, the column is -1.
    """
    plate = int(placed.plate[items[0]])
    contacts = contacts_on(scene, placed, plate, 2.0 * np.sqrt(2.0) * move)
    number = np.full(len(placed.items) + len(scene.instance.obstacles), -1, np.int64)
    number[items] = np.arange(len(items))
    first, second = number[contacts.pairs[:, 0]], number[contacts.pairs[:, 1]]
    right = contacts.lines[:, 2] + APART
    at = scene.layout(placed).position[contacts.pairs[:, 1]]
    right = np.where(second < 0, right - (contacts.lines[:, :2] * at).sum(axis=1), right)
    beyond = _beyond_sides(scene, placed.rows(items))
    item, side = np.nonzero(beyond > -2.0 * move)
    sides, none = scene.instance.sides, np.full(len(item), -1, np.int64)
    keys = np.concatenate((contacts.pairs, np.column_stack((items[item], none))))
    unique, pair = np.unique(keys, axis=0, return_inverse=True)
    edge = (
        scene.instance.side_reach[placed.shape[items[item]], side] - sides[side, 2]
        if len(item)
        else np.zeros(0)
    )
    normal = sides[side, :2] if len(item) else np.zeros((0, 2))
    rows = _Rows(
        np.concatenate((first, item)),
        np.concatenate((second, none)),
        np.concatenate((contacts.lines[:, :2], normal)),
        np.concatenate((right, edge)),
        pair.reshape(-1),
    )
    return rows, len(unique)
