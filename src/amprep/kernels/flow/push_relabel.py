"""Push-relabel kernels for maximum flow (Goldberg and Tarjan 1988, DOI 10.1145/48014.61051).

Strategy: every path down takes two arcs a plane, so the distance label of a state is its least number of arcs to
the plate plus twice a level, and the level is the number of times that a path from the state has to go back up.
Only levels are stored. They start at 0, so nothing is set for squares without congestion. An arc is
admissible if it leads down to a state of the same level, or up to a state of the level below.

Active states are kept in buckets by level, and the lowest level is discharged first: flow that runs down freely
shows the other states which capacity is left. Two heuristics keep the number of relabels small: if a level
becomes empty, all states above that gap are cut off from the plate; and from time to time all levels are set to
their exact values by a search from the states with a free path (global relabelling). Excess that cannot reach
the plate returns to the red squares plane by plane. A full phase takes O(states^2 * sqrt(arcs)) at most; on
support networks the time grows with the congested squares.
"""

from typing import NamedTuple

from amprep.arrays import Bytes, Int32s, Int64s
from amprep.kernels.flow.records import ResidualNetwork
from amprep.kernels.flow.residual import ARCS, head_of, is_backward, residual_capacity, reverse_of, send
from amprep.kernels.helper import inlined, kernel

CUT_OFF = 1 << 29
"""Level of a state from which no residual path leads to the plate."""

_RELABEL_COST = 12
"""Arcs looked at in one relabel operation."""


class PushRelabelState(NamedTuple):
    """Excess, levels, current arcs and buckets of active states; kernels modify all arrays in place.

    Attributes
    ----------
    excess, level
        ``(states,)`` int32, units that have arrived and not been sent on, and level (see above).
    current_arc
        ``(states,)`` uint8, the next arc to try.
    level_count
        ``(states + 1,)`` int32, number of states at each level from 1.
    raised
        ``(states,)`` int32, the states at level 1 or higher: the first `raised_count` entries.
    bucket, below
        ``(states + 1,)`` and ``(states,)`` int32, a stack of active states for each level: its top, and below
        each state the next one; 0 ends a stack.
    lowest, highest, raised_count
        ``(1,)`` int64, range of the levels with active states, and length of `raised`.
    """

    excess: Int32s
    level: Int32s
    current_arc: Bytes
    level_count: Int32s
    raised: Int32s
    bucket: Int32s
    below: Int32s
    lowest: Int64s
    highest: Int64s
    raised_count: Int64s


@inlined
def _put_in_bucket(work: PushRelabelState, state: int) -> None:
    """Add a state with excess to the bucket of its level."""
    level = work.level[state]
    work.below[state] = work.bucket[level]
    work.bucket[level] = state
    work.lowest[0] = min(work.lowest[0], level)
    work.highest[0] = max(work.highest[0], level)


@kernel
def activate(work: PushRelabelState, starts: Int64s) -> None:
    """Give one unit of excess to each square of `starts`."""
    for u in starts:
        work.excess[2 * u] = 1
        _put_in_bucket(work, 2 * u)


@inlined
def _cut_off_above(work: PushRelabelState, gap: int) -> None:
    """Cut off all states above an empty level."""
    kept = 0
    for i in range(work.raised_count[0]):
        s = work.raised[i]
        if work.level[s] <= gap:
            work.raised[kept] = s
            kept += 1
        elif work.level[s] < CUT_OFF:
            work.level_count[work.level[s]] -= 1
            work.level[s] = CUT_OFF
    work.raised_count[0] = kept


