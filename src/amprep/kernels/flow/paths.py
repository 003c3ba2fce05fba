"""Kernels for known paths: rip up, restore, and decompose a flow into paths."""

from amprep.arrays import Int64s
from amprep.kernels.flow.records import Flow, FlowNetwork
from amprep.kernels.flow.shortest_paths import Paths, RoutingState, add_to_edge, add_to_square
from amprep.kernels.helper import kernel


@kernel
def rip_up(network: FlowNetwork, state: RoutingState, paths: Paths, chosen: Int64s) -> None:
    """Remove the paths of the chosen red squares from the flow; their directions stay known."""
    flow = state.flow
    for r in chosen:
        if not paths.routed[r]:
            continue
        u = paths.start[r]
        for d in paths.direction[paths.first[r] : paths.first[r + 1]]:
            flow.square[u] -= 1
            flow.edge[u, d] -= 1
            if flow.edge[u, d] == 0:
                state.edges_used[1 if d else 0] -= 1
            u = u - network.stride + network.offset[d]
        flow.square[u] -= 1
        paths.routed[r] = 0


@kernel
def restore(network: FlowNetwork, state: RoutingState, paths: Paths, chosen: Int64s) -> None:
    """Add the known paths of the chosen red squares to the flow again, where they have been ripped up."""
    for r in chosen:
        if paths.routed[r]:
            continue
        u = paths.start[r]
        for d in paths.direction[paths.first[r] : paths.first[r + 1]]:
            add_to_square(network, state, u)
            add_to_edge(state, u, d)
            u = u - network.stride + network.offset[d]
        add_to_square(network, state, u)
        paths.routed[r] = 1


@kernel
def decompose(network: FlowNetwork, flow: Flow, paths: Paths) -> None:
    """Decompose a flow into one path for each routed red square; the flow is the same afterwards."""
    for r in range(paths.start.size):
        u = paths.start[r]
        if paths.routed[r]:
            for i in range(paths.first[r], paths.first[r + 1]):
                d = 0
                while flow.edge[u, d] == 0:
                    d += 1
                flow.edge[u, d] -= 1
                paths.direction[i] = d
                u = u - network.stride + network.offset[d]
    for r in range(paths.start.size):
        u = paths.start[r]
        if paths.routed[r]:
            for d in paths.direction[paths.first[r] : paths.first[r + 1]]:
                flow.edge[u, d] += 1
                u = u - network.stride + network.offset[d]
