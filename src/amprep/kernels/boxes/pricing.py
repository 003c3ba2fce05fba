"""The set of boxes of greatest value that may fit one build, compiled: a branch and bound.

The search leaves out only sets that are proved not to fit. A set that it accepts may still not fit, so its result is
an upper bound on the value of any build.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Bools, Bytes, Floats, Int64s
from amprep.kernels.boxes.relations import IMPOSSIBLE, RelationScratch, fit_together
from amprep.kernels.helper import helper

EXACT, CUT_OFF = 0, 1
"""Results of `price`: the search was complete; it ended early."""

FOUND, VALUE, SPENT, HALT = 0, 1, 2, 3
"""Columns of the outcome of `price`: sets found, greatest value, comparisons made; not 0 to make it return."""

ROUNDING = 1e-9


class Sets(NamedTuple):
    """The boxes, and the rules that exclude sets of them.

    Attributes
    ----------
    demand
        ``(k,)`` number of boxes of each type.
    size, room
        ``(k, 3)`` and ``(3,)`` mm; the room includes some slack.
    load
        ``(k, s)`` conservative scales: their sum over the boxes of a build is at most 1. The first is the volume.
    conflict
        ``(k, k)`` bool: no box of the one type fits together with one of the other.
    code
        ``(k,)`` uint64 random numbers; the key of a set is the sum of the codes of its boxes.
    """

    demand: Int64s
    size: Floats
    room: Floats
    load: Floats
    conflict: Bools
    code: NDArray[np.uint64]


class PricingLimits(NamedTuple):
    """Limits of the search in `price`.

    Attributes
    ----------
    goal
        After a set of greater value than this has been found, the search ends after an eighth of the work.
    work
        Comparisons after which it ends.
    most_checked, decisions
        Size up to which sets are tested exactly, and the greatest number of decisions in a test.
    """

    goal: float
    work: float
    most_checked: int
    decisions: int


class Memory(NamedTuple):
    """A hash table of tested sets: ``(2^b,)`` key and verdict (0: empty, 1: may fit, 2: does not fit)."""

    key: NDArray[np.uint64]
    verdict: Bytes


class PricingState(NamedTuple):
    """State of the search; all arrays are modified.

    Attributes
    ----------
    chosen, keys
        ``(n + 1,)`` types of the chosen boxes, and ``(n + 2,)`` keys of the sets of the first ones.
    held, blocked
        ``(k,)`` number of chosen boxes of each type, and of those that exclude it.
    left
        ``(s,)`` room left on each scale.
    sizes
        ``(most_checked, 3)`` mm sizes of the boxes that are tested together.
    outcome
        ``(4,)`` see `FOUND`.
    """

    memory: Memory
    chosen: Int64s
    keys: NDArray[np.uint64]
    held: Int64s
    blocked: Int64s
    left: Floats
    sizes: Floats
    relations: RelationScratch
    outcome: Floats


@helper
def _is_bounded(
    profit: Floats, order: Int64s, position: int, value: float, best: float, sets: Sets, state: PricingState
) -> bool:
    """Return whether no set that adds types from `position` of the order on has a value above `best`.

    The bound is the least fractional knapsack over the scales.
    """
    for s in range(sets.load.shape[1]):
        room, most = state.left[s] + ROUNDING, value
        for t in range(order.shape[1]):
            item_type = order[1 + s, t]
            if order[0, item_type] < position or state.blocked[item_type] > 0:
                continue
            more = sets.demand[item_type] - state.held[item_type]
            if sets.load[item_type, s] * more <= room:
                most += profit[item_type] * more
                room -= sets.load[item_type, s] * more
            else:
                most += profit[item_type] * room / sets.load[item_type, s]
                break
        if most <= best:
            return True
    return False


@helper
def _may_join(item_type: int, n: int, limits: PricingLimits, sets: Sets, state: PricingState) -> bool:
    """Return whether a box of this type may fit together with the n chosen ones; verdicts are remembered."""
    if state.blocked[item_type] > 0 or state.held[item_type] >= sets.demand[item_type]:
        return False
    for s in range(sets.load.shape[1]):
        if sets.load[item_type, s] > state.left[s] + ROUNDING:
            return False
    if n < 2 or n >= limits.most_checked:
        return True
    memory = state.memory
    key = state.keys[n] + sets.code[item_type]
    mask = memory.key.size - 1
    at = np.int64(key >> np.uint64(16)) & mask
    tries = 0
    while memory.verdict[at] != 0 and memory.key[at] != key and tries < 32:
        at = (at + 1) & mask
        tries += 1
    if memory.verdict[at] == 0 or memory.key[at] != key:
        for i in range(n + 1):
            for a in range(3):
                state.sizes[i, a] = sets.size[state.chosen[i] if i < n else item_type, a]
        verdict, decisions = fit_together(n + 1, state.sizes, sets.room, limits.decisions, state.relations)
        memory.key[at], memory.verdict[at] = key, 2 if verdict == IMPOSSIBLE else 1
        state.outcome[SPENT] += 3.0 * decisions * (n + 1) * (n + 1)
    return bool(memory.verdict[at] != 2)


@helper
def _take(item_type: int, n: int, sign: int, sets: Sets, state: PricingState) -> None:
    """Add a box of this type to the n chosen ones, or with sign -1 remove it."""
    state.held[item_type] += sign
    for s in range(sets.load.shape[1]):
        state.left[s] -= sign * sets.load[item_type, s]
    for other in range(sets.demand.size):
        if sets.conflict[item_type, other]:
            state.blocked[other] += sign
    state.chosen[n], state.keys[n + 1] = item_type, state.keys[n] + sets.code[item_type]


# Strategy. Depth first over sets of boxes, types in the order of profit per volume. A set is excluded when a
# conservative scale of its boxes exceeds 1, when two of its boxes exclude each other, or when an exact search over up
# to `most_checked` boxes finds no packing (`amprep.kernels.boxes.relations`). A branch ends when the fractional
# knapsack of some scale cannot beat the best set. Each of these is a relaxation of packing, so the greatest value
# found by a complete search is an upper bound. Time: exponential at worst; verdicts of exact searches are remembered.
@njit(cache=True, nogil=True)
def price(
    profit: Floats, order: Int64s, limits: PricingLimits, sets: Sets, state: PricingState, columns: Int64s
) -> int:
    """Find sets of value above 1, each better than the last, and the greatest value of any set.

    Parameters
    ----------
    profit
        ``(k,)`` value of a box of each type, at least 0.
    order
        ``(1 + s, k)`` int64: the rank of each type in the order of branching; then, for each scale, the types by
        falling profit per load. The order of branching is that of the first scale.
    state
        Modified in place.
    columns
        ``(c, k)`` int64, the last sets found; modified in place.

    Returns
    -------
    int
        EXACT: no set has a value above ``state.outcome[VALUE]``; CUT_OFF: there may be one.
    """
    item_types, scales = sets.load.shape
    outcome = state.outcome
    state.held[:] = 0
    state.blocked[:] = 0
    state.left[:] = 1.0
    best, value = 1.0 + ROUNDING, 0.0
    outcome[SPENT] = 0.0
    n, found, position, down = 0, 0, 0, True
    code = EXACT
    while True:
        if down:
            outcome[SPENT] += item_types * scales
            enough = best > limits.goal and 8.0 * outcome[SPENT] > limits.work
            if enough or outcome[SPENT] > limits.work or outcome[HALT] != 0.0:
                code = CUT_OFF
            down = code == EXACT and not _is_bounded(profit, order, position, value, best, sets, state)
        taken = False
        while down and position < item_types and not taken:
            item_type = order[1, position]
            taken = _may_join(item_type, n, limits, sets, state)
            outcome[SPENT] += scales
            position += 0 if taken else 1
        if taken:
            _take(item_type, n, 1, sets, state)
            n += 1
            value += profit[item_type]
            if value > best:
                best = value
                columns[found % columns.shape[0]] = state.held
                found += 1
            continue
        if n == 0:
            outcome[FOUND], outcome[VALUE] = found, best
            return code
        n -= 1
        item_type = state.chosen[n]
        _take(item_type, n, -1, sets, state)
        value -= profit[item_type]
        position, down = order[0, item_type] + 1, True
