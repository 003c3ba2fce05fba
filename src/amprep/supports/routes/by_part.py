"""Routes the red squares of a build: as one network, or part by part so that supports are not shared."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Ints
from amprep.flows.complete import complete
from amprep.flows.reachability import has_way
from amprep.model.control import Progress, Stop, silent
from amprep.model.supports import CAPACITY, ENCLOSED, OUT_OF_TIME
from amprep.supports.routes.edges import (
    keys_of,
    merge_edges,
    no_edges,
    no_voxels,
    part_of_edges,
    voxels_below,
    voxels_used,
)
from amprep.supports.routes.network import Network


class Routed(NamedTuple):
    """Where the supports run.

    Attributes
    ----------
    edges
        ``(n, 7)`` int32: plane, y, x, direction, flow, capacity, part; edges of several plans may repeat.
    reasons
        For each red square; ``""`` when it is connected.
    """

    edges: Ints
    reasons: tuple[str, ...]


def route_together(network: Network, progress: Progress) -> Routed:
    """Route everything as one network, as in the thesis: supports of different parts may merge."""
    reds = np.flatnonzero(network.red.square[:, 0] > 0).astype(np.int32)
    edges = network.connect(reds, no_voxels(), network.stop, progress)
    edges[:, 6] = part_of_edges(edges, network.red, reds)
    return Routed(edges, tuple(network.reasons))


def route_apart(network: Network, progress: Progress) -> Routed:
    """Route part by part; squares and voxels in use are closed to the parts that follow.

    Parts come by the height of their highest red square, lowest first: the less height, the less room to
    give way. Cubes right below the red squares of other parts are kept free for these. Each part gets an equal
    share of the time that is left. Red squares that stay unconnected are then routed once more with the voxels
    of other supports open: they share where they must.
    """
    red = network.red
    above = red.square[:, 0] > 0
    parts = sorted(
        set(red.part[above].tolist()), key=lambda part: (int(red.square[red.part == part, 0].max()), part)
    )
    blocks = [no_edges()]
    for done, part in enumerate(parts):
        own = np.flatnonzero(above & (red.part == part)).astype(np.int32)
        kept = voxels_below(red.square[above & (red.part != part)])
        kept = kept[~np.isin(keys_of(kept), keys_of(voxels_below(red.square[own])))]
        closed = np.concatenate([kept, *(voxels_used(block) for block in blocks)])
        edges = network.connect(own, closed, _equal_share(network.stop, len(parts) - done), silent)
        edges[:, 6] = part
        blocks.append(edges)
        progress((done + 1) / (len(parts) + 1), "routing part by part")
    edges = share(network, np.concatenate(blocks))
    return Routed(edges, tuple(network.reasons))


def _equal_share(stop: Stop, count: int) -> Stop:
    """Return a stop that leaves as much time for each of `count - 1` others, when there is a limit."""
    return stop if stop.deadline is None else stop.within(stop.remaining() / count)


def share(network: Network, edges: Ints) -> Ints:
    """Return the edges with those that connect the red squares left over through other parts' supports.

    First the router connects them as far as there is room beside the flow of `edges`. Those that capacities then
    leave out are connected by the greatest flow in one network of all parts that starts from what flows
    already, and that exceeds capacities at last where escalation is allowed.
    """
    left = network.left()
    if not left.size:
        return edges
    posed = network.pose(left, no_voxels())
    way = has_way(posed.problem)[posed.number]
    network.explain(left[~way], ENCLOSED)
    left = left[way]
    edges = merge_edges(np.concatenate([edges, _beside(network, edges, left)]))
    if network.stop():
        network.explain(left[np.isin(left, network.left())], OUT_OF_TIME)
    elif network.left(CAPACITY).size:
        edges = _completed(network, edges)
    return edges


def _beside(network: Network, edges: Ints, left: Ints) -> Ints:
    """Connect red squares that have a way, with no capacity exceeded, by the router.

    It does not know the flow that is there already, so squares where both together exceed a capacity are closed
    and all is routed again, until nothing is exceeded.
    """
    rules, closed = network.rules, no_voxels()
    limit = rules.edge_limit(network.frame, int(network.red.square[:, 0].max()))
    while left.size and not network.stop():
        network.rules = rules._replace(escalation="none")
        more = network.connect(left, closed, network.stop, silent)
        network.rules = rules
        network.explain(left[np.isin(left, network.left(ENCLOSED))], CAPACITY)
        more[:, 6] = part_of_edges(more, network.red, left)
        full = _exceeded(np.concatenate([edges, more]), limit, rules.node_capacity)
        full = full[np.isin(keys_of(full), keys_of(voxels_below(more[:, :3])))]
        if not len(full):
            return more
        closed = np.concatenate([closed, full])
    return no_edges()


def _exceeded(edges: Ints, edge_capacity: int, node_capacity: int) -> Ints:
    """Return the voxels below the squares, and below the edges' upper squares, that exceed the capacities."""
    merged = merge_edges(edges)
    over = np.zeros(len(merged), np.bool_)
    if edge_capacity:
        over |= merged[:, 4] > edge_capacity
    if node_capacity:
        _, square = np.unique(keys_of(merged[:, :3]), return_inverse=True)
        over |= np.bincount(square, weights=merged[:, 4])[square] > node_capacity
    return voxels_below(merged[over, :3])


def _completed(network: Network, edges: Ints) -> Ints:
    """Return the edges of the greatest flow in one network of all parts, capacities raised where that is allowed."""
    reds = np.flatnonzero(network.red.square[:, 0] > 0).astype(np.int32)
    posed = network.pose(reds, no_voxels())
    connected = np.zeros(len(posed.problem.red), np.bool_)
    connected[posed.number[~np.isin(reds, network.left())]] = True
    inner = edges - np.append(posed.corner, [0, 0, 0, 0])
    plan = complete(posed.problem, inner, connected, stop=network.stop, progress=silent)
    more = network.read(plan, posed, reds)
    more[:, 6] = part_of_edges(more, network.red, reds)
    return more
