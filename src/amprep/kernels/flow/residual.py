"""Kernels for the residual network: arcs between states of squares, and distances to the plate.

Strategy: a square u has two states, so that its capacity is the capacity of an arc: state ``2 * u`` (in) after a
path has arrived, state ``2 * u + 1`` (out) after the square has let it through. A state has up to six residual
arcs. Neither states nor arcs are stored; number k of an arc says where it leads:

* from an in state: 0 through the square; 1 to 4 back up the oblique edges, 5 back up the vertical edge;
* from an out state: 0 down the vertical edge, 1 to 4 down the oblique edges; 5 back to the in state.

Kernels try arcs in this order. So flow is increased on vertical edges first and reduced on them last, and paths
stay straight where there is a choice (thesis 3.3). An arc that undoes flow is a backward arc.
"""

import numpy as np

from amprep.arrays import Int32s
from amprep.kernels.flow.records import UNREACHABLE, FlowNetwork, ResidualNetwork
from amprep.kernels.helper import inlined, kernel

ARCS = 6
"""Number of arcs of a state."""


@inlined
def is_backward(state: int, arc: int) -> bool:
    """Tell whether an arc of `state` undoes flow."""
    return arc > 4 * (state & 1)


@inlined
def reverse_of(arc: int) -> int:
    """Return the number of the arc that leads back, at the other end of an arc."""
    return arc if 0 < arc < 5 else 5 - arc


@inlined
def head_of(network: FlowNetwork, state: int, arc: int) -> int:
    """Return the state to which an arc of `state` leads, -1 above the highest plane."""
    if state & 1:
        return state - 1 if arc == 5 else state - 1 + 2 * (network.offset[arc] - network.stride)
    if arc == 0:
        return state + 1
    head = state + 1 + 2 * (network.stride - network.offset[arc if arc < 5 else 0])
    return head if head < 2 * network.passable.size else -1


@inlined
def residual_capacity(residual: ResidualNetwork, state: int, arc: int, head: int) -> int:
    """Return the residual capacity of the arc from `state` to `head`; 0 or less if it is full."""
    network, flow, capacities = residual.network, residual.flow, residual.capacities
    u, v = state >> 1, head >> 1
    if state & 1:
        if arc == 5:
            return int(flow.square[u])
        limit = capacities.edge[(5 * u + arc) * capacities.each]
        return int(limit) - int(flow.edge[u, arc]) if network.passable[v] else 0
    if arc == 0:
        limit = capacities.square[u * capacities.each]
        return int(limit) - int(flow.square[u]) if u >= network.stride else 0
    return int(flow.edge[v, arc if arc < 5 else 0])


@inlined
def send(residual: ResidualNetwork, state: int, arc: int, head: int, amount: int) -> None:
    """Send `amount` units over an arc of `state` that leads to `head`."""
    flow, u, v = residual.flow, state >> 1, head >> 1
    if state & 1:
        if arc == 5:
            flow.square[u] -= amount
        else:
            flow.edge[u, arc] += amount
    elif arc == 0:
        flow.square[u] += amount
    else:
        flow.edge[v, arc if arc < 5 else 0] -= amount


@kernel
def find_distances(network: FlowNetwork, vertical: int, oblique: int, distance: Int32s) -> None:
    """Set the least cost of a path from each square to the plate, plane by plane from the plate up.

    A distance is valid for paths that arrive in the square from above. Squares that are not passable are
    `UNREACHABLE`; passable squares from which no path leads to the plate become impassable.

    Parameters
    ----------
    vertical, oblique
        Costs of an edge.
    distance
        ``(squares,)`` int32, written for the squares in `network.box`.
    """
    stride, width, box, passable = network.stride, network.width, network.box, network.passable
    far = np.int32(UNREACHABLE)
    for y in range(box[0, 0], box[0, 1] + 1):
        for u in range(y * width + box[0, 2], y * width + box[0, 3] + 1):
            distance[u] = np.int32(0) if passable[u] else far
    for p in range(1, box.shape[0]):
        count = box[p, 3] - box[p, 2] + 1
        for y in range(box[p, 0], box[p, 1] + 1):
            u = p * stride + y * width + box[p, 2]
            v = u - stride
            here, open_, below = distance[u : u + count], passable[u : u + count], distance[v : v + count]
            west, east = distance[v - 1 : v - 1 + count], distance[v + 1 : v + 1 + count]
            south, north = distance[v - width : v - width + count], distance[v + width : v + width + count]
            for i in range(count):
                a = west[i] if west[i] < east[i] else east[i]
                b = south[i] if south[i] < north[i] else north[i]
                sideways = (a if a < b else b) + np.int32(oblique)
                down = below[i] + np.int32(vertical)
                best = down if down < sideways else sideways
                here[i] = best if open_[i] != 0 and best < far else far
                open_[i] = here[i] < far
