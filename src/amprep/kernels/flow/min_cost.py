"""Min-cost flow kernels: shortest augmenting paths on the implicit grid under potentials.

Strategy: primal-dual. The potential of a state is its distance to the plate in the residual network, so an
arc's reduced cost ``cost + potential[end] - potential[state]`` is never negative, and paths over arcs of
reduced cost 0 are shortest. A round of depth-first searches finds as many as it can; then a search in buckets
(Dial) from what is left finds how much further away the nearest exit has become, and raises the potentials of
just the states it has been to: time grows with the jam, not with the grid. Potentials are looked at before
anything else, because they rule out most arcs; the arcs are those of `flow_network`, written out.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Bytes, Int32s, Int64s
from amprep.kernels.flow.residual import Carried, Room, shift
from amprep.kernels.flow.shortest_paths import Network
from amprep.kernels.helper import helper

Potentials = NDArray[np.int16] | NDArray[np.int32]

NO_EXIT = -1
"""Answer of `search` when no exit can be reached."""

TOO_FAR = -2
"""Answer of `search` when it needs more buckets or entries; nothing but labels has been changed."""

NO_ARC = 9
"""Stands for the arc by which a search came to where it started."""

TOO_HIGH = -3
"""Answer of `search` when potentials would no longer fit their type; nothing but labels has been changed."""

TAKEN = 2
"""Of an exit: units come into it, although perhaps none goes through its square."""

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
        ``(squares,)`` uint8, 1 where a path may end once it has come in, `TAKEN` where one has.
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
        ``(states,)`` number of the round of augmenting that last saw a state, or what a search has found its
        distance to be, plus the number that the search started from: all that is less is out of date.
    stack, done
        ``(states,)`` states to go on from, and those that are done with.
    arc
        ``(states,)`` next arcs of what is on the stack, or the arcs by which a search came to each state.
    heads, entry, below
        Buckets as stacks: the last entry of each, and of each entry the state and the entry below it.
    """

    seen: Potentials
    stack: Int32s
    arc: Bytes
    done: Int32s
    heads: Int32s
    entry: Int32s
    below: Int32s


