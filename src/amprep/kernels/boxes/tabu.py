"""The constructive heuristic by touching areas and the neighbourhood of a tabu search, compiled.

After Lodi, Martello and Vigo, *Heuristic algorithms for the three-dimensional bin packing problem*, European
Journal of Operational Research 141 (2002), doi:10.1016/S0377-2217(02)00134-0, as in thesis 2.4, which calls the
heuristic the sub-heuristic. An item of several boxes touches with any of its boxes.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.boxes.extreme_points import FINISHED, PAUSED
from amprep.kernels.boxes.positions import Point, contact_area, feasible_height
from amprep.kernels.boxes.records import FLAT, PAIR_SLACK, SLACK, Arrangement, BoxInstance
from amprep.kernels.helper import helper

EVEN, FEWER = 3, 4
"""Further results of `explore`: the builds have room for the item; a build is saved."""

WORK, STARTED, ALONE = 0, 1, 2
"""Columns of the cursor: comparisons made; whether `explore` has begun; whether its item is the last of its build."""

MOST_A_CALL = 40_000_000
"""Comparisons after which `sub_heuristic` ends, some two seconds."""


class OpenBuilds(NamedTuple):
    """Open builds and the best candidate for the next item.

    Attributes
    ----------
    placed
        ``(builds, boxes, 6)`` mm, boxes of each build.
    filled
        ``(builds,)`` number of the boxes in use.
    best
        ``(6,)`` area, build, orientation and position of the best candidate.
    """

    placed: Floats
    filled: Int64s
    best: Floats


class Move(NamedTuple):
    """A move of one item out of the target build, by `size` other builds that are packed again together.

    Attributes
    ----------
    others
        ``(m,)`` int64 the builds from which they are chosen.
    """

    item: int
    target: int
    size: int
    others: Int64s


class MoveSearch(NamedTuple):
    """Data and work arrays of `explore`; the arrays are modified.

    Attributes
    ----------
    by_volume
        ``(n,)`` items by decreasing volume.
    fraction
        ``(n,)`` fraction of a build's volume that each item takes.
    chosen, wanted, order
        ``(most,)``, ``(2 n,)`` and ``(2 n,)``: the present tuple of builds, whether each build is in it, the items.
    trial, merged
        Packings of the tuple, and of the items that the tuple leaves over.
    kept
        The move of least penalty so far.
    least
        ``(1,)`` its penalty.
    cursor
        ``(3,)`` see `WORK`.
    """

    by_volume: Int64s
    fraction: Floats
    chosen: Int64s
    wanted: Bools
    order: Int64s
    trial: Arrangement
    merged: Arrangement
    kept: Arrangement
    open_builds: OpenBuilds
    least: Floats
    cursor: Int64s


@helper
def _overlaps(axis: int, near: float, far: float, placed: Floats, j: int) -> bool:
    """Return whether the interval from `near` to `far` and box j share more than a point along an axis."""
    return bool(near + PAIR_SLACK < placed[j, axis + 3] and placed[j, axis] + PAIR_SLACK < far)


@helper
def _meets(axis: int, p: int, boxes: Floats, position: Point, placed: Floats, j: int) -> bool:
    """Return whether box p, moved, and box j face each other along `axis`: their projections on a plane overlap."""
    x, y, z = position
    over_x = axis == 0 or _overlaps(0, x + boxes[p, 0], x + boxes[p, 3], placed, j)
    over_y = axis == 1 or _overlaps(1, y + boxes[p, 1], y + boxes[p, 4], placed, j)
    over_z = axis == 2 or _overlaps(2, z + boxes[p, 2], z + boxes[p, 5], placed, j)
    return over_x and over_y and over_z


# Strategy. A position is admissible when a wall or a box touches the item below, at the left and at the back, and
# nothing overlaps. The three loops choose what touches below (j), at the left (i) and at the back (k), -1 for the
# wall, and which of the item's boxes it touches (p, q, r). Cheap tests come first; overlap and contact area, which
# cost a loop over the boxes of the build, come last. Time: the third power of the boxes in a build.
@njit(cache=True)
def _best_position(
    orientation: int,
    build: int,
    instance: BoxInstance,
    open_builds: OpenBuilds,
    cursor: Int64s,
    last_work: int,
) -> None:
    """Keep the admissible position of an orientation in a build with the largest contact in `open_builds.best`.

    The search ends when the work exceeds `last_work`.
    """
    first, last = instance.first_box[orientation], instance.first_box[orientation + 1]
    boxes, room, size = instance.boxes, instance.room, instance.orientations[orientation]
    placed, count, best = open_builds.placed[build], open_builds.filled[build], open_builds.best
    zones = instance.zones
    own = last - first
    for below in range(1 if room[FLAT] != 0.0 else 1 + own * count):
        p, j = first + (below - 1) % own, (below - 1) // own if below else -1
        z = room[2] if j < 0 else placed[j, 5] - boxes[p, 2]
        if z < room[2] - PAIR_SLACK or z + size[2] > room[5] + PAIR_SLACK + room[SLACK]:
            continue
        for left in range(1 + own * count):
            q, i = first + (left - 1) % own, (left - 1) // own if left else -1
            x = room[0] if i < 0 else placed[i, 3] - boxes[q, 0]
            cursor[WORK] += 1
            if cursor[WORK] > last_work:
                return
            if x < room[0] - PAIR_SLACK or x + size[0] > room[3] + PAIR_SLACK + room[SLACK]:
                continue
            if i >= 0 and not _overlaps(2, z + boxes[q, 2], z + boxes[q, 5], placed, i):
                continue
            if j >= 0 and not _overlaps(0, x + boxes[p, 0], x + boxes[p, 3], placed, j):
                continue
            for behind in range(1 + own * count):
                r, k = first + (behind - 1) % own, (behind - 1) // own if behind else -1
                y = room[1] if k < 0 else placed[k, 4] - boxes[r, 1]
                cursor[WORK] += 1
                if k >= 0 and not _meets(1, r, boxes, (x, y, z), placed, k):
                    continue
                if i >= 0 and not _meets(0, q, boxes, (x, y, z), placed, i):
                    continue
                if j >= 0 and not _meets(2, p, boxes, (x, y, z), placed, j):
                    continue
                cursor[WORK] += count
                if feasible_height((first, last), (x, y, z), z, boxes, room, placed, count, zones) < 0.0:
                    continue
                cursor[WORK] += count
                area = contact_area((first, last), (x, y, z), boxes, room, placed, count)
                if area > best[0] + PAIR_SLACK:
                    best[0], best[1], best[2] = area, build, orientation
                    best[3], best[4], best[5] = x, y, z


@helper
def _open_build(build: int, item_type: int, instance: BoxInstance, open_builds: OpenBuilds) -> None:
    """Open a build with its zones; the first feasible orientation of the item type becomes the best candidate."""
    best, zones = open_builds.best, instance.zones
    for j in range(zones):
        open_builds.placed[build, j] = instance.obstacles[j]
    open_builds.filled[build] = zones
    first, last = instance.first_orientation[item_type], instance.first_orientation[item_type + 1]
    for orientation in range(last - 1, first - 1, -1):
        if not np.isnan(instance.orientations[orientation, 3]):
            best[1], best[2] = build, orientation
            for axis in range(3):
                best[3 + axis] = instance.orientations[orientation, 3 + axis]


@njit(cache=True)
def sub_heuristic(
    order: Int64s,
    instance: BoxInstance,
    most: int,
    arrangement: Arrangement,
    open_builds: OpenBuilds,
    cursor: Int64s,
) -> int:
    """Pack the items of `order`, each where most of its surface touches; return the number of builds used.

    An item without an admissible position in any open build opens another one. The result is ``most + 1`` when more
    than `most` builds are needed (thesis 2.4, sub-heuristic), or after `MOST_A_CALL` comparisons.

    Parameters
    ----------
    order
        ``(m,)`` int64 items, by decreasing volume.
    arrangement, open_builds, cursor
        Modified in place.
    """
    best = open_builds.best
    used, last_work = 0, cursor[WORK] + MOST_A_CALL
    for item in order:
        item_type = instance.type_of[item]
        first, last = instance.first_orientation[item_type], instance.first_orientation[item_type + 1]
        best[0] = -1.0
        for build in range(used):
            for orientation in range(first, last):
                _best_position(orientation, build, instance, open_builds, cursor, last_work)
        if cursor[WORK] > last_work:
            return most + 1
        if best[0] < 0.0:
            if used == most:
                return most + 1
            _open_build(used, item_type, instance, open_builds)
            used += 1
        build, chosen = int(best[1]), int(best[2])
        arrangement.build[item], arrangement.orientation[item] = build, chosen
        for axis in range(3):
            arrangement.position[item, axis] = best[3 + axis]
        for b in range(instance.first_box[chosen], instance.first_box[chosen + 1]):
            filled = open_builds.filled[build]
            for side in range(6):
                open_builds.placed[build, filled, side] = instance.boxes[b, side] + best[3 + side % 3]
            open_builds.filled[build] += 1
    return used


@helper
def _next_tuple(chosen: Int64s, k: int, most: int) -> bool:
    """Step to the next k ascending numbers below `most` (in place); return False after the last."""
    i = k - 1
    while i >= 0 and chosen[i] == most - k + i:
        i -= 1
    if i < 0:
        return False
    chosen[i] += 1
    for j in range(i + 1, k):
        chosen[j] = chosen[j - 1] + 1
    return True


@helper
def _select_items(move: Move, build: Int64s, search: MoveSearch) -> int:
    """Write the items of the tuple's builds, and the moved item, to `search.order`; return their number."""
    search.wanted[:] = False
    for i in range(move.size):
        search.wanted[move.others[search.chosen[i]]] = True
    count = 0
    for other in search.by_volume:
        if other == move.item or search.wanted[build[other]]:
            search.order[count] = other
            count += 1
    return count


