"""Routing kernels that connect what walks have left: augmenting searches, and the paths in a flow."""

from typing import NamedTuple

from numba import njit

from amprep.kernels.routing import Bytes, Flows, Ints, Limits, Longs, Network, load, relieve, use


class Work(NamedTuple):
    """Work arrays over the two states of each square: search that saw it last, stack, next arcs, seen."""

    seen: Ints
    stack: Ints
    arcs: Bytes
    visited: Ints


@njit(cache=True)
def _next_state(
    network: Network, flows: Flows, limits: Limits, state: int, arc: int, seen: Ints, search: int
) -> tuple[int, int]:
    """Return where the next arc of `state` to an unseen state leads, or -1, and the arc after it."""
    u = state >> 1
    top = network.via.size
    while arc < 6:
        to = -1
        if state & 1:  # leaving u: on over its edges, or give the square's unit back
            if arc < 5:
                v = u - network.stride + network.offset[arc]
                if network.via[v] and flows.flow[u, arc] < limits.edge:
                    to = 2 * v
            elif flows.through[u] > 0:
                to = 2 * u
        elif arc == 0:  # entering u: on when it has room, or push an entering unit back
            room = limits.ground if u < network.stride else limits.square
            if flows.through[u] < room:
                to = 2 * u + 1
        else:
            w = u + network.stride - network.offset[arc - 1]
            if w < top and flows.flow[w, arc - 1] > 0:
                to = 2 * w + 1
        arc += 1
        if to >= 0 and 0 <= seen[to] < search:
            return to, arc
    return -1, arc


@njit(cache=True)
def augment(
    network: Network,
    flows: Flows,
    limits: Limits,
    start: Longs,
    chosen: Longs,
    drawn: Bytes,
    work: Work,
    effort: int,
) -> int:
    """Connect undrawn red squares by augmenting paths, so that the flow is maximal; return the effort left.

    A state is twice the square, plus 1 once the path has been let through it (the two nodes of a square with
    a capacity). A search that fails has seen only states from which the plate stays out of reach for good:
    they are marked -1. The paths must be found anew from the flow afterwards (`untangle`).

    Parameters
    ----------
    work
        Modified in place; fresh ones (`seen` all 0) for each call.
    effort
        Number of arcs that may be looked at; the search ends when it is used up.
    """
    seen, stack, arcs = work.seen, work.stack, work.arcs
    search = 0
    for r in chosen:
        if drawn[r] or effort <= 0:
            continue
        search += 1
        begin = 2 * start[r]
        if seen[begin] < 0:
            continue
        length, visited = 0, 1
        stack[0], arcs[0] = begin, 0
        seen[begin], work.visited[0] = search, begin
        while length >= 0 and effort > 0:
            state = stack[length]
            if state & 1 and state >> 1 < network.stride:
                break
            to, arc = _next_state(network, flows, limits, state, arcs[length], seen, search)
            effort -= 1
            arcs[length] = arc
            if to < 0:
                length -= 1
            else:
                length += 1
                stack[length], arcs[length] = to, 0
                seen[to], work.visited[visited] = search, to
                visited += 1
        if length < 0:
            for i in range(visited):
                seen[work.visited[i]] = -1
        elif effort > 0:
            drawn[r] = 1
            for i in range(length):
                _shift(network, flows, stack[i], stack[i + 1])
    return effort


@njit(cache=True)
def _shift(network: Network, flows: Flows, state: int, to: int) -> None:
    """Send one unit over a residual arc."""
    u, v = state >> 1, to >> 1
    if u == v:
        if to & 1:
            use(network, flows, u)
        else:
            flows.through[u] -= 1
        return
    upper, lower = (u, v) if state & 1 else (v, u)
    for d in range(5):
        if upper - network.stride + network.offset[d] == lower:
            if state & 1:
                load(flows, upper, d)
            else:
                relieve(flows, upper, d)


@njit(cache=True)
def untangle(network: Network, flows: Flows, start: Longs, first: Longs, ways: Bytes, drawn: Bytes) -> None:
    """Find one path for each drawn red square in the flow; the flow is the same afterwards."""
    for r in range(start.size):
        u = start[r]
        if drawn[r]:
            for i in range(first[r], first[r + 1]):
                d = 0
                while flows.flow[u, d] == 0:
                    d += 1
                flows.flow[u, d] -= 1
                ways[i] = d
                u = u - network.stride + network.offset[d]
    for r in range(start.size):
        u = start[r]
        if drawn[r]:
            for i in range(first[r], first[r + 1]):
                flows.flow[u, ways[i]] += 1
                u = u - network.stride + network.offset[ways[i]]
