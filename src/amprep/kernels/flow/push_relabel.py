"""Push-relabel kernels: excess and labels on the implicit grid (Goldberg and Tarjan, 10.1145/48014.61051).

Strategy: every way down takes two arcs a plane, so the label of a state is its least number of arcs to the
plate plus twice a level: the number of times a path from there has to go back up. Levels start at 0, nothing
is set for squares that the flow never jams, and a push is admissible down to a state of the same level or up
to one of the level below. What the plate cannot take goes back up to the red squares plane by plane.
"""

from typing import NamedTuple

from numba import njit

from amprep.arrays import Bytes, Int32s, Int64s
from amprep.kernels.flow.residual import Carried, Room
from amprep.kernels.flow.shortest_paths import Network

CUT_OFF = 1 << 29
"""Level of a state from which the plate is out of reach."""


class Preflow(NamedTuple):
    """Excess, level and next arc to look at of all states; modified in place.

    Attributes
    ----------
    counts
        Number of states at each level from 1 to the number of states.
    raised
        The states at these levels, the first `Discharging.raised` entries.
    heads, below
        Active states in stacks by level: the top of each stack and what is below each state, 0 for none.
    """

    excess: Int32s
    level: Int32s
    arc: Bytes
    counts: Int32s
    raised: Int32s
    heads: Int32s
    below: Int32s


class Discharging(NamedTuple):
    """Numbers that move along, each ``(1,)``: range of the stacks in use, length of the list of `raised`."""

    lowest: Int64s
    highest: Int64s
    raised: Int64s


@njit(cache=True)
def _activate(preflow: Preflow, discharging: Discharging, state: int) -> None:
    """Put a state on the stack of its level."""
    level = preflow.level[state]
    preflow.below[state] = preflow.heads[level]
    preflow.heads[level] = state
    discharging.lowest[0] = min(discharging.lowest[0], level)
    discharging.highest[0] = max(discharging.highest[0], level)


@njit(cache=True)
def activate_all(preflow: Preflow, discharging: Discharging, starts: Int64s) -> None:
    """Give each start a unit to push."""
    for u in starts:
        preflow.excess[2 * u] = 1
        _activate(preflow, discharging, 2 * u)


@njit(cache=True)
def _cut_off(preflow: Preflow, discharging: Discharging, gap: int) -> None:
    """Cut off all states above an empty level, and keep the others in the list of raised ones."""
    kept = 0
    for i in range(discharging.raised[0]):
        s = preflow.raised[i]
        if preflow.level[s] <= gap:
            preflow.raised[kept] = s
            kept += 1
        elif preflow.level[s] < CUT_OFF:
            preflow.counts[preflow.level[s]] -= 1
            preflow.level[s] = CUT_OFF
    discharging.raised[0] = kept


@njit(cache=True)
def discharge(
    network: Network, carried: Carried, room: Room, preflow: Preflow, discharging: Discharging, effort: int
) -> bool:
    """Push excess on until no active state is left or the effort is used up; return whether none is left.

    States of the lowest level come first: flow that runs down freely shows the others what is left. One that
    runs out of arcs is lifted to the least level from which it can push; when that leaves a level empty (a
    gap), all states above it are cut off. Of several ways the straight one is increased first and decreased
    last (thesis 3.3): see the order of arcs.
    """
    excess, level, arcs = preflow.excess, preflow.level, preflow.arc
    heads, waiting = preflow.heads, preflow.below
    counts, raised, flow, through = preflow.counts, preflow.raised, carried.flow, carried.through
    square_room, edge_room, each, via, offset = room.square, room.edge, room.each, network.via, network.offset
    stride, top, lowest, highest = network.stride, via.size, discharging.lowest[0], discharging.highest[0]
    while lowest <= highest and effort > 0:
        s = heads[lowest]
        if s == 0:
            lowest += 1
            continue
        heads[lowest] = waiting[s]
        u, k, here = s >> 1, arcs[s], level[s]
        while excess[s] > 0 and here < CUT_OFF:
            if k == 6:
                least = CUT_OFF
                if s & 1:
                    for d in range(5):
                        v = u - stride + offset[d]
                        if level[2 * v] < least and via[v] and flow[u, d] < edge_room[(5 * u + d) * each]:
                            least = level[2 * v]
                    if through[u] > 0:
                        least = min(least, level[s - 1] + 1)
                else:
                    if u >= stride and through[u] < square_room[u * each]:
                        least = level[s + 1]
                    for d in range(5):
                        w = u + stride - offset[d]
                        if w < top and level[2 * w + 1] + 1 < least and flow[w, d] > 0:
                            least = level[2 * w + 1] + 1
                least = least if least < counts.size else CUT_OFF
                level[s] = least
                if least < CUT_OFF:
                    counts[least] += 1
                    if here == 0:
                        raised[discharging.raised[0]] = s
                        discharging.raised[0] += 1
                if here > 0:
                    counts[here] -= 1
                    if counts[here] == 0:
                        _cut_off(preflow, discharging, here)
                k, here = 0, level[s]
                effort -= 12
                continue
            effort -= 1
            up, space = 0, 0
            if s & 1 and k < 5:
                t = 2 * (u - stride + offset[k])
                if level[t] == here and via[t >> 1]:
                    space = edge_room[(5 * u + k) * each] - flow[u, k]
            elif s & 1:
                t, up = s - 1, 1
                if level[t] + 1 == here:
                    space = through[u]
            elif k == 0:
                t = s + 1
                if level[t] == here and u >= stride:
                    space = square_room[u * each] - through[u]
            else:
                d, up = k if k < 5 else 0, 1
                w = u + stride - offset[d]
                t = 2 * w + 1
                if w < top and level[t] + 1 == here:
                    space = flow[w, d]
            if space <= 0:
                k += 1
                continue
            amount = min(excess[s], space)
            if s & 1 and k < 5:
                flow[u, k] += amount
            elif s & 1:
                through[u] -= amount
            elif k == 0:
                through[u] += amount
            else:
                flow[t >> 1, k if k < 5 else 0] -= amount
            excess[s] -= amount
            if excess[t] == 0 and t >= 2 * stride:
                waiting[t] = heads[here - up]
                heads[here - up] = t
                lowest, highest = min(lowest, here - up), max(highest, here - up)
            excess[t] += amount
        arcs[s] = k
    discharging.lowest[0], discharging.highest[0] = lowest, highest
    return bool(discharging.lowest[0] > discharging.highest[0])


