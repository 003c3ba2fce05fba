"""Kernels for shortest paths on the implicit layered grid: distance sweeps, and routing along them (thesis 3.4).

Strategy: nothing is stored per edge but its flow. One sweep from the plate up gives the distance of every square,
because edges only lead down. Each path then follows the cheapest edge at its present price plus the distance of
the last sweep, so the paths of one batch see each other's flow and do not all choose the same squares. Edges that
have no flow, and no flow beside them, all cost the same; rows of such squares are swept by vector instructions,
and only repriced squares compare their five prices one by one. A sweep takes O(squares), a path O(planes) unless
it runs into full squares.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from amprep.arrays import Bytes, Float32s, Int32s, Int64s
from amprep.kernels.flow.records import Capacities, Flow, FlowNetwork
from amprep.kernels.helper import inlined, kernel

FAR = np.float32(1e30)
"""Distance of a square from which no path leads to the plate."""


class RoutingState(NamedTuple):
    """The flow of the paths routed so far and the state of the sweeps; kernels modify all arrays in place.

    Attributes
    ----------
    flow
        Number of paths on edges and squares, uint16 or int32.
    repriced
        ``(squares,)`` uint8, 1 where the price of an edge may differ from that of an unused edge.
    repriced_rows
        ``(planes * rows,)`` uint8, 1 for rows of squares that contain a repriced one.
    distance
        ``(squares,)`` float32, distance to the plate of a path that arrives from above, by the last sweep.
    dead_end
        ``(squares,)`` int32, number of the last batch in which no path led down from the square.
    edges_used
        ``(2,)`` int64, numbers of vertical and of oblique edges in use.
    """

    flow: Flow
    repriced: Bytes
    repriced_rows: Bytes
    distance: Float32s
    dead_end: Int32s
    edges_used: Int64s


class Paths(NamedTuple):
    """The paths of all red squares; path r has the directions ``direction[first[r] : first[r + 1]]``.

    Attributes
    ----------
    start
        ``(m,)`` int64, number of each red square in the network.
    first
        ``(m + 1,)`` int64, where the directions of each path begin.
    direction
        ``(steps,)`` uint8, direction of each edge from the red square down.
    routed
        ``(m,)`` uint8, 1 for red squares that have a path.
    """

    start: Int64s
    first: Int64s
    direction: Bytes
    routed: Bytes


class EdgePrices(NamedTuple):
    """Price of one more path over an edge: ``table[flow]`` times `vertical` or `oblique` (thesis 3.4).

    Attributes
    ----------
    table
        ``(n,)`` float32, cost factor by the flow on the edge; the last entry applies to any greater flow.
    vertical, oblique
        Costs of an edge.
    neighbour_factor
        Multiplies the price of edges beside a square in use.
    """

    table: Float32s
    vertical: np.float32
    oblique: np.float32
    neighbour_factor: np.float32


class PathLimits(NamedTuple):
    """Greatest number of paths in squares above the plate and on edges, and in a square of the plate."""

    capacities: Capacities
    plate: int


@inlined
def _square_limit(limits: PathLimits, u: int) -> int:
    return limits.capacities.square[u * limits.capacities.each]


@inlined
def _edge_limit(limits: PathLimits, u: int, d: int) -> int:
    return limits.capacities.edge[(5 * u + d) * limits.capacities.each]


@inlined
def _is_beside_used(network: FlowNetwork, flow: Flow, u: int) -> bool:
    """Tell whether a square next to `u` is in use."""
    paths, width = flow.square, network.width
    return bool(paths[u - 1] | paths[u + 1] | paths[u - width] | paths[u + width])


@inlined
def _price(prices: EdgePrices, flow: int, direction: int, beside: bool) -> np.float32:
    """Return the price of one more path over an edge with `flow` paths."""
    price: np.float32 = prices.table[min(flow, prices.table.size - 1)]
    price *= prices.vertical if direction == 0 else prices.oblique
    return price * prices.neighbour_factor if beside else price


@inlined
def _repriced_distance(
    network: FlowNetwork, state: RoutingState, prices: EdgePrices, limits: PathLimits, u: int
) -> np.float32:
    """Return the distance of square `u` over its five edges at their present prices; FAR if it is full.

    If neither the square nor a neighbour is in use, the square is no longer repriced.
    """
    beside = _is_beside_used(network, state.flow, u)
    if state.flow.square[u] >= _square_limit(limits, u):
        return FAR
    if state.flow.square[u] == 0 and not beside:
        state.repriced[u] = 0
    best = FAR
    for d in range(5):
        flow = state.flow.edge[u, d]
        if flow < _edge_limit(limits, u, d):
            below = state.distance[u - network.stride + network.offset[d]]
            best = min(best, below + _price(prices, flow, d, beside))
    return best


@kernel
def sweep(network: FlowNetwork, state: RoutingState, prices: EdgePrices, limits: PathLimits) -> None:
    """Set `state.distance` for all squares in reach, plane by plane from the plate up."""
    stride, width, box, passable = network.stride, network.width, network.box, network.passable
    distance, repriced = state.distance, state.repriced
    vertical = prices.table[0] * prices.vertical
    oblique = prices.table[0] * prices.oblique
    height = stride // width
    for y in range(box[0, 0], box[0, 1] + 1):
        for u in range(y * width + box[0, 2], y * width + box[0, 3] + 1):
            free = passable[u] and state.flow.square[u] < limits.plate
            distance[u] = np.float32(0.0) if free else FAR
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
                sideways = (a if a < b else b) + oblique
                down = below[i] + vertical
                best = down if down < sideways else sideways
                here[i] = best if open_[i] != 0 and best < FAR else FAR
            if state.repriced_rows[p * height + y]:
                for i in range(count):
                    if repriced[u + i] and open_[i]:
                        here[i] = _repriced_distance(network, state, prices, limits, u + i)


@inlined
def _cheapest_direction(
    network: FlowNetwork, state: RoutingState, prices: EdgePrices, limits: PathLimits, u: int, batch: int
) -> int:
    """Return the cheapest direction down from `u` that has capacity left, the first of equal ones, or -1."""
    best, chosen = FAR, -1
    beside = _is_beside_used(network, state.flow, u)
    for d in range(5):
        v = u - network.stride + network.offset[d]
        flow = state.flow.edge[u, d]
        limit = limits.plate if v < network.stride else _square_limit(limits, v)
        if flow < _edge_limit(limits, u, d) and state.flow.square[v] < limit and state.dead_end[v] != batch:
            cost = state.distance[v] + _price(prices, flow, d, beside)
            if cost < best:
                best, chosen = cost, d
    return chosen


@kernel
def add_to_square(network: FlowNetwork, state: RoutingState, u: int) -> None:
    """Count one more path in square `u`, and mark the squares whose prices this may change."""
    state.flow.square[u] += 1
    y = u // network.width
    for v in (u, u - 1, u + 1, u - network.width, u + network.width):
        state.repriced[v] = 1
    state.repriced_rows[y - 1 : y + 2] = 1


@kernel
def add_to_edge(state: RoutingState, u: int, d: int) -> None:
    """Count one more path on an edge."""
    state.flow.edge[u, d] += 1
    if state.flow.edge[u, d] == 1:
        state.edges_used[1 if d else 0] += 1


@njit(cache=True)
def route(
    network: FlowNetwork,
    state: RoutingState,
    prices: EdgePrices,
    limits: PathLimits,
    paths: Paths,
    chosen: Int64s,
    batch: int,
) -> int:
    """Route a path to the plate from each red square of `chosen` that has none; return the number of failures.

    Where all edges further down have become full, the path backs up, and the dead end is marked for the rest of
    the batch. A batch only adds paths, so it stays a dead end.

    Parameters
    ----------
    chosen
        ``(n,)`` int64, numbers of red squares.
    batch
        Number of this batch, greater than that of all batches before.
    """
    trail = np.empty(network.box.shape[0] + 1, np.int64)
    first, failed = paths.first, 0
    for r in chosen:
        if paths.routed[r]:
            continue
        trail[0] = paths.start[r]
        length = -1 if state.flow.square[trail[0]] >= _square_limit(limits, trail[0]) else 0
        while length >= 0 and trail[length] >= network.stride:
            u = trail[length]
            d = _cheapest_direction(network, state, prices, limits, u, batch)
            if d < 0:
                state.dead_end[u] = batch
                length -= 1
            else:
                paths.direction[first[r] + length] = d
                length += 1
                trail[length] = u - network.stride + network.offset[d]
        paths.routed[r] = length >= 0
        failed += length < 0
        for i in range(length + 1):
            add_to_square(network, state, trail[i])
            if i < length:
                add_to_edge(state, trail[i], paths.direction[first[r] + i])
    return failed
