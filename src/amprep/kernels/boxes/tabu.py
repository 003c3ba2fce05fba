"""The sub-heuristic of touching areas and a tabu search's neighbourhood, compiled.

After Lodi, Martello and Vigo, *Heuristic algorithms for the three-dimensional bin packing problem*,
European Journal of Operational Research 141 (2002), doi:10.1016/S0377-2217(02)00134-0, as told in thesis
2.4. Records are those of `amprep.kernels.boxes.places`; items of several boxes touch with any of their boxes.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.places import FINISHED, FLAT, PAIR_SLACK, PAUSED, SLACK, settle, touching

EVEN, FEWER = 3, 4
"""What `explore` returns besides PAUSED and FINISHED: the builds take the item in, or a build is saved."""

WORK, STARTED, ALONE = 0, 1, 2
"""Places in the cursor: comparisons made; whether exploring has begun, with the last item of its build."""

MOST_A_CALL = 40_000_000
"""Comparisons after which `sub_heuristic` gives up, some two seconds."""

PENALTY = 0
"""Place in `least`: the least penalty that is not tabu."""


class Trial(NamedTuple):
    """Where items were put: build (-1: not asked), variant, place, each by item."""

    build: Int64s
    variant: Int64s
    place: Floats


class Bins(NamedTuple):
    """Work arrays of the sub-heuristic: boxes ``(builds, boxes, 6)`` and how many of them are used."""

    placed: Floats
    filled: Int64s


@njit(cache=True)
def _overlaps(axis, near, far, placed, j):
    """Whether the interval from `near` to `far` and box j share more than a point along an axis."""
    return near + PAIR_SLACK < placed[j, axis + 3] and placed[j, axis] + PAIR_SLACK < far


@njit(cache=True)
def _meets(axis, p, boxes, x, y, z, placed, j):
    """Whether box p, moved, and box j face each other along `axis`: their shadows on its plane overlap."""
    over_x = axis == 0 or _overlaps(0, x + boxes[p, 0], x + boxes[p, 3], placed, j)
    over_y = axis == 1 or _overlaps(1, y + boxes[p, 1], y + boxes[p, 4], placed, j)
    over_z = axis == 2 or _overlaps(2, z + boxes[p, 2], z + boxes[p, 5], placed, j)
    return over_x and over_y and over_z


@njit(cache=True)
def _best_place(v, build, shapes, room, standing, bins, best, cursor, last_work):
    """Keep in `best` the admissible place of variant v in a build with the most contact (in place).

    Ends early when the work goes beyond `last_work`.

    Admissible: a wall or a box touches it below, at the left and at the back, and nothing overlaps. Loops
    run over what touches below (j), at the left (i) and at the back (k), -1 for the wall, and over which of
    the item's boxes is touched (p, q, r).
    """
    first, last = shapes.first_box[v], shapes.first_box[v + 1]
    boxes, placed, count = shapes.boxes, bins.placed[build], bins.filled[build]
    own = last - first
    floor_only = room[FLAT] != 0.0
    for below in range(1 if floor_only else 1 + own * count):
        p, j = first + (below - 1) % own, (below - 1) // own if below else -1
        z = room[2] if j < 0 else placed[j, 5] - boxes[p, 2]
        if z < room[2] - PAIR_SLACK or z + shapes.variants[v, 2] > room[5] + PAIR_SLACK + room[SLACK]:
            continue
        for left in range(1 + own * count):
            q, i = first + (left - 1) % own, (left - 1) // own if left else -1
            x = room[0] if i < 0 else placed[i, 3] - boxes[q, 0]
            cursor[WORK] += 1
            if cursor[WORK] > last_work:
                return
            if x < room[0] - PAIR_SLACK or x + shapes.variants[v, 0] > room[3] + PAIR_SLACK + room[SLACK]:
                continue
            if i >= 0 and not _overlaps(2, z + boxes[q, 2], z + boxes[q, 5], placed, i):
                continue
            if j >= 0 and not _overlaps(0, x + boxes[p, 0], x + boxes[p, 3], placed, j):
                continue
            for behind in range(1 + own * count):
                r, k = first + (behind - 1) % own, (behind - 1) // own if behind else -1
                y = room[1] if k < 0 else placed[k, 4] - boxes[r, 1]
                cursor[WORK] += 1
                if k >= 0 and not _meets(1, r, boxes, x, y, z, placed, k):
                    continue
                if i >= 0 and not _meets(0, q, boxes, x, y, z, placed, i):
                    continue
                if j >= 0 and not _meets(2, p, boxes, x, y, z, placed, j):
                    continue
                cursor[WORK] += count
                if settle(first, last, x, y, z, z, boxes, room, placed, count, standing) < 0.0:
                    continue
                cursor[WORK] += count
                area = touching(first, last, x, y, z, boxes, room, placed, count)
                if area > best[0] + PAIR_SLACK:
                    best[0], best[1], best[2] = area, build, v
                    best[3], best[4], best[5] = x, y, z


@njit(cache=True)
def sub_heuristic(order, shapes, room, zones, most, trial, bins, best, cursor):
    """Pack the items of `order` where most of their surface touches; return the number of builds used.

    An item with no admissible place in any open build starts a new one; more than `most` are not opened,
    and ``most + 1`` is returned (thesis 2.4, sub-heuristic), as it is after `MOST_A_CALL` comparisons: what is
    tried grows with the third power of the boxes in a build. `zones` ``(m, 6)`` stand in every build.

    Parameters
    ----------
    order
        ``(m,)`` int64 items, by decreasing volume.
    trial, bins, best, cursor
        Modified in place; `best` has 6 places.
    """
    used, last_work = 0, cursor[WORK] + MOST_A_CALL
    for item in order:
        kind = shapes.kind[item]
        first, last = shapes.first_variant[kind], shapes.first_variant[kind + 1]
        best[0] = -1.0
        for build in range(used):
            for v in range(first, last):
                _best_place(v, build, shapes, room, zones.shape[0], bins, best, cursor, last_work)
        if cursor[WORK] > last_work:
            return most + 1
        if best[0] < 0.0:
            if used == most:
                return most + 1
            for j in range(zones.shape[0]):
                bins.placed[used, j] = zones[j]
            bins.filled[used] = zones.shape[0]
            for v in range(last - 1, first - 1, -1):
                if not np.isnan(shapes.variants[v, 3]):
                    best[1], best[2] = used, v
                    best[3], best[4], best[5] = (
                        shapes.variants[v, 3],
                        shapes.variants[v, 4],
                        shapes.variants[v, 5],
                    )
            used += 1
        build, v = int(best[1]), int(best[2])
        trial.build[item], trial.variant[item] = build, v
        for axis in range(3):
            trial.place[item, axis] = best[3 + axis]
        for b in range(shapes.first_box[v], shapes.first_box[v + 1]):
            for side in range(6):
                bins.placed[build, bins.filled[build], side] = shapes.boxes[b, side] + best[3 + side % 3]
            bins.filled[build] += 1
    return used


@njit(cache=True)
def _next_tuple(chosen, k, most):
    """Step to the next k numbers below `most`, ascending (in place); False after the last."""
    i = k - 1
    while i >= 0 and chosen[i] == most - k + i:
        i -= 1
    if i < 0:
        return False
    chosen[i] += 1
    for j in range(i + 1, k):
        chosen[j] = chosen[j - 1] + 1
    return True


@njit(cache=True)
def _select(by_volume, build, item, wanted, order):
    """Write the items of the wanted builds, and `item`, to `order` by decreasing volume; say how many."""
    count = 0
    for other in by_volume:
        if other == item or wanted[build[other]]:
            order[count] = other
            count += 1
    return count


@njit(cache=True)
def explore(
    item, target, others, k, by_volume, share, build, shapes, room, zones, work, tabu, chosen, wanted, order,
    trial, merged, kept, bins, best, least, cursor,
):  # fmt: skip
    """Try to move one item out of the target build, into k others at a time (thesis 2.4, Search).

    Parameters
    ----------
    others
        ``(m,)`` int64 the builds from which tuples are taken.
    by_volume, share
        ``(n,)`` items by decreasing volume; ``(n,)`` share of a build's volume that each takes.
    tabu
        ``(t,)`` penalties that are forbidden, negative when unused.
    trial, kept
        On EVEN and FEWER `trial` holds the new builds 0, 1, ... of what was moved. `kept` holds the move of
        least penalty, with number k + 1 for what was in the target and the least full build.

    Returns
    -------
    int
        EVEN, FEWER: make the move in `trial`. FINISHED: no such tuple; `least` has the least penalty so far.
        PAUSED: `work` comparisons are done, call again with the same arguments.
    """
    if cursor[STARTED] == 0:
        cursor[STARTED] = 1
        for i in range(k):
            chosen[i] = i
        if k > others.size:
            return FINISHED
        alone = True
        for other in by_volume:
            alone = alone and (other == item or build[other] != target)
        cursor[ALONE] = 1 if alone else 0
    cursor[WORK] = 0
    going = True
    while going:
        wanted[:] = False
        for i in range(k):
            wanted[others[chosen[i]]] = True
        count = _select(by_volume, build, item, wanted, order)
        trial.build[:] = -1
        used = sub_heuristic(order[:count], shapes, room, zones, k + 1, trial, bins, best, cursor)
        if used < k or (used == k and cursor[ALONE] == 1):
            return FEWER
        if used == k:
            return EVEN
        if used == k + 1:
            emptiest, lowest = 0, np.inf
            for new in range(used):
                full = 0.0
                for i in range(count):
                    if trial.build[order[i]] == new:
                        full += share[order[i]]
                if full < lowest:
                    emptiest, lowest = new, full
            forbidden = lowest >= least[PENALTY]
            for penalty in tabu:
                forbidden = forbidden or abs(penalty - lowest) < 1e-12
            if not forbidden:
                rest = 0
                for other in by_volume:
                    if (other != item and build[other] == target) or trial.build[other] == emptiest:
                        order[count + rest] = other
                        rest += 1
                together = order[count : count + rest]
                if sub_heuristic(together, shapes, room, zones, 1, merged, bins, best, cursor) == 1:
                    least[PENALTY] = lowest
                    kept.build[:] = -1
                    for i in range(count):
                        other = order[i]
                        kept.build[other], kept.variant[other] = trial.build[other], trial.variant[other]
                        kept.place[other] = trial.place[other]
                    for other in together:
                        kept.build[other], kept.variant[other] = k + 1, merged.variant[other]
                        kept.place[other] = merged.place[other]
        going = _next_tuple(chosen, k, others.size)
        if going and cursor[WORK] > work:
            return PAUSED
    return FINISHED
