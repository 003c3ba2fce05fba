"""Ruin and recreate over builds, compiled: a few builds and all loose items are packed anew, again and again.

The number of builds is fixed; items that find no place are loose, and a search ends when none is. After the
goal-driven searches for bin packing (Wei, Oon, Zhu, Lim, EJOR 2013, doi:10.1016/j.ejor.2012.08.005; Schrimpf
et al., *Record breaking optimization results using the ruin and recreate principle*, J. Comp. Physics 2000,
doi:10.1006/jcph.1999.6413), with the passes of `amprep.kernels.boxes.extreme_points` to recreate.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.extreme_points import pack
from amprep.kernels.boxes.places import LEFT, WORK, helper

SOLVED, PAUSED = 0, 1
"""What `search` returns: no item is loose; work used up, call again."""

MOST_A_STEP = 40_000_000
"""Comparisons after which a step is given up; what has no place by then is loose."""

SPENT, STEPS = 0, 1
"""Places in `spent`: comparisons and steps made."""


class Seen(NamedTuple):
    """Builds met on the way, each set of items once; when there is no room for more, all are forgotten.

    Attributes
    ----------
    code
        ``(n,)`` uint64 random number of each item; a build's key is the sum of its items'.
    key, row
        ``(2^b,)`` hash table: key and number of a build; row -1 is empty.
    start
        ``(p + 1,)`` where the items of each build begin.
    item, variant, place
        ``(t,)``, ``(t,)`` and ``(t, 3)`` as in `Bins`.
    noted
        ``(1,)`` builds noted.
    """

    code: NDArray[np.uint64]
    key: NDArray[np.uint64]
    row: Int64s
    start: Int64s
    item: Int64s
    variant: Int64s
    place: Floats
    noted: Int64s


class Bins(NamedTuple):
    """The moving state: build (-1: loose), variant and place of each item, as in `box_places.Answer`."""

    build: Int64s
    variant: Int64s
    place: Floats


@njit(cache=True)
def _random(state):
    """Return a number from 0 to 1 and step the state (xorshift64*, Vigna 2016, doi:10.1145/2845077)."""
    x = state[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    state[0] = x
    return np.float64((x * np.uint64(2685821657736338717)) >> np.uint64(11)) / 9007199254740992.0


@helper
def _note(number, items, answer, seen):
    """Note what `items` the build of this number holds, unless it is known (seen modified)."""
    key, size = np.uint64(0), 0
    for item in items:
        if answer.build[item] == number:
            key += seen.code[item]
            size += 1
    if seen.noted[0] + 1 >= seen.start.size or seen.start[seen.noted[0]] + size > seen.item.size:
        seen.row[:] = -1
        seen.noted[0] = 0
    mask = seen.key.size - 1
    at = np.int64(key >> np.uint64(16)) & mask
    while seen.row[at] >= 0 and seen.key[at] != key:
        at = (at + 1) & mask
    if seen.row[at] >= 0 or size == 0:
        return
    row = seen.noted[0]
    seen.key[at], seen.row[at] = key, row
    last = seen.start[row]
    for item in items:
        if answer.build[item] == number:
            seen.item[last], seen.variant[last] = item, answer.variant[item]
            for i in range(3):
                seen.place[last, i] = answer.place[item, i]
            last += 1
    seen.start[row + 1] = last
    seen.noted[0] = row + 1


@njit(cache=True, nogil=True)
def search(
    items, builds, most_ruined, heat, keys, weight, styles, shapes, room, obstacles, zones, work, random,
    bins, answer, scratch, chosen, order, spent, seen,
):  # fmt: skip
    """Pack the loose items into `builds` builds by packing a few of them anew, until none is loose.

    A step takes 1 to `most_ruined` builds at random, sorts their items and the loose ones by one of the keys,
    disturbed, and packs them in one of the styles. What then is loose may weigh more than before by an
    amount drawn from an exponential distribution of mean `heat`.

    Parameters
    ----------
    items
        ``(m,)`` int64 the items to be packed.
    keys
        ``(s, n)`` sort keys, greatest first.
    weight
        ``(n,)`` what an item counts when loose.
    styles
        ``(s, 6)`` ways to choose places, see `amprep.kernels.boxes.places`.
    random, bins, answer, scratch, chosen, order, spent, seen
        Modified in place; `chosen` has `most_ruined` places, `order` n, `spent` 2. Builds are noted in `seen`
        unless something stands in the first.
    """
    last = spent[SPENT] + work
    key = np.empty(order.size)
    fixed = obstacles.shape[0] > zones
    empty_room = obstacles[:zones]
    while spent[SPENT] < last:
        r = min(builds, 1 + int(_random(random) * most_ruined))
        for i in range(r):
            again = True
            while again:
                chosen[i] = int(_random(random) * builds)
                again = False
                for j in range(i):
                    again = again or chosen[j] == chosen[i]
        for i in range(1, r):
            # what stands already is in the first build, which therefore comes first
            if chosen[i] == 0:
                chosen[i], chosen[0] = chosen[0], chosen[i]
        kind = int(_random(random) * keys.shape[0])
        noise = 1.2 * _random(random)
        loose_first = _random(random) < 0.3
        count, before = 0, 0.0
        for item in items:
            build = bins.build[item]
            taken = build < 0
            for i in range(r):
                taken = taken or chosen[i] == build
            if taken:
                key[count] = np.log(keys[kind, item]) + noise * (_random(random) - 0.5)
                if build < 0:
                    before += weight[item]
                    key[count] += 100.0 if loose_first else 0.0
                order[count] = item
                count += 1
        if before == 0.0:
            return SOLVED
        sorted_order = order[:count][np.argsort(-key[:count])]
        for item in sorted_order:
            answer.build[item] = -1
        scratch.cursor[:] = 0
        scratch.cursor[LEFT] = count
        scratch.failed[:] = -1
        style = styles[int(_random(random) * styles.shape[0])]
        standing = obstacles if fixed and chosen[0] == 0 else empty_room
        pack(sorted_order, shapes, room, standing, zones, style, r, MOST_A_STEP, answer, scratch)
        spent[SPENT] += scratch.cursor[WORK] + items.size + 20 * count
        spent[STEPS] += 1
        for i in range(0 if fixed else r):
            _note(i, sorted_order, answer, seen)
        after = 0.0
        for item in sorted_order:
            if answer.build[item] < 0:
                after += weight[item]
        if after <= before - heat * np.log(1.0 - _random(random)):
            for item in sorted_order:
                new = answer.build[item]
                bins.build[item] = -1 if new < 0 else chosen[new]
                bins.variant[item], bins.place[item] = answer.variant[item], answer.place[item]
            if after == 0.0:
                return SOLVED
    return PAUSED