@inlined
def _relabel(residual: ResidualNetwork, work: PushRelabelState, state: int) -> None:
    """Raise a state to the least level at which one of its arcs is admissible; use the gap that this may leave."""
    level, old, least = work.level, work.level[state], CUT_OFF
    for k in range(ARCS):
        head = head_of(residual.network, state, k)
        if head >= 0:
            reached = level[head] + is_backward(state, k)
            if reached < least and residual_capacity(residual, state, k, head) > 0:
                least = reached
    if least >= work.level_count.size:
        least = CUT_OFF
    level[state] = least
    if least < CUT_OFF:
        work.level_count[least] += 1
        if old == 0:
            work.raised[work.raised_count[0]] = state
            work.raised_count[0] += 1
    if old > 0:
        work.level_count[old] -= 1
        if work.level_count[old] == 0:
            _cut_off_above(work, old)


@inlined
def _discharge_state(residual: ResidualNetwork, work: PushRelabelState, s: int, effort: int) -> int:
    """Push the excess of a state over admissible arcs, relabel it when all are tried; return the effort left."""
    network, excess, level = residual.network, work.excess, work.level
    bucket, below, plate = work.bucket, work.below, 2 * residual.network.stride
    lowest, highest = work.lowest[0], work.highest[0]
    k, here = work.current_arc[s], level[s]
    while excess[s] > 0 and here < CUT_OFF:
        if k == ARCS:
            _relabel(residual, work, s)
            k, here = 0, level[s]
            effort -= _RELABEL_COST
            continue
        effort -= 1
        t, lower = head_of(network, s, k), here - is_backward(s, k)
        room = 0
        if t >= 0 and level[t] == lower:
            room = residual_capacity(residual, s, k, t)
        if room <= 0:
            k += 1
            continue
        amount = min(excess[s], room)
        send(residual, s, k, t, amount)
        excess[s] -= amount
        if excess[t] == 0 and t >= plate:
            below[t] = bucket[lower]
            bucket[lower] = t
            lowest, highest = min(lowest, lower), max(highest, lower)
        excess[t] += amount
    work.current_arc[s] = k
    work.lowest[0], work.highest[0] = lowest, highest
    return effort


@kernel
def discharge(residual: ResidualNetwork, work: PushRelabelState, effort: int) -> bool:
    """Discharge active states, the lowest level first, until none is left or the effort is used up.

    A state pushes its excess over admissible arcs; when it has tried all of them, it is relabelled.

    Parameters
    ----------
    effort
        Number of arcs that may be looked at.

    Returns
    -------
    bool
        Whether no active state is left.
    """
    bucket, lowest = work.bucket, work.lowest
    while lowest[0] <= work.highest[0] and effort > 0:
        s = bucket[lowest[0]]
        if s == 0:
            lowest[0] += 1
            continue
        bucket[lowest[0]] = work.below[s]
        if s & 1:  # each inlined copy has only the arcs of its kind of state
            effort = _discharge_state(residual, work, s | 1, effort)
        else:
            effort = _discharge_state(residual, work, s & ~1, effort)
    return bool(lowest[0] > work.highest[0])


@inlined
def _find_level_0(
    residual: ResidualNetwork, work: PushRelabelState, seeds: Int32s, active: Int32s
) -> tuple[int, int]:
    """Set the level of all states with a free path straight down the planes to 0, and cut off all others for now.

    Lists in `seeds` those of level 0 in squares with flow or excess, in `active` all states with excess, and
    returns the length of both lists.
    """
    network, flow, excess, level = residual.network, residual.flow, work.excess, work.level
    stride, width, box = network.stride, network.width, network.box
    seed_count, active_count = 0, 0
    for p in range(1, box.shape[0]):
        for y in range(box[p, 0], box[p, 1] + 1):
            for u in range(p * stride + y * width + box[p, 2], p * stride + y * width + box[p, 3] + 1):
                inward, outward = 2 * u, 2 * u + 1
                used = flow.square[u] > 0 or excess[inward] > 0
                if not used and not network.passable[u]:
                    level[inward] = level[outward] = CUT_OFF
                    continue
                free = False
                for d in range(5):
                    head = head_of(network, outward, d)
                    if level[head] == 0 and residual_capacity(residual, outward, d, head) > 0:
                        free = True
                        break
                enter = free and residual_capacity(residual, inward, 0, outward) > 0
                level[inward] = 0 if enter else CUT_OFF
                level[outward] = 0 if free else CUT_OFF
                work.current_arc[inward] = work.current_arc[outward] = 0
                if used:
                    for s in (inward, outward):
                        if level[s] == 0:
                            seeds[seed_count] = s
                            seed_count += 1
                        if excess[s] > 0:
                            active[active_count] = s
                            active_count += 1
    return seed_count, active_count