@helper
def _emptiest(builds: int, count: int, search: MoveSearch) -> tuple[int, float]:
    """Return the trial's build that is least full, and the fraction of its volume that its items take."""
    emptiest, lowest = 0, np.inf
    for new in range(builds):
        full = 0.0
        for i in range(count):
            if search.trial.build[search.order[i]] == new:
                full += search.fraction[search.order[i]]
        if full < lowest:
            emptiest, lowest = new, full
    return emptiest, lowest


@helper
def _keep_move(
    move: Move, build: Int64s, count: int, emptiest: int, instance: BoxInstance, search: MoveSearch
) -> bool:
    """Pack the trial's emptiest build together with the rest of the target; keep the move if one build holds them."""
    order, trial, merged, kept = search.order, search.trial, search.merged, search.kept
    rest = 0
    for other in search.by_volume:
        if (other != move.item and build[other] == move.target) or trial.build[other] == emptiest:
            order[count + rest] = other
            rest += 1
    together = order[count : count + rest]
    if sub_heuristic(together, instance, 1, merged, search.open_builds, search.cursor) != 1:
        return False
    kept.build[:] = -1
    for i in range(count):
        other = order[i]
        kept.build[other], kept.orientation[other] = trial.build[other], trial.orientation[other]
        kept.position[other] = trial.position[other]
    for other in together:
        kept.build[other], kept.orientation[other] = move.size + 1, merged.orientation[other]
        kept.position[other] = merged.position[other]
    return True


