"""Complete a plan that leaves red squares unconnected: exact, starting from the present flow."""

from typing import NamedTuple

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


class StartFlow(NamedTuple):
    """A flow to start from: its edges, each once, and the red squares ``(m,)`` bool whose paths are that flow."""

    edges: SupportEdges
    connected: Bools


def complete_plan(
    problem: SupportProblem, present: StartFlow, earlier: StartFlow, *, stop: Stop, progress: Progress
) -> SupportPlan:
    """Connect as many red squares as the capacities allow, or all reachable ones if these may be raised.

    The present flow is kept where possible and rerouted where necessary. Where it already exceeds a capacity, it
    may stay, but no more flow is added. Where capacities are raised, paths that the smaller ones have led around a
    full square may be long. All paths but the earlier ones are then routed again, and the plan of less material is
    returned.

    Parameters
    ----------
    present, earlier
        The flow to start from, and the part of it that is kept if capacities are raised.
    """
    task = flow_problem_of(problem)
    flow = _flow_on(task, present.edges)
    task = task._replace(capacities=_capacities(task.capacities, flow))
    connected, stop_reason = maximise_flow(task, flow, present.connected, stop=stop, progress=progress)
    if stop_reason != "finished":
        return _plan(task, flow, connected, stop_reason)
    raised, connected, stop_reason = escalate(task, flow, connected, stop=stop, progress=progress)
    plan = _plan(raised, flow, connected, stop_reason)
    if raised.capacities is task.capacities or stop_reason != "finished":
        return plan
    flow = _flow_on(raised, earlier.edges)
    connected, stop_reason = maximise_flow(raised, flow, earlier.connected, stop=stop, progress=progress)
    again = _plan(raised, flow, connected, stop_reason)
    return min(plan, again, key=lambda each: (len(each.unconnected), each.objective))


def _plan(task: FlowProblem, flow: Flow, connected: Bools, stop_reason: str) -> SupportPlan:
    return plan_from_flow(
        task.problem, task.network, flow, connected, task.reachable, stop_reason=stop_reason
    )


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