@njit(cache=True)
def augment(
    network: Network,
    carried: Carried,
    room: Room,
    prices: Prices,
    potential: Potentials,
    exits: Exits,
    starts: Int64s,
    ends: Int64s,
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
    flow, through, edge_room, square_room = carried.flow, carried.through, room.edge, room.square
    via, offset, stride, top, ending = (
        network.via,
        network.offset,
        network.stride,
        network.via.size,
        exits.open,
    )
    straight, oblique, each = prices.straight, prices.oblique, room.each
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
            u, level, k, to = s >> 1, potential[s], arcs[length], -1
            if s & 1:
                while k < 5 and to < 0:
                    v = u - stride + offset[k]
                    cost = straight if k == 0 else oblique
                    tight = potential[2 * v] + cost == level and seen[2 * v] != number and via[v]
                    if tight and flow[u, k] < edge_room[(5 * u + k) * each]:
                        to = 2 * v
                        break
                    k += 1
                if k == 5 and potential[s - 1] == level and seen[s - 1] != number and through[u] > 0:
                    to = s - 1
            else:
                if level == exits.level and ending[u] == 1:
                    break
                if k == 0:
                    tight = u >= stride and potential[s + 1] == level and seen[s + 1] != number
                    if tight and through[u] < square_room[u * each]:
                        to = s + 1
                    k += to < 0
                if k > 0 and (through[u] > 0 or ending[u] == TAKEN):
                    while k < 6 and to < 0:
                        direction = k if k < 5 else 0
                        w = u + stride - offset[direction]
                        if w < top and flow[w, direction] > 0:
                            cost = oblique if direction else straight
                            if potential[2 * w + 1] - cost == level and seen[2 * w + 1] != number:
                                to = 2 * w + 1
                                break
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
            exits.open[ends[i]] = TAKEN
        for j in range(length):
            shift(network, carried, stack[j], arcs[j], 1)
        for j in range(length + 1):
            seen[stack[j]] = 0
    return found


@njit(cache=True)
def _take_back_to(network: Network, carried: Carried, state: int, arc: int) -> int:
    """Send a unit over the arc that a search came to `state` by; return where it came from."""
    u, stride = state >> 1, network.stride
    if state & 1:
        direction = arc if arc < 5 else 0
        origin = 2 * (u - stride + network.offset[direction]) if arc else state - 1
    else:
        origin = state + 1 if arc == 5 else 2 * (u + stride - network.offset[arc]) + 1
    shift(network, carried, origin, arc, 1)
    return origin


@helper
def _raise_potentials(potential: Potentials, seen: Potentials, states: Int32s, to: int, highest: int) -> bool:
    """Raise the potential of each state by what it was seen before `to`; return False if one came too high."""
    for s in states:
        if potential[s] + to - seen[s] > highest:
            return False
    for s in states:
        if seen[s] < to:
            potential[s] += to - seen[s]
            seen[s] = 0
    return True


@njit(cache=True)
def search(
    network: Network,
    carried: Carried,
    room: Room,
    prices: Prices,
    potential: Potentials,
    exits: Exits,
    starts: Int64s,
    lift: int,
    highest_potential: int,
    work: Search,
    base: int,
) -> tuple[int, int]:
    """Send a unit to the nearest exit under reduced costs, and raise potentials by its distance (Dial).

    Buckets are stacks, so that free ways are followed down at once; a state that is found again nearer by
    stays in its old bucket and is passed over there. Without an exit in reach all states that are in reach
    are raised by `lift` beyond the furthest.

    Parameters
    ----------
    highest_potential
        What potentials must not exceed.

    Returns
    -------
    int, int
        The distance, and the square of `starts` that was served, -1 when none was.
    """
    seen, stack, done, heads, came = work.seen, work.stack, work.done, work.heads, work.arc
    entry, below, flow, through = work.entry, work.below, carried.flow, carried.through
    edge_room, square_room, ending = room.edge, room.square, exits.open
    via, offset, stride, top, each = network.via, network.offset, network.stride, network.via.size, room.each
    heads[:] = -1
    highest, settled, bucket, length, count, end = 0, 0, 0, 0, 0, 0
    best, straight, oblique = _UNKNOWN, prices.straight, prices.oblique
    for u in starts:
        seen[2 * u], came[2 * u] = base, NO_ARC
        stack[length] = 2 * u
        length += 1
    while bucket < best:
        if length == 0:
            while bucket <= highest and heads[bucket] < 0:
                bucket += 1
            if bucket > highest:
                break
            i = heads[bucket]
            heads[bucket] = below[i]
            if seen[entry[i]] != base + bucket:
                continue
            stack[0], length = entry[i], 1
        length -= 1
        s = stack[length]
        done[settled] = s
        settled += 1
        if count + 6 > entry.size:
            return TOO_FAR, -1
        u, near = s >> 1, bucket - potential[s]
        inward = not s & 1
        if inward and ending[u] == 1:
            if near + exits.level < best:
                best, end = near + exits.level, s
            if bucket >= best:
                break
        first = 1 if inward and through[u] == 0 and ending[u] != TAKEN else 6
        for k in range(first - 1, -1, -1):
            if inward and k == 0:
                if u < stride or through[u] >= square_room[u * each]:
                    continue
                t = s + 1
                reach = near + potential[t]
            elif inward:
                direction = k if k < 5 else 0
                w = u + stride - offset[direction]
                if w >= top or flow[w, direction] == 0:
                    continue
                t = 2 * w + 1
                reach = near + potential[t] - (oblique if direction else straight)
            elif k == 5:
                if through[u] == 0:
                    continue
                t = s - 1
                reach = near + potential[t]
            else:
                v = u - stride + offset[k]
                t = 2 * v
                reach = near + potential[t] + (oblique if k else straight)
                if reach >= best or base <= seen[t] <= base + reach or not via[v]:
                    continue
                if flow[u, k] >= edge_room[(5 * u + k) * each]:
                    continue
            if reach >= best or base <= seen[t] <= base + reach:
                continue
            if reach >= heads.size:
                return TOO_FAR, -1
            seen[t], came[t] = base + reach, k
            if reach == bucket:
                stack[length] = t
                length += 1
            else:
                highest = max(highest, reach)
                entry[count], below[count], heads[reach] = t, heads[reach], count
                count += 1
    raised = best if best < _UNKNOWN else highest + lift
    if not _raise_potentials(potential, seen, done[:settled], base + raised, highest_potential):
        return TOO_HIGH, -1
    if best == _UNKNOWN:
        return NO_EXIT, -1
    if exits.once:
        ending[end >> 1] = TAKEN
    while came[end] < NO_ARC:
        end = _take_back_to(network, carried, end, came[end])
    return best, end >> 1
