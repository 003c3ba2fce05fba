"""Ruin and recreate over builds, compiled: a few builds and all unassigned items are packed again and again.

After the goal-driven searches for bin packing (Wei, Oon, Zhu, Lim, EJOR 2013, doi:10.1016/j.ejor.2012.08.005;
Schrimpf et al., *Record breaking optimization results using the ruin and recreate principle*, J. Comp. Physics
2000, doi:10.1006/jcph.1999.6413), with the passes of `amprep.kernels.boxes.extreme_points` to recreate.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.extreme_points import pack
from amprep.kernels.boxes.positions import LEFT, WORK, PassState
from amprep.kernels.boxes.records import Arrangement, BoxInstance
from amprep.kernels.helper import helper
from amprep.kernels.random_numbers import uniform

SOLVED, PAUSED = 0, 1
"""Results of `search`: every item is in a build; the work is used up, call again."""

MOST_A_STEP = 40_000_000
"""Comparisons after which a step ends; items without a position are unassigned then."""

SPENT, STEPS = 0, 1
"""Columns of `spent`: comparisons and steps made."""


class SearchOrders(NamedTuple):
    """Data that a search does not change.

    Attributes
    ----------
    items
        ``(m,)`` int64 items to be packed.
    keys
        ``(s, n)`` sort keys above 0, greatest first.
    weight
        ``(n,)`` weight of an item when it is unassigned.
    rules
        ``(r, 6)`` placement rules.
    """

    items: Int64s
    keys: Floats
    weight: Floats
    rules: Floats


class MetBuilds(NamedTuple):
    """Builds that the search has met, each set of items once; when the arrays are full, all are forgotten.

    Attributes
    ----------
    code
        ``(n,)`` uint64 random number of each item; the key of a build is the sum of its items' codes.
    key, row
        ``(2^b,)`` hash table: key and number of a build; row -1 is empty.
    start
        ``(p + 1,)`` index at which the items of each build begin.
    item, orientation, position
        ``(t,)``, ``(t,)`` and ``(t, 3)`` as in `Arrangement`.
    number
        ``(1,)`` number of builds.
    """

    code: NDArray[np.uint64]
    key: NDArray[np.uint64]
    row: Int64s
    start: Int64s
    item: Int64s
    orientation: Int64s
    position: Floats
    number: Int64s


class SearchState(NamedTuple):
    """State of the search and its work arrays; all are modified.

    Attributes
    ----------
    arrangement
        The present solution; its unassigned items have build -1.
    met
        Builds met so far.
    random
        ``(1,)`` uint64 state of the random numbers, not 0.
    spent
        ``(2,)`` see `SPENT`.
    repacked, pass_state
        Result and state of the pass of a step.
    chosen, order
        ``(most,)`` builds that a step empties, and ``(n,)`` the items that it packs.
    """

    arrangement: Arrangement
    met: MetBuilds
    random: NDArray[np.uint64]
    spent: Int64s
    repacked: Arrangement
    pass_state: PassState
    chosen: Int64s
    order: Int64s


@helper
def _remember_build(build: int, items: Int64s, arrangement: Arrangement, met: MetBuilds) -> None:
    """Add the items that a build of an arrangement holds to the met builds, unless they are known."""
    key, size = np.uint64(0), 0
    for item in items:
        if arrangement.build[item] == build:
            key += met.code[item]
            size += 1
    if met.number[0] + 1 >= met.start.size or met.start[met.number[0]] + size > met.item.size:
        met.row[:] = -1
        met.number[0] = 0
    mask = met.key.size - 1
    at = np.int64(key >> np.uint64(16)) & mask
    while met.row[at] >= 0 and met.key[at] != key:
        at = (at + 1) & mask
    if met.row[at] >= 0 or size == 0:
        return
    row = met.number[0]
    met.key[at], met.row[at] = key, row
    last = met.start[row]
    for item in items:
        if arrangement.build[item] == build:
            met.item[last], met.orientation[last] = item, arrangement.orientation[item]
            for i in range(3):
                met.position[last, i] = arrangement.position[item, i]
            last += 1
    met.start[row + 1] = last
    met.number[0] = row + 1


@helper
def _choose_builds(count: int, builds: int, random: NDArray[np.uint64], chosen: Int64s) -> None:
    """Write `count` different builds to `chosen`.

    Build 0 comes first when it is among them: obstacles of the first build are in the first build of a pass.
    """
    for i in range(count):
        again = True
        while again:
            chosen[i] = int(uniform(random) * builds)
            again = False
            for j in range(i):
                again = again or chosen[j] == chosen[i]
    for i in range(1, count):
        if chosen[i] == 0:
            chosen[i], chosen[0] = chosen[0], chosen[i]


# Strategy. The number of builds is fixed and some items are unassigned. A step empties one to `ruin_size` random
# builds, sorts their items and the unassigned ones by a random key with noise, and packs them again by one pass of
# extreme points under a random rule. The result replaces the builds when the weight of the unassigned items grows by
# no more than a random amount from an exponential distribution of mean `temperature`; so the search leaves local
# optima. It is solved when no item is unassigned. A step costs about one pass over the items of the chosen builds.
@njit(cache=True, nogil=True)
def search(
    builds: int,
    ruin_size: int,
    temperature: float,
    work: int,
    instance: BoxInstance,
    orders: SearchOrders,
    state: SearchState,
) -> int:
    """Pack the unassigned items into `builds` builds by ruin and recreate; stop after `work` comparisons.

    Parameters
    ----------
    ruin_size
        Greatest number of builds that a step empties.
    temperature
        Mean by which the weight of the unassigned items may grow in a step.
    state
        Modified in place. Builds are remembered unless the first one holds fixed boxes.

    Returns
    -------
    int
        SOLVED or PAUSED.
    """
    items, keys, weight, rules = orders
    arrangement, met, random, spent, repacked, pass_state, chosen, order = state
    last = spent[SPENT] + work
    key = np.empty(order.size)
    fixed = instance.obstacles.shape[0] > instance.zones
    while spent[SPENT] < last:
        ruined = min(builds, 1 + int(uniform(random) * ruin_size))
        _choose_builds(ruined, builds, random, chosen)
        row = int(uniform(random) * keys.shape[0])
        noise = 1.2 * uniform(random)
        unassigned_first = uniform(random) < 0.3
        count, before = 0, 0.0
        for item in items:
            build = arrangement.build[item]
            taken = build < 0
            for i in range(ruined):
                taken = taken or chosen[i] == build
            if taken:
                key[count] = np.log(keys[row, item]) + noise * (uniform(random) - 0.5)
                if build < 0:
                    before += weight[item]
                    key[count] += 100.0 if unassigned_first else 0.0
                order[count] = item
                count += 1
        if before == 0.0:
            return SOLVED
        sorted_order = order[:count][np.argsort(-key[:count])]
        for item in sorted_order:
            repacked.build[item] = -1
        pass_state.cursor[:] = 0
        pass_state.cursor[LEFT] = count
        pass_state.failed[:] = -1
        rule = rules[int(uniform(random) * rules.shape[0])]
        first_obstacles = instance.obstacles.shape[0] if chosen[0] == 0 else instance.zones
        pack(sorted_order, instance, first_obstacles, rule, ruined, MOST_A_STEP, repacked, pass_state)
        spent[SPENT] += pass_state.cursor[WORK] + items.size + 20 * count
        spent[STEPS] += 1
        for i in range(0 if fixed else ruined):
            _remember_build(i, sorted_order, repacked, met)
        after = 0.0
        for item in sorted_order:
            if repacked.build[item] < 0:
                after += weight[item]
        if after <= before - temperature * np.log(1.0 - uniform(random)):
            for item in sorted_order:
                new = repacked.build[item]
                arrangement.build[item] = -1 if new < 0 else chosen[new]
                arrangement.orientation[item] = repacked.orientation[item]
                arrangement.position[item] = repacked.position[item]
            if after == 0.0:
                return SOLVED
    return PAUSED
