"""Min-cost flow kernels: shortest augmenting paths on the implicit grid under potentials.

Strategy: primal-dual. The potential of a state is its distance to the plate in the residual network, so an
arc's reduced cost ``cost + potential[end] - potential[state]`` is never negative, and paths over arcs of
reduced cost 0 are shortest. A round of depth-first searches finds as many as it can; then a search in buckets
(Dial) from what is left finds how much further away the nearest exit has become, and raises the potentials of
just the states it has been to: time grows with the jam, not with the grid.
"""

from typing import NamedTuple

from numba import njit

from amprep.kernels.flow_network import Carried, Room, residual, shift
from amprep.kernels.routing import Bytes, Ints, Longs, Network

NO_EXIT = -1
"""Answer of `search` when no exit can be reached."""

TOO_FAR = -2
"""Answer of `search` when it needs more buckets; nothing has been changed."""


_UNKNOWN = 1 << 40


class Prices(NamedTuple):
    """Cost of a unit over a straight and over an oblique edge."""

    straight: int
    oblique: int


class Exits(NamedTuple):
    """Where paths may end.

    Attributes
    ----------
    open
        ``(squares,)`` uint8, 1 where a path may end once it has come in.
    level
        Least potential an exit has to be at for ending there to be free; below, the difference is its cost.
    once
        Whether only one path may end at each.
    """

    open: Bytes
    level: int
    once: bool


class Search(NamedTuple):
    """Work arrays over all states.

    Attributes
    ----------
    seen
        ``(states,)`` number of the round of augmenting that last saw a state, 0 at first.
    mark
        ``(states, 4)``: number of the search that last saw a state (0 at first), label, and its neighbours
        above and below in a bucket; side by side because they are needed together.
    """

    seen: Ints
    mark: Ints
    stack: Ints
    arc: Bytes
    done: Ints


@njit(cache=True, inline="always")
def _reduced(prices: Prices, potential: Ints, state: int, to: int, direction: int) -> int:
    """Return the reduced cost of an arc; flow taken back pays back."""
    gap: int = potential[to] - potential[state]
    if direction < 0:
        return gap
    cost = prices.straight if direction == 0 else prices.oblique
    return gap + (cost if state & 1 else -cost)


@njit(cache=True)
def augment(
    network: Network,
    carried: Carried,
    room: Room,
    prices: Prices,
    potential: Ints,
    exits: Exits,
    starts: Longs,
    ends: Longs,
    work: Search,
    number: int,
) -> int:
    """Send a unit from each square of `starts` that finds a shortest way; return how many do.

    States that a search leaves without success stay closed to the rest of the round.

    Parameters
    ----------
    ends
        Set to the square where the path from each start ends, -1 for none.
    """
    seen, stack, arcs = work.seen, work.stack, work.arc
    found = 0
    for i in range(starts.size):
        ends[i] = -1
        length = 0
        stack[0] = 2 * starts[i]
        if seen[stack[0]] == number:
            continue
        seen[stack[0]] = number
        arcs[0] = 0
        while length >= 0:
            s = stack[length]
            if not s & 1 and exits.open[s >> 1] and potential[s] == exits.level:
                break
            k = arcs[length]
            last = 1 if not s & 1 and carried.through[s >> 1] == 0 else 6
            to = -1
            while k < last and to < 0:
                t, space, direction = residual(network, carried, room, s, k)
                if space > 0 and seen[t] != number and _reduced(prices, potential, s, t, direction) == 0:
                    to = t
                else:
                    k += 1
            arcs[length] = k
            if to < 0:
                length -= 1
            else:
                length += 1
                stack[length], arcs[length], seen[to] = to, 0, number
        if length < 0:
            continue
        found += 1
        ends[i] = stack[length] >> 1
        if exits.once:
            exits.open[ends[i]] = 0
        for j in range(length):
            shift(network, carried, stack[j], arcs[j], 1)
        for j in range(length + 1):
            seen[stack[j]] = 0
    return found


@njit(cache=True, inline="always")
def _unlink(heads: Ints, mark: Ints, state: int) -> None:
    """Take a state out of its bucket."""
    above, below = mark[state, 2], mark[state, 3]
    if above >= 0:
        mark[above, 3] = below
    else:
        heads[mark[state, 1]] = below
    if below >= 0:
        mark[below, 2] = above


@njit(cache=True, inline="always")
def _link(heads: Ints, mark: Ints, state: int, label: int) -> None:
    """Put a state on top of the bucket of its label."""
    mark[state, 1] = label
    mark[state, 2] = -1
    mark[state, 3] = heads[label]
    if heads[label] >= 0:
        mark[heads[label], 2] = state
    heads[label] = state


@njit(cache=True)
def search(
    network: Network,
    carried: Carried,
    room: Room,
    prices: Prices,
    potential: Ints,
    exits: Exits,
    starts: Longs,
    heads: Ints,
    lift: int,
    work: Search,
    number: int,
) -> int:
    """Find the distance of the nearest exit under reduced costs, and raise potentials by it (Dial).

    Buckets are stacks, so that free ways are followed down at once. Without an exit in reach all states that
    are in reach are raised by `lift` beyond the furthest.

    Parameters
    ----------
    heads
        Work array: one entry for each distance that a bucket is wanted for.
    """
    mark, stack, done = work.mark, work.stack, work.done
    heads[:] = -1
    highest, count, bucket, length = 0, 0, 0, 0
    best = _UNKNOWN
    for u in starts:
        mark[2 * u, 0] = number
        _link(heads, mark, 2 * u, 0)
    while bucket <= highest and bucket < best:
        if length == 0:
            s = heads[bucket]
            if s < 0:
                bucket += 1
                continue
            _unlink(heads, mark, s)
            stack[0], length = s, 1
            mark[s, 0] = -number
        length -= 1
        s = stack[length]
        done[count] = s
        count += 1
        if not s & 1 and exits.open[s >> 1]:
            best = min(best, bucket + exits.level - potential[s])
            if bucket >= best:
                break
        for k in range(0 if not s & 1 and carried.through[s >> 1] == 0 else 5, -1, -1):
            t, space, direction = residual(network, carried, room, s, k)
            if space <= 0 or mark[t, 0] == -number:
                continue
            reach = bucket + _reduced(prices, potential, s, t, direction)
            if reach >= best or (mark[t, 0] == number and mark[t, 1] <= reach):
                continue
            if reach >= heads.size:
                return TOO_FAR
            if mark[t, 0] == number:
                _unlink(heads, mark, t)
            if reach == bucket:
                mark[t, 0], mark[t, 1], stack[length] = -number, reach, t
                length += 1
            else:
                mark[t, 0] = number
                _link(heads, mark, t, reach)
                highest = max(highest, reach)
    raised = best if best < _UNKNOWN else highest + lift
    for i in range(count):
        s = done[i]
        if mark[s, 1] < raised:
            potential[s] += raised - mark[s, 1]
    return best if best < _UNKNOWN else NO_EXIT
