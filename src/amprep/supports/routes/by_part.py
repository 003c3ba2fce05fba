"""Route the red squares of a build: as one network, or part by part so that parts do not share supports."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Ints
from amprep.flows.completion import StartFlow, complete_plan
from amprep.flows.reachability import find_reachable
from amprep.model.control import Progress, Stop, silent
from amprep.model.supports import CAPACITY, ENCLOSED, OUT_OF_TIME
from amprep.model.supports.edges import SupportEdges, square_keys
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.routes.network import NO_VOXELS, PosedProblem, SupportNetwork, voxels_below


class Routed(NamedTuple):
    """The routed edges of a build.

    Attributes
    ----------
    edges
        Edges of several plans; the same edge may occur more than once.
    reasons
        For each red square, why it is unconnected; ``""`` when it is connected.
    """

    edges: SupportEdges
    reasons: tuple[str, ...]


def route_together(network: SupportNetwork, progress: Progress) -> Routed:
    """Route all parts as one network, as in the thesis: supports of different parts may merge.

    Parts with territories are routed one after the other, and their supports may merge where territories overlap.
    """
    red_squares = _above_plate(network.red)
    if network.territories:
        edges = SupportEdges.from_rows([])
        for own in network.groups(red_squares):
            edges = _route_left(network, edges, own)
        network.explain_territories()
        return Routed(edges, tuple(network.reasons))
    edges = network.connect(red_squares, NO_VOXELS, network.stop, progress)
    return Routed(_with_parts(edges, network.red, red_squares), tuple(network.reasons))


def route_apart(network: SupportNetwork, progress: Progress) -> Routed:
    """Route part by part; the voxels in use are closed to the parts that follow.

    Parts are routed in the order of their highest red square, lowest first: the lower it is, the fewer squares
    can a path move sideways. The voxels below the red squares of the other parts stay free for these parts. Each
    part gets an equal fraction of the remaining time. Red squares that stay unconnected are then routed through
    the supports of other parts.
    """
    red, above = network.red, network.red.square[:, 0] > 0
    parts = sorted(
        set(red.part[above].tolist()), key=lambda part: (int(red.square[red.part == part, 0].max()), part)
    )
    blocks: list[SupportEdges] = []
    for done, part in enumerate(parts):
        own = np.flatnonzero(above & (red.part == part)).astype(np.int32)
        kept = voxels_below(red.square[above & (red.part != part)])
        kept = kept[~np.isin(square_keys(kept), square_keys(voxels_below(red.square[own])))]
        closed = np.concatenate([kept, *(block.voxels for block in blocks)])
        edges = network.connect(own, closed, _fraction_of_time(network.stop, len(parts) - done), silent)
        blocks.append(replace(edges, part=np.full(len(edges), part)))
        progress((done + 1) / (len(parts) + 1), "routing part by part")
    edges = route_shared(network, SupportEdges.concatenate(blocks))
    network.explain_territories()
    return Routed(edges, tuple(network.reasons))


def _above_plate(red: RedSquares) -> Ints:
    """Return the numbers of the red squares that are not on the plate."""
    return np.flatnonzero(red.square[:, 0] > 0).astype(np.int32)


def _fraction_of_time(stop: Stop, count: int) -> Stop:
    """Return a stop after 1 / `count` of the remaining time; the same stop when there is no deadline."""
    return stop if stop.deadline is None else stop.within(stop.remaining() / count)


def route_shared(network: SupportNetwork, edges: SupportEdges) -> SupportEdges:
    """Connect the unconnected red squares through the supports of other parts.

    The router first connects them within the capacity that the flow of `edges` leaves. Red squares for which that
    does not suffice are connected by a maximum flow in one network of all parts. It starts from the flow of
    `edges` and exceeds capacities only where escalation allows it.

    Returns
    -------
    All edges, those of `edges` included.
    """
    for left in network.groups(network.unconnected()):
        if left.size:
            edges = _route_left(network, edges, left)
    return edges


def _route_left(network: SupportNetwork, edges: SupportEdges, left: Ints) -> SupportEdges:
    """Connect red squares beside the flow of `edges`; those of one part where parts have territories."""
    blocked = network.are_blocked(left, NO_VOXELS)
    network.explain(left[blocked], ENCLOSED)
    left = left[~blocked]
    if not left.size:
        return edges
    posed = network.pose(left, NO_VOXELS)
    reachable = find_reachable(posed.problem)[posed.number]
    network.explain(left[~reachable], ENCLOSED)
    left = left[reachable]
    earlier, unconnected = edges, network.unconnected()
    edges = SupportEdges.concatenate([edges, _route_within_capacity(network, edges, left)]).merged()
    if network.stop():
        network.explain(left[np.isin(left, network.unconnected())], OUT_OF_TIME)
        return edges
    left = left[np.isin(left, network.unconnected(CAPACITY))]
    if not left.size:
        return edges
    if network.territories:
        return _raise_capacities(network, edges, left)
    return _complete(network, (edges, network.unconnected()), (earlier, unconnected))


def _raise_capacities(network: SupportNetwork, edges: SupportEdges, left: Ints) -> SupportEdges:
    """Connect red squares of one part with capacities of their own beside the flow of `edges`, if that is allowed.

    The flow of other parts has to stay in their territories, so that one maximum flow for all parts is not possible.
    """
    if network.rules.escalation == "none":
        return edges
    more = network.connect(left, NO_VOXELS, network.stop, silent)
    return SupportEdges.concatenate([edges, _with_parts(more, network.red, left)]).merged()


def _route_within_capacity(network: SupportNetwork, edges: SupportEdges, left: Ints) -> SupportEdges:
    """Route reachable red squares beside the flow of `edges` without exceeding a capacity.

    The router does not know that flow. The squares where both flows together exceed a capacity are therefore
    closed, and all is routed again, until no capacity is exceeded.
    """
    rules, closed = network.rules, NO_VOXELS
    limit = rules.edge_limit(network.laid.grid, int(network.red.square[:, 0].max()))
    while left.size and not network.stop():
        network.rules = replace(rules, escalation="none")
        more = network.connect(left, closed, network.stop, silent)
        network.rules = rules
        network.explain(left[np.isin(left, network.unconnected(ENCLOSED))], CAPACITY)
        more = _with_parts(more, network.red, left)
        full = _exceeded(SupportEdges.concatenate([edges, more]).merged(), limit, rules.node_capacity)
        full = full[np.isin(square_keys(full), square_keys(voxels_below(more.upper)))]
        if not len(full):
            return more
        closed = np.concatenate([closed, full])
    return SupportEdges.from_rows([])


def _exceeded(edges: SupportEdges, edge_capacity: int, node_capacity: int) -> Ints:
    """Return the voxels below the upper squares where edges or squares exceed a capacity; 0 is no capacity."""
    over = np.zeros(len(edges), np.bool_)
    if edge_capacity:
        over |= edges.flow > edge_capacity
    if node_capacity:
        _, square = np.unique(square_keys(edges.upper), return_inverse=True)
        over |= np.bincount(square, weights=edges.flow)[square] > node_capacity
    return voxels_below(edges.upper[over])


def _complete(
    network: SupportNetwork, present: tuple[SupportEdges, Ints], earlier: tuple[SupportEdges, Ints]
) -> SupportEdges:
    """Return the edges of a maximum flow in one network of all parts, with escalation where that is allowed.

    Parameters
    ----------
    present, earlier
        The edges and the unconnected red squares of the flow to start from, and of the part of it that is kept if
        capacities are raised.
    """
    red_squares = _above_plate(network.red)
    posed = network.pose(red_squares, NO_VOXELS)
    starts = (_start_flow(posed, red_squares, *each) for each in (present, earlier))
    plan = complete_plan(posed.problem, *starts, stop=network.stop, progress=silent)
    return _with_parts(network.read(plan, posed, red_squares), network.red, red_squares)


def _start_flow(posed: PosedProblem, red_squares: Ints, edges: SupportEdges, unconnected: Ints) -> StartFlow:
    """Return a flow in the coordinates and numbers of a posed problem."""
    connected = np.zeros(len(posed.problem.red), np.bool_)
    connected[posed.number[~np.isin(red_squares, unconnected)]] = True
    plane, y, x = posed.corner
    inner = replace(edges, plane=edges.plane - plane, y=edges.y - y, x=edges.x - x)
    return StartFlow(inner, connected)


def _with_parts(edges: SupportEdges, red: RedSquares, red_squares: Ints) -> SupportEdges:
    """Assign each edge to the smallest part that has one of the numbered `red_squares` in its component."""
    component, of_red = edges.components(red.square[red_squares])
    smallest = np.full(
        int(max(component.max(initial=-1), of_red.max(initial=-1))) + 1, np.iinfo(np.int32).max
    )
    np.minimum.at(smallest, of_red, red.part[red_squares])
    return replace(edges, part=smallest[component])
