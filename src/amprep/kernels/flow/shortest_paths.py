"""Routing kernels on the implicit layered grid: distance sweeps and walks down them.

Strategy: squares are numbered ``plane * stride + y * width + x`` over planes padded by one square sideways,
so the five ways down from square u lead to ``u - stride + offset[d]``. Nothing is stored per edge but its
flow. One sweep from the plate up gives every square's distance; a walk goes down it and prices each edge by
the flow it has at that moment, so that the walks of one batch see each other and do not move as a herd.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from amprep.arrays import Bytes, Float32s, Int32s, Int64s

Counts = NDArray[np.uint16] | NDArray[np.int32]

FAR = np.float32(1e30)
"""Distance of a square without a way to the plate."""

UNBOUNDED = 1 << 30
"""Greatest number of paths at a square or on an edge where no other is set."""


class Network(NamedTuple):
    """Where paths may go.

    Attributes
    ----------
    via
        ``(planes * stride,)`` uint8: 1 where a path may enter the square from above and go on downwards.
    offset
        ``(5,)`` int64, of `amprep.model.supports.DIRECTIONS`.
    box
        ``(planes, 4)`` int64, least and greatest y, least and greatest x that paths can reach in each plane.
    """

    via: Bytes
    offset: Int64s
    box: Int64s
    stride: int
    width: int


class Flows(NamedTuple):
    """The paths drawn so far, as numbers on edges and squares; all arrays are modified in place.

    Attributes
    ----------
    flow
        ``(squares, 5)`` uint16 or int32, paths on each edge downwards.
    through
        ``(squares,)`` of the same type, paths at each square.
    special
        ``(squares,)`` uint8, 1 where an edge's price can differ from that of an unused edge.
    rows
        ``(planes * rows,)`` uint8, 1 for rows of squares that have a special one.
    entry
        ``(squares,)`` float32, distance to the plate of a path that enters from above, as of the last sweep.
    dead
        ``(squares,)`` int32, number of the batch that found no way down from the square.
    used
        ``(2,)`` int64, how many straight and how many oblique edges are in use.
    """

    flow: Counts
    through: Counts
    special: Bytes
    rows: Bytes
    entry: Float32s
    dead: Int32s
    used: Int64s


class Prices(NamedTuple):
    """What one more path over an edge costs: ``table[flow]`` times `straight` or `oblique` (thesis 3.4).

    `beside` multiplies the price next to a square in use; the last entry of `table` is never exceeded.
    """

    table: Float32s
    straight: np.float32
    oblique: np.float32
    beside: np.float32


class Limits(NamedTuple):
    """Greatest number of paths at a square, at a square of the plate, and on an edge."""

    square: int
    ground: int
    edge: int


@njit(cache=True)
def _beside(network: Network, flows: Flows, u: int) -> bool:
    """Tell whether a square next to `u` is in use."""
    through, width = flows.through, network.width
    return bool(through[u - 1] | through[u + 1] | through[u - width] | through[u + width])


@njit(cache=True)
def _exact_entry(network: Network, flows: Flows, prices: Prices, limits: Limits, u: int) -> np.float32:
    """Return the distance of square `u` over its five edges at their present prices; FAR when it is full.

    A square that is out of use, and all squares next to it too, is special no longer.
    """
    beside = _beside(network, flows, u)
    if flows.through[u] >= limits.square:
        return FAR
    if flows.through[u] == 0 and not beside:
        flows.special[u] = 0
    best = FAR
    for d in range(5):
        flow = flows.flow[u, d]
        cost = flows.entry[u - network.stride + network.offset[d]]
        if flow < limits.edge:
            price = prices.table[min(flow, prices.table.size - 1)]
            price *= prices.straight if d == 0 else prices.oblique
            cost += price * prices.beside if beside else price
            best = cost if cost < best else best
    return best


@njit(cache=True)
def sweep(network: Network, flows: Flows, prices: Prices, limits: Limits) -> None:
    """Set `flows.entry` for all squares in reach, plane by plane from the plate up.

    Unused edges cost ``table[0]``; only special squares look at the five prices one by one.
    """
    stride, width, box, via = network.stride, network.width, network.box, network.via
    entry, special = flows.entry, flows.special
    straight = prices.table[0] * prices.straight
    oblique = prices.table[0] * prices.oblique
    height = stride // width
    for y in range(box[0, 0], box[0, 1] + 1):
        for u in range(y * width + box[0, 2], y * width + box[0, 3] + 1):
            entry[u] = np.float32(0.0) if via[u] and flows.through[u] < limits.ground else FAR
    for p in range(1, box.shape[0]):
        count = box[p, 3] - box[p, 2] + 1
        for y in range(box[p, 0], box[p, 1] + 1):
            u = p * stride + y * width + box[p, 2]
            v = u - stride
            here, passable, below = entry[u : u + count], via[u : u + count], entry[v : v + count]
            west, east = entry[v - 1 : v - 1 + count], entry[v + 1 : v + 1 + count]
            south, north = entry[v - width : v - width + count], entry[v + width : v + width + count]
            for i in range(count):
                a = west[i] if west[i] < east[i] else east[i]
                b = south[i] if south[i] < north[i] else north[i]
                sideways = (a if a < b else b) + oblique
                down = below[i] + straight
                best = down if down < sideways else sideways
                here[i] = best if passable[i] != 0 and best < FAR else FAR
            if flows.rows[p * height + y]:
                for i in range(count):
                    if special[u + i] and passable[i]:
                        here[i] = _exact_entry(network, flows, prices, limits, u + i)


@njit(cache=True)
def _best_way(network: Network, flows: Flows, prices: Prices, limits: Limits, u: int, batch: int) -> int:
    """Return the cheapest direction down from `u` with room at its end, the first of equals, or -1."""
    best, way = FAR, -1
    beside = _beside(network, flows, u)
    for d in range(5):
        v = u - network.stride + network.offset[d]
        flow = flows.flow[u, d]
        room = limits.ground if v < network.stride else limits.square
        if flow < limits.edge and flows.through[v] < room and flows.dead[v] != batch:
            price = prices.table[min(flow, prices.table.size - 1)]
            price *= prices.straight if d == 0 else prices.oblique
            cost = flows.entry[v] + (price * prices.beside if beside else price)
            if cost < best:
                best, way = cost, d
    return way


@njit(cache=True)
def use(network: Network, flows: Flows, u: int) -> None:
    """Count one more path at square `u` and note whose prices that may change."""
    flows.through[u] += 1
    y = u // network.width
    for v in (u, u - 1, u + 1, u - network.width, u + network.width):
        flows.special[v] = 1
    flows.rows[y - 1 : y + 2] = 1


@njit(cache=True)
def load(flows: Flows, u: int, d: int) -> None:
    """Count one more path on an edge."""
    flows.flow[u, d] += 1
    if flows.flow[u, d] == 1:
        flows.used[1 if d else 0] += 1


@njit(cache=True)
def relieve(flows: Flows, u: int, d: int) -> None:
    """Count one path less on an edge."""
    flows.flow[u, d] -= 1
    if flows.flow[u, d] == 0:
        flows.used[1 if d else 0] -= 1


@njit(cache=True)
def draw(
    network: Network,
    flows: Flows,
    prices: Prices,
    limits: Limits,
    start: Int64s,
    chosen: Int64s,
    first: Int64s,
    ways: Bytes,
    drawn: Bytes,
    batch: int,
) -> int:
    """Draw a path to the plate from each red square of `chosen` without one; return how many found none.

    A walk takes the cheapest edge at its present price plus the distance of the last sweep; where everything
    further down has become full it backs up, and marks the dead end for the rest of the batch (paths are only
    added in a batch, so it stays dead).

    Parameters
    ----------
    first, ways
        The path of red r has the directions ``ways[first[r] : first[r + 1]]``.
    drawn
        Set to 1 for red squares that have a path, 0 otherwise.
    """
    trail = np.empty(network.box.shape[0] + 1, np.int64)
    failed = 0
    for r in chosen:
        if drawn[r]:
            continue
        trail[0] = start[r]
        length = 0
        if flows.through[start[r]] >= limits.square:
            length = -1
        while length >= 0 and trail[length] >= network.stride:
            u = trail[length]
            d = _best_way(network, flows, prices, limits, u, batch)
            if d < 0:
                flows.dead[u] = batch
                length -= 1
            else:
                ways[first[r] + length] = d
                length += 1
                trail[length] = u - network.stride + network.offset[d]
        drawn[r] = length >= 0
        failed += length < 0
        for i in range(length + 1):
            use(network, flows, trail[i])
            if i < length:
                load(flows, trail[i], ways[first[r] + i])
    return failed
