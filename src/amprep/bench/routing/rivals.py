"""Solve support problems with OR-tools, scipy and networkx for comparison."""

import time
from collections.abc import Callable
from typing import NamedTuple

from amprep.model.supports import SupportProblem
from amprep.model.supports.graph import SupportGraph, support_graph, to_networkx


class Rival(NamedTuple):
    """Another solver.

    Attributes
    ----------
    router
        Our router that it is compared with: `push-relabel` for maximum flow, else `min-cost-flow`.
    package
        The package that it needs.
    max_squares
        Number of squares up to which it takes at most minutes.
    solve
        Returns the maximum flow, its minimum cost (None for maximum-flow solvers), and the time of solving
        alone (s).
    """

    name: str
    router: str
    package: str
    max_squares: int
    solve: Callable[[SupportProblem], tuple[int, int | None, float]]


def _ortools_max_flow(problem: SupportProblem) -> tuple[int, int | None, float]:
    from ortools.graph.python import max_flow

    graph, solver = _graph(problem), max_flow.SimpleMaxFlow()
    solver.add_arcs_with_capacity(graph.tail, graph.head, graph.capacity)
    start = time.process_time()
    solver.solve(graph.source, graph.sink)
    return int(solver.optimal_flow()), None, time.process_time() - start


def _ortools_min_cost(problem: SupportProblem) -> tuple[int, int | None, float]:
    from ortools.graph.python import min_cost_flow

    graph, solver, count = _graph(problem), min_cost_flow.SimpleMinCostFlow(), len(problem.red)
    solver.add_arcs_with_capacity_and_unit_cost(graph.tail, graph.head, graph.capacity, graph.cost)
    solver.set_nodes_supplies([graph.source, graph.sink], [count, -count])
    start = time.process_time()
    solver.solve_max_flow_with_min_cost()
    return int(solver.maximum_flow()), int(solver.optimal_cost()), time.process_time() - start


def _scipy_max_flow(problem: SupportProblem) -> tuple[int, int | None, float]:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_flow

    graph = _graph(problem)
    nodes = graph.sink + 1
    matrix = csr_array((graph.capacity, (graph.tail, graph.head)), shape=(nodes, nodes))
    start = time.process_time()
    value = maximum_flow(matrix, graph.source, graph.sink).flow_value
    return int(value), None, time.process_time() - start


def _networkx_max_flow(problem: SupportProblem) -> tuple[int, int | None, float]:
    import networkx as nx

    graph = to_networkx(problem)
    start = time.process_time()
    value = nx.maximum_flow_value(graph, "source", "sink")
    return int(value), None, time.process_time() - start


def _networkx_min_cost(problem: SupportProblem) -> tuple[int, int | None, float]:
    import networkx as nx

    graph = to_networkx(problem)
    start = time.process_time()
    flow = nx.max_flow_min_cost(graph, "source", "sink")
    took = time.process_time() - start
    return sum(flow["source"].values()), int(nx.cost_of_flow(graph, flow)), took


def _graph(problem: SupportProblem) -> SupportGraph:
    """Return the graph after two rounds that drop the arcs at nodes without an arc in or without an arc out."""
    import numpy as np

    graph = support_graph(problem)
    keep = np.ones(len(graph.tail), np.bool_)
    for _ in range(2):
        entered = np.bincount(graph.head[keep], minlength=graph.sink + 1) > 0
        left = np.bincount(graph.tail[keep], minlength=graph.sink + 1) > 0
        entered[graph.source] = left[graph.sink] = True
        keep &= entered[graph.tail] & left[graph.head]
    return graph._replace(
        tail=graph.tail[keep], head=graph.head[keep], capacity=graph.capacity[keep], cost=graph.cost[keep]
    )


RIVALS = (
    Rival("or-tools max-flow", "push-relabel", "ortools", 10_000_000, _ortools_max_flow),
    Rival("scipy max-flow", "push-relabel", "scipy", 10_000_000, _scipy_max_flow),
    Rival("networkx max-flow", "push-relabel", "networkx", 30_000, _networkx_max_flow),
    Rival("or-tools min-cost-flow", "min-cost-flow", "ortools", 1_500_000, _ortools_min_cost),
    Rival("networkx min-cost-flow", "min-cost-flow", "networkx", 10_000, _networkx_min_cost),
)
