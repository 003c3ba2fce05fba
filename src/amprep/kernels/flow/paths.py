"""Routing kernels for paths that are known: taken back, put back, and read from a flow."""

from numba import njit

from amprep.arrays import Bytes, Int64s
from amprep.kernels.flow.shortest_paths import Flows, Network, load, relieve, use


@njit(cache=True)
def erase(
    network: Network, flows: Flows, start: Int64s, chosen: Int64s, first: Int64s, ways: Bytes, drawn: Bytes
) -> None:
    """Take the paths of the chosen red squares back."""
    for r in chosen:
        if not drawn[r]:
            continue
        u = start[r]
        for i in range(first[r], first[r + 1]):
            flows.through[u] -= 1
            relieve(flows, u, ways[i])
            u = u - network.stride + network.offset[ways[i]]
        flows.through[u] -= 1
        drawn[r] = 0


@njit(cache=True)
def redo(
    network: Network, flows: Flows, start: Int64s, chosen: Int64s, first: Int64s, ways: Bytes, drawn: Bytes
) -> None:
    """Put paths back where `ways` says, for the chosen red squares without one."""
    for r in chosen:
        if drawn[r]:
            continue
        u = start[r]
        for i in range(first[r], first[r + 1]):
            use(network, flows, u)
            load(flows, u, ways[i])
            u = u - network.stride + network.offset[ways[i]]
        use(network, flows, u)
        drawn[r] = 1


@njit(cache=True)
def untangle(network: Network, flows: Flows, start: Int64s, first: Int64s, ways: Bytes, drawn: Bytes) -> None:
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
