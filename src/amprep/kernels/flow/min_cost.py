"""Min-cost flow kernels: augmentation along shortest paths in the residual network, under potentials.

Strategy: primal-dual (Ford and Fulkerson 1962). The potential of a state is its distance to the plate in the
residual network, so an arc's reduced cost ``cost + potential[head] - potential[state]`` is never negative, and
paths over admissible arcs, whose reduced cost is 0, are shortest. A round of depth-first searches over admissible
arcs sends as many units as it can. Then a search with buckets (Dial 1969, DOI 10.1145/363269.363610) from the
starts that are left measures the increase of the distance to the nearest exit, and raises the potentials of only
the states that it has visited: time grows with the congested region, not with the grid. Kernels compare potentials
before capacities, because potentials rule out most arcs.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bytes, Int32s, Int64s
from amprep.kernels.flow.records import ResidualNetwork
from amprep.kernels.flow.residual import ARCS, head_of, residual_capacity, reverse_of, send
from amprep.kernels.helper import inlined, kernel

Potentials = NDArray[np.int16] | NDArray[np.int32]

NO_EXIT = -1
"""Result of `search_nearest_exit` if no exit can be reached."""

TOO_FAR = -2
"""Result of `search_nearest_exit` if it needs more buckets or entries; only labels have changed."""

TOO_HIGH = -3
"""Result of `search_nearest_exit` if potentials would no longer fit their type; only labels have changed."""

TAKEN = 2
"""State of an exit that receives flow, even if none passes through its square."""

_NO_ARC = 9
"""Entry for the arc by which a search arrived at a start, which has none."""

_UNKNOWN = 1 << 40


class EdgeCosts(NamedTuple):
    """Cost of one unit over a vertical and over an oblique edge."""

    vertical: int
    oblique: int


class Exits(NamedTuple):
    """Squares at which paths may end.

    Attributes
    ----------
    state
        ``(squares,)`` uint8, 1 where a path may end after it has arrived, `TAKEN` where one has ended.
    level
        Potential at which ending is free; at a lower potential the difference is the cost of ending.
    once
        Whether only one path may end at each.
    """

    state: Bytes
    level: int
    once: bool


class SearchArrays(NamedTuple):
    """Work arrays over all states.

    Attributes
    ----------
    seen
        ``(states,)`` number of the round that last saw a state, or the distance that a search has found plus
        the number that the search started from; smaller entries are out of date.
    stack, visited
        ``(states,)`` states to continue from, and states that a search has finished.
    arc
        ``(states,)`` next arcs of the states on the stack, or the arc by which a search arrived at each state.
    bucket, entry, below
        Buckets as stacks: the last entry of each bucket; for each entry its state and the entry below it.
    """

    seen: Potentials
    stack: Int32s
    arc: Bytes
    visited: Int32s
    bucket: Int32s
    entry: Int32s
    below: Int32s


@inlined
def _cost_of(costs: EdgeCosts, state: int, arc: int) -> int:
    """Return the cost of one unit over an arc: negative if the arc undoes flow."""
    if state & 1:
        return 0 if arc == 5 else costs.vertical if arc == 0 else costs.oblique
    return 0 if arc == 0 else -costs.vertical if arc == 5 else -costs.oblique


@inlined
def _arc_count(residual: ResidualNetwork, exits: Exits, state: int) -> int:
    """Return the number of arcs of a state to try: an in state without flow has no arcs back up."""
    unused = residual.flow.square[state >> 1] == 0 and exits.state[state >> 1] != TAKEN
    return 1 if not state & 1 and unused else ARCS


@inlined
def _next_admissible(
    residual: ResidualNetwork,
    costs: EdgeCosts,
    potential: Potentials,
    seen: Potentials,
    number: int,
    state: int,
    first: int,
    end: int,
) -> int:
    """Return the first admissible arc from `first` to `end` of a state to a state not seen yet, or `end`."""
    for k in range(first, end):
        t = head_of(residual.network, state, k)
        if t < 0 or potential[t] + _cost_of(costs, state, k) != potential[state] or seen[t] == number:
            continue
        if residual_capacity(residual, state, k, t) > 0:
            return k
    return end


@kernel
def augment_shortest(
    residual: ResidualNetwork,
    costs: EdgeCosts,
    potential: Potentials,
    exits: Exits,
    starts: Int64s,
    ends: Int64s,
    work: SearchArrays,
    number: int,
) -> int:
    """Send a unit along a shortest path from each square of `starts` for which one is found; return their number.

    States that a search leaves without success stay closed for the rest of the round.

    Parameters
    ----------
    starts
        ``(n,)`` squares.
    ends
        ``(n,)``, set to the square at which the path from each start ends, -1 for none.
    number
        Number of this round in ``work.seen``.
    """
    seen, stack, arcs, found = work.seen, work.stack, work.arc, 0
    for i in range(starts.size):
        ends[i] = -1
        length = 0
        stack[0], arcs[0] = 2 * starts[i], 0
        if seen[stack[0]] == number:
            continue
        seen[stack[0]] = number
        while length >= 0:
            s, k, count = stack[length], arcs[length], ARCS
            if s & 1:  # each inlined copy has only the arcs of its kind of state
                k = _next_admissible(residual, costs, potential, seen, number, s | 1, k, ARCS)
            else:
                if potential[s] == exits.level and exits.state[s >> 1] == 1:
                    break
                count = _arc_count(residual, exits, s)
                k = _next_admissible(residual, costs, potential, seen, number, s & ~1, k, count)
            arcs[length] = k
            if k >= count:
                length -= 1
            else:
                length += 1
                stack[length], arcs[length] = head_of(residual.network, s, k), 0
                seen[stack[length]] = number
        if length < 0:
            continue
        found += 1
        ends[i] = stack[length] >> 1
        if exits.once:
            exits.state[ends[i]] = TAKEN
        for j in range(length):
            send(residual, stack[j], arcs[j], stack[j + 1], 1)
        for j in range(length + 1):
            seen[stack[j]] = 0
    return found


@inlined
def _raise_potentials(potential: Potentials, seen: Potentials, states: Int32s, to: int, highest: int) -> bool:
    """Raise the potential of each state by ``to - seen[state]``, if positive; return False if one exceeds `highest`."""
    for s in states:
        if potential[s] + to - seen[s] > highest:
            return False
    for s in states:
        if seen[s] < to:
            potential[s] += to - seen[s]
            seen[s] = 0
    return True


@inlined
def _send_back_along(residual: ResidualNetwork, arrived_by: Bytes, end: int) -> int:
    """Send a unit along the path by which a search arrived at state `end`; return the state where it starts."""
    while arrived_by[end] != _NO_ARC:
        arc = arrived_by[end]
        tail = head_of(residual.network, end, reverse_of(arc))
        send(residual, tail, arc, end, 1)
        end = tail
    return end


@inlined
def _relax(
    residual: ResidualNetwork,
    costs: EdgeCosts,
    potential: Potentials,
    work: SearchArrays,
    state: int,
    arcs: int,
    bounds: tuple[int, int, int],
    at: tuple[int, int, int],
) -> tuple[int, int, int]:
    """Relax the first `arcs` arcs of a state: label nearer heads, and put them on the stack or in a bucket.

    Parameters
    ----------
    bounds
        Distance of the state, number of the search, and distance of the nearest exit so far.
    at
        Length of the stack, number of entries, and highest bucket in use.

    Returns
    -------
    int, int, int
        As `at`; -1, -1, -1 if there are not enough buckets.
    """
    near, base, best = bounds
    length, count, highest = at
    offset = near - potential[state]
    for k in range(arcs - 1, -1, -1):
        t = head_of(residual.network, state, k)
        if t < 0:
            continue
        reach = offset + potential[t] + _cost_of(costs, state, k)
        if reach >= best or base <= work.seen[t] <= base + reach:
            continue
        if residual_capacity(residual, state, k, t) <= 0:
            continue
        if reach >= work.bucket.size:
            return -1, -1, -1
        work.seen[t], work.arc[t] = base + reach, k
        if reach == near:
            work.stack[length] = t
            length += 1
        else:
            highest = max(highest, reach)
            work.entry[count], work.below[count], work.bucket[reach] = t, work.bucket[reach], count
            count += 1
    return length, count, highest


@kernel
def search_nearest_exit(
    residual: ResidualNetwork,
    costs: EdgeCosts,
    potential: Potentials,
    exits: Exits,
    starts: Int64s,
    lift: int,
    highest_potential: int,
    work: SearchArrays,
    base: int,
) -> tuple[int, int]:
    """Send a unit to the nearest exit under reduced costs, and raise potentials by its distance (Dial 1969).

    Buckets are stacks, so free paths are followed down at once. A state that is found again at a smaller distance
    stays in its old bucket too, and is passed over there. If no exit can be reached, all states that can be
    reached are raised by `lift` beyond the furthest of them.

    Parameters
    ----------
    starts
        ``(n,)`` squares.
    highest_potential
        Bound on potentials.
    base
        Number of this search in ``work.seen``.

    Returns
    -------
    int, int
        The distance, or `NO_EXIT`, `TOO_FAR`, `TOO_HIGH`; the square of `starts` that was served, -1 for none.
    """
    seen, stack, visited, bucket, came = work.seen, work.stack, work.visited, work.bucket, work.arc
    entry, below = work.entry, work.below
    bucket[:] = -1
    highest, finished, near, length, count, end, best = 0, 0, 0, 0, 0, 0, _UNKNOWN
    for u in starts:
        seen[2 * u], came[2 * u] = base, _NO_ARC
        stack[length] = 2 * u
        length += 1
    while near < best:
        if length == 0:
            while near <= highest and bucket[near] < 0:
                near += 1
            if near > highest:
                break
            i = bucket[near]
            bucket[near] = below[i]
            if seen[entry[i]] != base + near:
                continue
            stack[0], length = entry[i], 1
        length -= 1
        s = stack[length]
        visited[finished] = s
        finished += 1
        if count + ARCS > entry.size:
            return TOO_FAR, -1
        if not s & 1 and exits.state[s >> 1] == 1:
            reach = near - potential[s] + exits.level
            if reach < best:
                best, end = reach, s
            if near >= best:
                break
        at = (length, count, highest)
        if s & 1:  # each inlined copy has only the arcs of its kind of state
            length, count, highest = _relax(
                residual, costs, potential, work, s | 1, ARCS, (near, base, best), at
            )
        else:
            arcs = _arc_count(residual, exits, s)
            length, count, highest = _relax(
                residual, costs, potential, work, s & ~1, arcs, (near, base, best), at
            )
        if length < 0:
            return TOO_FAR, -1
    raised = best if best < _UNKNOWN else highest + lift
    if not _raise_potentials(potential, seen, visited[:finished], base + raised, highest_potential):
        return TOO_HIGH, -1
    if best == _UNKNOWN:
        return NO_EXIT, -1
    if exits.once:
        exits.state[end >> 1] = TAKEN
    return best, _send_back_along(residual, came, end) >> 1