@inlined
def _reset_buckets(work: PushRelabelState) -> None:
    """Empty all buckets, the list of raised states and the counts of their levels."""
    for s in work.raised[: work.raised_count[0]]:
        if work.level[s] < CUT_OFF:
            work.level_count[work.level[s]] = 0
    work.bucket[: work.highest[0] + 1] = 0
    work.lowest[0] = work.highest[0] = work.raised_count[0] = 0


@inlined
def _search_back(
    residual: ResidualNetwork,
    level: Int32s,
    state: int,
    depth: int,
    now: Int32s,
    length: int,
    later: Int32s,
    ahead: int,
) -> tuple[int, int]:
    """List the states with residual arcs to `state`: in `now` at the same level, else in `later`; return lengths."""
    for k in range(ARCS):
        s, arc = head_of(residual.network, state, k), reverse_of(k)
        reached = depth + is_backward(s, arc)
        if s < 2 * residual.network.stride or level[s] <= reached:
            continue
        if residual_capacity(residual, s, arc, state) <= 0:
            continue
        level[s] = reached
        if reached > depth:
            later[ahead] = s
            ahead += 1
        else:
            now[length] = s
            length += 1
    return length, ahead


@kernel
def relabel_globally(
    residual: ResidualNetwork, work: PushRelabelState, now: Int32s, later: Int32s, active: Int32s
) -> None:
    """Set all levels to their exact values, and put the active states in buckets again.

    States of level 0 come first; a search backwards over residual arcs then finds the states of each next level.

    Parameters
    ----------
    now, later, active
        ``(states,)`` int32, work arrays.
    """
    level = work.level
    _reset_buckets(work)
    length, active_count = _find_level_0(residual, work, now, active)
    depth, count = 0, 0
    while length > 0:
        ahead = 0
        while length > 0:
            length -= 1
            t = now[length]
            if depth > 0:
                work.raised[count] = t
                count += 1
                work.level_count[depth] += 1
            if t & 1:
                length, ahead = _search_back(residual, work.level, t | 1, depth, now, length, later, ahead)
            else:
                length, ahead = _search_back(residual, work.level, t & ~1, depth, now, length, later, ahead)
        depth += 1
        for i in range(ahead):
            if level[later[i]] == depth:
                now[length] = later[i]
                length += 1
    work.raised_count[0] = count
    for s in active[:active_count]:
        if level[s] < CUT_OFF:
            _put_in_bucket(work, s)


@kernel
def return_excess(residual: ResidualNetwork, work: PushRelabelState, supplied: Bytes) -> None:
    """Return the excess that is left to the squares that it came from, over oblique edges first.

    Parameters
    ----------
    supplied
        ``(squares,)`` uint8, 1 at red squares that have sent a unit; set to 0 where it returns.
    """
    network, flow, excess = residual.network, residual.flow, work.excess
    stride, width, box = network.stride, network.width, network.box
    for p in range(1, box.shape[0]):
        for y in range(box[p, 0], box[p, 1] + 1):
            for u in range(p * stride + y * width + box[p, 2], p * stride + y * width + box[p, 3] + 1):
                left = excess[2 * u + 1]
                flow.square[u] -= left
                left += excess[2 * u]
                for k in range(1, ARCS):
                    head = head_of(network, 2 * u, k)
                    if left > 0 and head >= 0:
                        amount = min(left, residual_capacity(residual, 2 * u, k, head))
                        send(residual, 2 * u, k, head, amount)
                        excess[head] += amount
                        left -= amount
                if left > 0:
                    supplied[u] = 0