@njit(cache=True)
def _find_free(
    network: Network, carried: Carried, room: Room, preflow: Preflow, now: Int32s, waiting: Int32s
) -> tuple[int, int]:
    """Set the level of all states to 0 where a way down is free, and cut off all others for now.

    Lists in `now` the free states that a path can be sent back to, in `waiting` all states with excess, and
    returns how many there are of each.
    """
    stride, width, box, level = network.stride, network.width, network.box, preflow.level
    via, offset, excess, arcs, flow, through = (
        network.via,
        network.offset,
        preflow.excess,
        preflow.arc,
        carried.flow,
        carried.through,
    )
    square_room, edge_room, each = room.square, room.edge, room.each
    seeds, active = 0, 0
    for p in range(1, box.shape[0]):
        for y in range(box[p, 0], box[p, 1] + 1):
            for u in range(p * stride + y * width + box[p, 2], p * stride + y * width + box[p, 3] + 1):
                used = through[u] > 0 or excess[2 * u] > 0
                if not used and not via[u]:
                    level[2 * u] = level[2 * u + 1] = CUT_OFF
                    continue
                free = False
                for d in range(5):
                    v = u - stride + offset[d]
                    limit = edge_room[(5 * u + d) * each]
                    if via[v] and level[2 * v] == 0 and flow[u, d] < limit:
                        free = True
                        break
                enter = free and through[u] < square_room[u * each]
                level[2 * u] = 0 if enter else CUT_OFF
                level[2 * u + 1] = 0 if free else CUT_OFF
                arcs[2 * u] = arcs[2 * u + 1] = 0
                if used:
                    for s in (2 * u, 2 * u + 1):
                        if level[s] == 0:
                            now[seeds] = s
                            seeds += 1
                        if excess[s] > 0:
                            waiting[active] = s
                            active += 1
    return seeds, active


@njit(cache=True)
def relabel_all(
    network: Network,
    carried: Carried,
    room: Room,
    preflow: Preflow,
    discharging: Discharging,
    now: Int32s,
    later: Int32s,
    waiting: Int32s,
) -> None:
    """Set all levels to what they are at least (global relabelling), and stack the active states anew."""
    level, raised, flow, through = preflow.level, preflow.raised, carried.flow, carried.through
    via, offset, stride, top = network.via, network.offset, network.stride, network.via.size
    counts = preflow.counts
    square_room, edge_room, each = room.square, room.edge, room.each
    for i in range(discharging.raised[0]):
        if level[raised[i]] < CUT_OFF:
            preflow.counts[level[raised[i]]] = 0
    preflow.heads[: discharging.highest[0] + 1] = 0
    discharging.lowest[0] = discharging.highest[0] = discharging.raised[0] = 0
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
                counts[depth] += 1
            u = t >> 1
            if t & 1:
                if level[t - 1] > depth and through[u] < square_room[u * each]:
                    level[t - 1] = depth
                    now[length] = t - 1
                    length += 1
                if through[u] > 0:
                    for d in range(5):
                        v = u - stride + offset[d]
                        if level[2 * v] > depth + 1 and flow[u, d] > 0 and v >= stride:
                            level[2 * v] = depth + 1
                            later[ahead] = 2 * v
                            ahead += 1
                continue
            if level[t + 1] > depth + 1 and through[u] > 0:
                level[t + 1] = depth + 1
                later[ahead] = t + 1
                ahead += 1
            if via[u]:
                for d in range(5):
                    w = u + stride - offset[d]
                    if w < top and level[2 * w + 1] > depth and flow[w, d] < edge_room[(5 * w + d) * each]:
                        level[2 * w + 1] = depth
                        now[length] = 2 * w + 1
                        length += 1
        depth += 1
        for i in range(ahead):
            if level[later[i]] == depth:
                now[length] = later[i]
                length += 1
    discharging.raised[0] = count
    for i in range(active):
        if level[waiting[i]] < CUT_OFF:
            _activate(preflow, discharging, waiting[i])


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
