"""Read support plans from flows: edges, reasons for unconnected red squares, and raised capacities."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from amprep.arrays import Bools, Int32s
from amprep.flows.network import FlowProblem
from amprep.kernels.flow.records import Flow, FlowCounts, FlowNetwork
from amprep.model.supports import (
    CAPACITY,
    ENCLOSED,
    OUT_OF_TIME,
    SupportPlan,
    SupportProblem,
    Unconnected,
)
from amprep.model.supports.edges import SupportEdges


def plan_from_flow(
    problem: SupportProblem,
    network: FlowNetwork,
    flow: Flow,
    connected: Bools,
    reachable: Bools,
    *,
    stop_reason: str,
) -> SupportPlan:
    """Return the plan of a flow; its objective is the material of the edges in use, mm3.

    The plan reports the least capacities that carry the flow: the capacities of the problem, and the flow itself
    where escalation has raised them. With ``uniform`` all edges are raised alike.

    Parameters
    ----------
    connected, reachable
        ``(m,)`` the red squares that have a path, and those from which a path leads to the plate.
    """
    used = np.flatnonzero(flow.square)
    row, direction = np.nonzero(flow.edge[used])
    square = used[row]
    on_edge = flow.edge[square, direction].astype(np.int32)
    plane, rest = np.divmod(square, network.stride)
    y, x = np.divmod(rest, network.width)
    is_vertical: Bools = direction == 0
    vertical, oblique = problem.material
    raised = _raised(problem, on_edge, flow.square[used[used >= network.stride]])
    limit = problem.edge_capacity + (raised if problem.escalation == "uniform" else 0)
    capacity = np.maximum(on_edge, limit if problem.edge_capacity else 0)
    return SupportPlan(
        SupportEdges(plane, y - 1, x - 1, direction.astype(np.uint8), on_edge, capacity),
        unconnected=tuple(_unconnected(connected, reachable, stop_reason)),
        stop_reason=stop_reason,
        objective=float(is_vertical.sum() * vertical + (~is_vertical).sum() * oblique),
        raised=raised,
    )


def _raised(problem: SupportProblem, on_edge: Int32s, in_square: FlowCounts) -> int:
    """Return the greatest excess of flow over the capacities of the problem."""
    edge = int(on_edge.max(initial=0)) - problem.edge_capacity if problem.edge_capacity else 0
    node = int(in_square.max(initial=0)) - problem.node_capacity if problem.node_capacity else 0
    return max(edge, node, 0)


def _unconnected(connected: Bools, reachable: Bools, stop_reason: str) -> Iterator[Unconnected]:
    """Yield the red squares without a path: capacities or time forbid it, or the red square is not reachable."""
    left_out = CAPACITY if stop_reason == "finished" else OUT_OF_TIME
    for red in np.flatnonzero(~connected):
        yield Unconnected(int(red), left_out if reachable[red] else ENCLOSED)


def exact_plan(
    task: FlowProblem, flow: Flow, connected: Bools, *, objective: float, stop_reason: str
) -> SupportPlan:
    """Return the plan of an exact algorithm: optimal, with the objective as its bound, unless it was stopped."""
    plan = plan_from_flow(
        task.problem, task.network, flow, connected, task.reachable, stop_reason=stop_reason
    )
    if stop_reason != "finished":
        return replace(plan, status="feasible", objective=objective)
    return replace(plan, status="optimal", objective=objective, bound=objective)
