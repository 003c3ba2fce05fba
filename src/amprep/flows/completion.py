"""Complete a plan that leaves red squares unconnected: exact, starting from the present flow."""

import numpy as np

from amprep.arrays import Bools
from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import maximise_flow
from amprep.flows.network import FlowProblem, flow_problem_of, zero_flow
from amprep.flows.plans import plan_from_flow
from amprep.kernels.flow.records import Capacities, Flow
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.model.supports.edges import SupportEdges


def complete_plan(
    problem: SupportProblem, edges: SupportEdges, connected: Bools, *, stop: Stop, progress: Progress
) -> SupportPlan:
    """Connect as many red squares as the capacities allow, or all reachable ones if these may be raised.

    The present flow is kept where possible and rerouted where necessary. Where it already exceeds a capacity, it
    may stay, but no more flow is added.

    Parameters
    ----------
    edges
        The flow to start from; each edge occurs once.
    connected
        ``(m,)`` the red squares whose paths are that flow.
    """
    task = flow_problem_of(problem)
    flow = _flow_on(task, edges)
    task = task._replace(capacities=_capacities(task.capacities, flow))
    connected, stop_reason = maximise_flow(task, flow, connected, stop=stop, progress=progress)
    if stop_reason == "finished":
        task, connected, stop_reason = escalate(task, flow, connected, stop=stop, progress=progress)
    return plan_from_flow(problem, task.network, flow, connected, task.reachable, stop_reason=stop_reason)


def _flow_on(task: FlowProblem, edges: SupportEdges) -> Flow:
    """Return the flow of a list of edges."""
    network = task.network
    on_edge = edges.flow.astype(np.int64)
    square = edges.plane.astype(np.int64) * network.stride + (edges.y + 1) * network.width + edges.x + 1
    flow = zero_flow(network, int(on_edge.sum()))
    flow.edge[square, edges.direction] = on_edge
    np.add.at(flow.square, square, on_edge.astype(flow.square.dtype))
    return flow


def _capacities(capacities: Capacities, flow: Flow) -> Capacities:
    """Return the capacity of each square and edge: that of the problem, or the present flow if it is greater."""
    return Capacities(
        np.maximum(flow.square, capacities.square[0]).astype(np.int32),
        np.maximum(flow.edge, capacities.edge[0]).astype(np.int32).reshape(-1),
        1,
    )
