"""The build of greatest worth, compiled: a branch and bound over sets of boxes that may fit one room together.

What is left out of the search is proved not to fit: by conservative scales, by pairs that exclude one another,
and for up to `most_checked` boxes by `amprep.kernels.boxes.relations`. What is let through may still not fit, so
its result bounds what any build is worth.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes.places import helper
from amprep.kernels.boxes.relations import IMPOSSIBLE, fit_together

EXACT, CUT_OFF = 0, 1
"""What `price` returns: the search was complete; it was not."""

FOUND, WORTH, SPENT, HALT = 0, 1, 2, 3
"""Places in the outcome of `price`: sets found, greatest worth, comparisons made; not 0 to make it return."""

ROUNDING = 1e-9


class Sets(NamedTuple):
    """What may be in one build.

    Attributes
    ----------
    demand
        ``(k,)`` boxes of each kind.
    size, room
        ``(k, 3)`` and ``(3,)`` mm; the room with some slack.
    load
        ``(k, s)`` conservative scales: in no build can their sum exceed 1. The first is the volume.
    conflict
        ``(k, k)`` bool: no box of the one goes with one of the other.
    code
        ``(k,)`` uint64 random; a set's key in the memory is the sum of its boxes'.
    """

    demand: Int64s
    size: Floats
    room: Floats
    load: Floats
    conflict: NDArray[np.bool_]
    code: NDArray[np.uint64]


class Memory(NamedTuple):
    """A hash table of sets looked at: ``(2^b,)`` key and verdict (0: empty, 1: may fit, 2: does not)."""

    key: NDArray[np.uint64]
    verdict: NDArray[np.uint8]


class PricingScratch(NamedTuple):
    """Work arrays: chosen kinds and keys of the sets so far, counts, conflicts, room left on each scale."""

    chosen: Int64s
    keys: NDArray[np.uint64]
    held: Int64s
    blocked: Int64s
    left: Floats
    sizes: Floats


@helper
def _bounded(profit, order, position, value, best, sets, scratch):
    """Whether no set that adds kinds from `position` of the order on is worth more than `best`."""
    for s in range(sets.load.shape[1]):
        room, most = scratch.left[s] + ROUNDING, value
        for t in range(order.shape[1]):
            kind = order[1 + s, t]
            if order[0, kind] < position or scratch.blocked[kind] > 0:
                continue
            more = sets.demand[kind] - scratch.held[kind]
            if sets.load[kind, s] * more <= room:
                most += profit[kind] * more
                room -= sets.load[kind, s] * more
            else:
                most += profit[kind] * room / sets.load[kind, s]
                break
        if most <= best:
            return True
    return False


@helper
def _may_join(kind, n, most_checked, limit, sets, memory, scratch, relations, outcome):
    """Whether a box of this kind may go with the n chosen ones; verdicts are remembered, work is counted."""
    if scratch.blocked[kind] > 0 or scratch.held[kind] >= sets.demand[kind]:
        return False
    for s in range(sets.load.shape[1]):
        if sets.load[kind, s] > scratch.left[s] + ROUNDING:
            return False
    if n < 2 or n >= most_checked:
        return True
    key = scratch.keys[n] + sets.code[kind]
    mask = memory.key.size - 1
    at = np.int64(key >> np.uint64(16)) & mask
    tries = 0
    while memory.verdict[at] != 0 and memory.key[at] != key and tries < 32:
        at = (at + 1) & mask
        tries += 1
    if memory.verdict[at] == 0 or memory.key[at] != key:
        for i in range(n + 1):
            for a in range(3):
                scratch.sizes[i, a] = sets.size[scratch.chosen[i] if i < n else kind, a]
        verdict, decisions = fit_together(n + 1, scratch.sizes, sets.room, limit, relations)
        memory.key[at], memory.verdict[at] = key, 2 if verdict == IMPOSSIBLE else 1
        outcome[SPENT] += 3.0 * decisions * (n + 1) * (n + 1)
    return memory.verdict[at] != 2


@helper
def _take(kind, n, sign, sets, scratch):
    """Add a box of this kind to the chosen ones, or with sign -1 take it away (scratch modified)."""
    scratch.held[kind] += sign
    for s in range(sets.load.shape[1]):
        scratch.left[s] -= sign * sets.load[kind, s]
    for other in range(sets.demand.size):
        if sets.conflict[kind, other]:
            scratch.blocked[other] += sign
    scratch.chosen[n], scratch.keys[n + 1] = kind, scratch.keys[n] + sets.code[kind]


@njit(cache=True, nogil=True)
def price(
    profit, order, goal, work, most_checked, limit, sets, memory, scratch, relations,
    columns, outcome,
):  # fmt: skip
    """Find sets worth more than 1, better and better, and the most any set is worth.

    Parameters
    ----------
    profit
        ``(k,)`` worth of a box of each kind, at least 0.
    order
        ``(1 + s, k)`` int64: the place of each kind in the order of branching, then for each scale the kinds
        by falling profit per load; the order of branching is that of the first scale.
    goal
        With a set worth more than this in hand the search ends after an eighth of the work.
    work
        Comparisons after which it ends.
    most_checked, limit
        Sets up to this size are looked at exactly, with at most `limit` decisions each.
    columns
        ``(c, k)`` int64, the last sets found, in place.
    outcome
        ``(4,)`` in place, see `FOUND`.

    Returns
    -------
    int
        EXACT: nothing is worth more than ``outcome[WORTH]``; CUT_OFF: something may be.
    """
    kinds, scales = sets.load.shape
    scratch.held[:] = 0
    scratch.blocked[:] = 0
    scratch.left[:] = 1.0
    best, value = 1.0 + ROUNDING, 0.0
    outcome[SPENT] = 0.0
    n, found, position, down = 0, 0, 0, True
    code = EXACT
    while True:
        if down:
            outcome[SPENT] += kinds * scales
            enough = best > goal and 8.0 * outcome[SPENT] > work
            if enough or outcome[SPENT] > work or outcome[HALT] != 0.0:
                code = CUT_OFF
            down = code == EXACT and not _bounded(profit, order, position, value, best, sets, scratch)
        taken = False
        while down and position < kinds and not taken:
            kind = order[1, position]
            taken = _may_join(kind, n, most_checked, limit, sets, memory, scratch, relations, outcome)
            outcome[SPENT] += scales
            position += 0 if taken else 1
        if taken:
            _take(kind, n, 1, sets, scratch)
            n += 1
            value += profit[kind]
            if value > best:
                best = value
                columns[found % columns.shape[0]] = scratch.held
                found += 1
            continue
        if n == 0:
            outcome[FOUND], outcome[WORTH] = found, best
            return code
        n -= 1
        kind = scratch.chosen[n]
        _take(kind, n, -1, sets, scratch)
        value -= profit[kind]
        position, down = order[0, kind] + 1, True
