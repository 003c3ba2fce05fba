"""What exact flow kernels share: states of squares, residual arcs between them, and first distances.

A square u has two states, so that its capacity is that of an arc: ``2 * u`` once a path has come in, and
``2 * u + 1`` once it has been let through. Neither they nor their arcs are stored; arc k of a state is

* in: 0 through the square; 1 to 5 back up an edge that carries flow, sideways ones first;
* out: 0 to 4 down an edge, the straight one first; 5 back to the square's in state.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Int32s
from amprep.kernels.flow.shortest_paths import Network

Flowing = NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.int32]

UNREACHED = 1 << 30
"""Distance of a square without a way to the plate."""


class Carried(NamedTuple):
    """What flows: ``(squares, 5)`` down the edges, ``(squares,)`` through squares; modified in place."""

    flow: Flowing
    through: Flowing


class Room(NamedTuple):
    """Greatest flow through squares above the plate and over edges: one number for all, or one for each.

    Attributes
    ----------
    square, edge
        ``(1,)`` both, or ``(squares,)`` and ``(5 * squares,)``; that of edge d of square u is at ``5 * u + d``.
    each
        0 when there is one number for all, else 1: what indices are multiplied by.
    """

    square: Int32s
    edge: Int32s
    each: int


@njit(cache=True)
def shift(network: Network, carried: Carried, state: int, arc: int, amount: int) -> None:
    """Send `amount` over an arc of `state`."""
    u = state >> 1
    if state & 1:
        if arc == 5:
            carried.through[u] -= amount
        else:
            carried.flow[u, arc] += amount
    elif arc == 0:
        carried.through[u] += amount
    else:
        direction = arc if arc < 5 else 0
        carried.flow[u + network.stride - network.offset[direction], direction] -= amount


@njit(cache=True)
def measure(network: Network, straight: int, oblique: int, distance: Int32s) -> None:
    """Set the least cost of a way to the plate for all squares in reach, plane by plane from the plate up.

    It holds for paths that come in from above; squares that let none through are `UNREACHED`, and squares
    of `network.via` that lead nowhere are closed.
    """
    stride, width, box, via = network.stride, network.width, network.box, network.via
    far = np.int32(UNREACHED)
    for y in range(box[0, 0], box[0, 1] + 1):
        for u in range(y * width + box[0, 2], y * width + box[0, 3] + 1):
            distance[u] = np.int32(0) if via[u] else far
    for p in range(1, box.shape[0]):
        count = box[p, 3] - box[p, 2] + 1
        for y in range(box[p, 0], box[p, 1] + 1):
            u = p * stride + y * width + box[p, 2]
            v = u - stride
            here, passable, below = distance[u : u + count], via[u : u + count], distance[v : v + count]
            west, east = distance[v - 1 : v - 1 + count], distance[v + 1 : v + 1 + count]
            south, north = distance[v - width : v - width + count], distance[v + width : v + width + count]
            for i in range(count):
                a = west[i] if west[i] < east[i] else east[i]
                b = south[i] if south[i] < north[i] else north[i]
                sideways = (a if a < b else b) + np.int32(oblique)
                down = below[i] + np.int32(straight)
                best = down if down < sideways else sideways
                here[i] = best if passable[i] != 0 and best < far else far
                passable[i] = here[i] < far
