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
    """Work arrays over all states; `stamp` starts at 0, each search has a number of its own."""

    stamp: Ints
    label: Ints
    stack: Ints
    arc: Bytes
    done: Ints
    above: Ints
    below: Ints


@njit(cache=True)
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
    stamp, stack, arcs = work.stamp, work.stack, work.arc
    found = 0
    for i in range(starts.size):
        ends[i] = -1
        length = 0
        stack[0] = 2 * starts[i]
        if stamp[stack[0]] == number:
            continue
        stamp[stack[0]] = number
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
                if space > 0 and stamp[t] != number and _reduced(prices, potential, s, t, direction) == 0:
                    to = t
                else:
                    k += 1
            arcs[length] = k
            if to < 0:
                length -= 1
            else:
                length += 1
                stack[length], arcs[length], stamp[to] = to, 0, number
        if length < 0:
            continue
        found += 1
        ends[i] = stack[length] >> 1
        if exits.once:
            exits.open[ends[i]] = 0
        for j in range(length):
            shift(network, carried, stack[j], arcs[j], 1)
        for j in range(length + 1):
            stamp[stack[j]] = 0
    return found


@njit(cache=True)
def _unlink(heads: Ints, work: Search, state: int) -> None:
    """Take a state out of its bucket."""
    above, below = work.above[state], work.below[state]
    if above >= 0:
        work.below[above] = below
    else:
        heads[work.label[state]] = below
    if below >= 0:
        work.above[below] = above


@njit(cache=True)
def _link(heads: Ints, work: Search, state: int, label: int) -> None:
    """Put a state on top of the bucket of its label."""
    work.label[state] = label
    work.above[state] = -1
    work.below[state] = heads[label]
    if heads[label] >= 0:
        work.above[heads[label]] = state
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
    stamp, label, stack, done = work.stamp, work.label, work.stack, work.done
    heads[:] = -1
    highest, count, bucket, length = 0, 0, 0, 0
    best = _UNKNOWN
    for u in starts:
        stamp[2 * u] = number
        _link(heads, work, 2 * u, 0)
    while bucket <= highest and bucket < best:
        if length == 0:
            s = heads[bucket]
            if s < 0:
                bucket += 1
                continue
            _unlink(heads, work, s)
            stack[0], length = s, 1
            stamp[s] = -number
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
            if space <= 0 or stamp[t] == -number:
                continue
            reach = bucket + _reduced(prices, potential, s, t, direction)
            if reach >= best or (stamp[t] == number and label[t] <= reach):
                continue
            if reach >= heads.size:
                return TOO_FAR
            if stamp[t] == number:
                _unlink(heads, work, t)
            if reach == bucket:
                stamp[t], label[t], stack[length] = -number, reach, t
                length += 1
            else:
                stamp[t] = number
                _link(heads, work, t, reach)
                highest = max(highest, reach)
    raised = best if best < _UNKNOWN else highest + lift
    for i in range(count):
        s = done[i]
        if label[s] < raised:
            potential[s] += raised - label[s]
    return best if best < _UNKNOWN else NO_EXIT