# Strategy, after thesis 2.4, Search. For every tuple of k other builds, the items of the tuple and the moved item are
# packed by the sub-heuristic. With at most k builds the move succeeds. With k + 1 builds the emptiest of them is
# joined with the rest of the target build; where one build holds both, the move keeps the number of builds, and its
# penalty is the filling of the emptiest build. The move of least penalty that is not tabu is kept.
@njit(cache=True)
def explore(
    move: Move, build: Int64s, tabu: Floats, work: int, instance: BoxInstance, search: MoveSearch
) -> int:
    """Try to move one item out of the target build, into tuples of other builds (thesis 2.4, Search).

    Parameters
    ----------
    build
        ``(n,)`` the build of each item.
    tabu
        ``(t,)`` forbidden penalties; negative ones are unused.
    work
        Comparisons after which the search pauses.
    search
        Modified in place. After EVEN and FEWER `trial` holds the new builds 0, 1, ... of the moved items. `kept` holds
        the move of least penalty; build k + 1 of it has the items of the target and of the emptiest build.

    Returns
    -------
    int
        EVEN or FEWER: make the move in `trial`. FINISHED: no tuple succeeds. PAUSED: call again with the same
        arguments.
    """
    chosen, trial, cursor, least = search.chosen, search.trial, search.cursor, search.least
    k = move.size
    if cursor[STARTED] == 0:
        cursor[STARTED] = 1
        for i in range(k):
            chosen[i] = i
        if k > move.others.size:
            return FINISHED
        alone = True
        for other in search.by_volume:
            alone = alone and (other == move.item or build[other] != move.target)
        cursor[ALONE] = 1 if alone else 0
    cursor[WORK] = 0
    going = True
    while going:
        count = _select_items(move, build, search)
        trial.build[:] = -1
        used = sub_heuristic(search.order[:count], instance, k + 1, trial, search.open_builds, cursor)
        if used < k or (used == k and cursor[ALONE] == 1):
            return FEWER
        if used == k:
            return EVEN
        if used == k + 1:
            emptiest, penalty = _emptiest(used, count, search)
            forbidden = penalty >= least[0]
            for known in tabu:
                forbidden = forbidden or abs(known - penalty) < 1e-12
            if not forbidden and _keep_move(move, build, count, emptiest, instance, search):
                least[0] = penalty
        going = _next_tuple(chosen, k, move.others.size)
        if going and cursor[WORK] > work:
            return PAUSED
    return FINISHED
