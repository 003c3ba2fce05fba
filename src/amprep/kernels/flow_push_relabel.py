"""Push-relabel kernels: excess and labels on the implicit grid (Goldberg and Tarjan, 10.1145/48014.61051).

Strategy: every way down takes two arcs a plane, so the label of a state is its least number of arcs to the
plate plus twice a level: the number of times a path from there has to go back up. Levels start at 0, nothing
is set for squares that the flow never jams, and a push is admissible down to a state of the same level or up
to one of the level below. What the plate cannot take goes back up to the red squares plane by plane.
"""

from typing import NamedTuple

from numba import njit

from amprep.kernels.flow_network import Carried, Room, residual, shift
from amprep.kernels.routing import Bytes, Ints, Longs, Network

CUT_OFF = 1 << 29
"""Level of a state from which the plate is out of reach."""


class Preflow(NamedTuple):
    """Excess, level and next arc to look at of all states; modified in place.

    Attributes
    ----------
    counts
        Number of states at each level from 1 to the number of states.
    raised
        The states at these levels, the first `Progress.raised` entries.
    heads, below
        Active states in stacks by level: the top of each stack and what is below each state, 0 for none.
    """

    excess: Ints
    level: Ints
    arc: Bytes
    counts: Ints
    raised: Ints
    heads: Ints
    below: Ints


class Progress(NamedTuple):
    """Numbers that move along, each ``(1,)``: range of the stacks in use, length of the list of `raised`."""

    lowest: Longs
    highest: Longs
    raised: Longs


@njit(cache=True)
def _upward(state: int, arc: int) -> bool:
    """Tell whether an arc takes flow back."""
    return arc == 5 if state & 1 else arc > 0


@njit(cache=True)
def _activate(preflow: Preflow, progress: Progress, state: int) -> None:
    """Put a state on the stack of its level."""
    level = preflow.level[state]
    preflow.below[state] = preflow.heads[level]
    preflow.heads[level] = state
    progress.lowest[0] = min(progress.lowest[0], level)
    progress.highest[0] = max(progress.highest[0], level)


@njit(cache=True)
def activate_all(preflow: Preflow, progress: Progress, starts: Longs) -> None:
    """Give each start a unit to push."""
    for u in starts:
        preflow.excess[2 * u] = 1
        _activate(preflow, progress, 2 * u)


@njit(cache=True)
def _relabel(
    network: Network, carried: Carried, room: Room, preflow: Preflow, progress: Progress, state: int
) -> None:
    """Lift a state to the least level from which it can push.

    When that leaves a level empty (a gap), all states above it are cut off.
    """
    level, counts = preflow.level, preflow.counts
    old, new = level[state], CUT_OFF
    for k in range(6):
        t, space, _ = residual(network, carried, room, state, k)
        if space > 0:
            new = min(new, level[t] + _upward(state, k))
    level[state] = new = new if new < counts.size else CUT_OFF
    preflow.arc[state] = 0
    if new < CUT_OFF:
        counts[new] += 1
        if old == 0:
            preflow.raised[progress.raised[0]] = state
            progress.raised[0] += 1
    if old > 0:
        counts[old] -= 1
        if counts[old] == 0:
            _cut_off(preflow, progress, old)


@njit(cache=True)
def _cut_off(preflow: Preflow, progress: Progress, gap: int) -> None:
    """Cut off all states above an empty level, and keep the others in the list of raised ones."""
    kept = 0
    for i in range(progress.raised[0]):
        s = preflow.raised[i]
        if preflow.level[s] <= gap:
            preflow.raised[kept] = s
            kept += 1
        elif preflow.level[s] < CUT_OFF:
            preflow.counts[preflow.level[s]] -= 1
            preflow.level[s] = CUT_OFF
    progress.raised[0] = kept


@njit(cache=True)
def discharge(
    network: Network, carried: Carried, room: Room, preflow: Preflow, progress: Progress, effort: int
) -> bool:
    """Push excess on until no active state is left or the effort is used up; return whether none is left.

    States of the lowest level come first: flow that runs down freely shows the others what is left. Of
    several ways the straight one is increased first and decreased last (thesis 3.3): see the order of arcs.
    """
    excess, level, arcs, heads = preflow.excess, preflow.level, preflow.arc, preflow.heads
    plate = 2 * network.stride
    while progress.lowest[0] <= progress.highest[0] and effort > 0:
        s = heads[progress.lowest[0]]
        if s == 0:
            progress.lowest[0] += 1
            continue
        heads[progress.lowest[0]] = preflow.below[s]
        while excess[s] > 0 and level[s] < CUT_OFF:
            k = arcs[s]
            if k == 6:
                _relabel(network, carried, room, preflow, progress, s)
                effort -= 12
                continue
            effort -= 1
            t, space, _ = residual(network, carried, room, s, k)
            if space <= 0 or level[t] + _upward(s, k) != level[s]:
                arcs[s] += 1
                continue
            amount = min(excess[s], space)
            shift(network, carried, s, k, amount)
            excess[s] -= amount
            if excess[t] == 0 and t >= plate:
                _activate(preflow, progress, t)
            excess[t] += amount
    return bool(progress.lowest[0] > progress.highest[0])


