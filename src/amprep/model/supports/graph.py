"""Build the support graph edge by edge, for judges, other solvers and tests; routers never store it."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Ints
from amprep.model.supports import SupportProblem, Voxel
from amprep.model.supports.edges import DIRECTIONS

if TYPE_CHECKING:
    import networkx as nx


class SupportGraph(NamedTuple):
    """A flow network with one source and one sink.

    The square ``(p, y, x)`` has the number ``i = (p * ny + y) * nx + x`` and two nodes: paths enter it at node 2 i
    and leave it at node 2 i + 1. The arc between the two has the capacity of the square.

    Attributes
    ----------
    tail, head, capacity, cost
        ``(n,)`` int32, the arcs. The capacity of an unbounded arc is the number of red squares plus 1.
    source, sink
        Their nodes.
    """

    tail: Ints
    head: Ints
    capacity: Ints
    cost: Ints
    source: int
    sink: int


def support_graph(problem: SupportProblem, *, raised: int = 0) -> SupportGraph:
    """Return the graph of a problem, with `raised` added to each of its capacities.

    Arcs lead from the source to every red square, through each square, along each edge, and from every green
    square to the sink. The graph takes about 250 bytes for each square.
    """
    nz, ny, nx = problem.voxels.shape
    free, unbounded = problem.voxels == Voxel.FREE, len(problem.red) + 1
    number = np.arange((nz + 1) * ny * nx, dtype=np.int32).reshape(nz + 1, ny, nx)
    source, sink = 2 * number.size, 2 * number.size + 1
    edge = problem.edge_capacity + raised if problem.edge_capacity else unbounded
    node = problem.node_capacity + raised if problem.node_capacity else unbounded
    above = number[1:].reshape(-1)
    red = number[tuple(problem.red.T)]
    green = number[0][problem.green]
    blocks = [(2 * above, 2 * above + 1, node, 0), (2 * green, np.full_like(green, sink), unbounded, 0)]
    blocks.append((np.full_like(red, source), 2 * red, 1, 0))
    for direction, step in enumerate(DIRECTIONS):
        upper = tuple(slice(max(-d, 0), n - max(d, 0)) for d, n in zip(step, (ny, nx), strict=True))
        lower = tuple(slice(max(d, 0), n - max(-d, 0)) for d, n in zip(step, (ny, nx), strict=True))
        exists = free[:, *upper] & free[:, *lower]
        cost = problem.costs[direction > 0]
        blocks.append((2 * number[1:, *upper][exists] + 1, 2 * number[:-1, *lower][exists], edge, cost))
    tail, head = (np.concatenate([block[i] for block in blocks]).astype(np.int32) for i in (0, 1))
    sizes = [len(block[0]) for block in blocks]
    capacity, cost_of = (np.repeat([block[i] for block in blocks], sizes).astype(np.int32) for i in (2, 3))
    return SupportGraph(tail, head, capacity, cost_of, source, sink)


def to_networkx(problem: SupportProblem) -> "nx.DiGraph":
    """Return the graph of a small problem, with `capacity` and `weight` on its arcs.

    Nodes are ``("in", p, y, x)`` and ``("out", p, y, x)`` for each square, ``"source"`` and ``"sink"``; arcs
    without a `capacity` are unbounded. It takes some kilobytes for each square; use it for up to about 100,000 squares.
    """
    import networkx as nx

    graph = support_graph(problem)
    _, height, width = problem.voxels.shape
    names = {graph.source: "source", graph.sink: "sink"}

    def name(node: int) -> object:
        plane, rest = divmod(node >> 1, height * width)
        return names.get(node) or (("in", "out")[node & 1], plane, rest // width, rest % width)

    result = nx.DiGraph()
    result.add_nodes_from(["source", "sink"])
    arcs = (each.tolist() for each in (graph.tail, graph.head, graph.capacity, graph.cost))
    for tail, head, capacity, cost in zip(*arcs, strict=True):
        room = {} if capacity > len(problem.red) else {"capacity": capacity}
        result.add_edge(name(tail), name(head), weight=cost, **room)
    return result