@njit(cache=True)
def _find_free(
    network: Network, carried: Carried, room: Room, preflow: Preflow, now: Ints, waiting: Ints
) -> tuple[int, int]:
    """Set the level of all states to 0 where a way down is free, and cut off all others for now.

    Lists in `now` the free states that a path can be sent back to, in `waiting` all states with excess, and
    returns how many there are of each.
    """
    stride, width, box, level = network.stride, network.width, network.box, preflow.level
    seeds, active = 0, 0
    for p in range(1, box.shape[0]):
        for y in range(box[p, 0], box[p, 1] + 1):
            for u in range(p * stride + y * width + box[p, 2], p * stride + y * width + box[p, 3] + 1):
                used = carried.through[u] > 0 or preflow.excess[2 * u] > 0
                if not used and not network.via[u]:
                    level[2 * u] = level[2 * u + 1] = CUT_OFF
                    continue
                free = False
                for d in range(5):
                    v = u - stride + network.offset[d]
                    if network.via[v] and level[2 * v] == 0 and carried.flow[u, d] < room.edge:
                        free = True
                        break
                enter = free and carried.through[u] < room.square
                level[2 * u] = 0 if enter else CUT_OFF
                level[2 * u + 1] = 0 if free else CUT_OFF
                preflow.arc[2 * u] = preflow.arc[2 * u + 1] = 0
                if used:
                    for s in (2 * u, 2 * u + 1):
                        if level[s] == 0:
                            now[seeds] = s
                            seeds += 1
                        if preflow.excess[s] > 0:
                            waiting[active] = s
                            active += 1
    return seeds, active


@njit(cache=True)
def _take(level: Ints, state: int, depth: int, batch: Ints, count: int) -> int:
    """Set a state's level and list it, unless it is as low already; return the length of the list."""
    if level[state] > depth:
        level[state] = depth
        batch[count] = state
        count += 1
    return count


@njit(cache=True)
def relabel_all(
    network: Network,
    carried: Carried,
    room: Room,
    preflow: Preflow,
    progress: Progress,
    now: Ints,
    later: Ints,
    waiting: Ints,
) -> None:
    """Set all levels to what they are at least (global relabelling), and stack the active states anew."""
    level, raised, flow, through = preflow.level, preflow.raised, carried.flow, carried.through
    via, offset, stride = network.via, network.offset, network.stride
    for i in range(progress.raised[0]):
        if level[raised[i]] < CUT_OFF:
            preflow.counts[level[raised[i]]] = 0
    preflow.heads[: progress.highest[0] + 1] = 0
    progress.lowest[0] = progress.highest[0] = progress.raised[0] = 0
    length, active = _find_free(network, carried, room, preflow, now, waiting)
    depth, count = 0, 0
    while length > 0:
        ahead = 0
        while length > 0:
            length -= 1
            t = now[length]
            if depth > 0:
                raised[count] = t
                count += 1
                preflow.counts[depth] += 1
            u = t >> 1
            if t & 1:
                if through[u] < room.square:
                    length = _take(level, t - 1, depth, now, length)
                if through[u] > 0:
                    for d in range(5):
                        v = u - stride + offset[d]
                        if flow[u, d] > 0 and v >= stride:
                            ahead = _take(level, 2 * v, depth + 1, later, ahead)
                continue
            if through[u] > 0:
                ahead = _take(level, t + 1, depth + 1, later, ahead)
            for d in range(5 if via[u] else 0):
                w = u + stride - offset[d]
                if w < via.size and flow[w, d] < room.edge:
                    length = _take(level, 2 * w + 1, depth, now, length)
        depth += 1
        for i in range(ahead):
            if level[later[i]] == depth:
                now[length] = later[i]
                length += 1
    progress.raised[0] = count
    for i in range(active):
        if level[waiting[i]] < CUT_OFF:
            _activate(preflow, progress, waiting[i])


@njit(cache=True)
def send_back(network: Network, carried: Carried, preflow: Preflow, supply: Bytes) -> None:
    """Send excess that is left back up to where it came from, sideways edges first.

    Parameters
    ----------
    supply
        ``(squares,)`` uint8, 1 at red squares that sent a unit; set to 0 where it comes back.
    """
    stride, width, box = network.stride, network.width, network.box
    for p in range(1, box.shape[0]):
        for y in range(box[p, 0], box[p, 1] + 1):
            for u in range(p * stride + y * width + box[p, 2], p * stride + y * width + box[p, 3] + 1):
                back = preflow.excess[2 * u + 1]
                carried.through[u] -= back
                back += preflow.excess[2 * u]
                for k in range(1, 6):
                    d = k if k < 5 else 0
                    w = u + stride - network.offset[d]
                    if back > 0 and w < network.via.size:
                        amount = min(back, carried.flow[w, d])
                        carried.flow[w, d] -= amount
                        preflow.excess[2 * w + 1] += amount
                        back -= amount
                if back > 0:
                    supply[u] = 0
