"""Completes a plan that leaves red squares out: exact, and starting from the flow there is."""

import numpy as np

from amprep.arrays import Bools
from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import push
from amprep.flows.network import Task, no_flows, plan_of, reasons_of, task_of
from amprep.kernels.flow.residual import Carried, Room
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.model.supports.edges import SupportEdges


def complete(
    problem: SupportProblem, edges: SupportEdges, connected: Bools, *, stop: Stop, progress: Progress
) -> SupportPlan:
    """Connect as many red squares as the capacities allow, or all when these may be raised.

    The flow there is stays as far as it can; where it has to, it gives way sideways. Where it exceeds a
    capacity already, it may stay, but no more is let through.

    Parameters
    ----------
    edges
        The flow to start from; each edge occurs once.
    connected
        ``(m,)`` the red squares whose paths that flow is.
    """
    task = task_of(problem)
    carried = _carried(task, edges)
    task = task._replace(room=_room(task, carried))
    connected, stop_reason = push(task, carried, connected, stop=stop, progress=progress)
    if stop_reason == "finished":
        task, connected, stop_reason = escalate(task, carried, connected, stop=stop, progress=progress)
    reasons = reasons_of(connected, task.open, stop_reason)
    return plan_of(problem, task.network, carried, reasons, stop_reason=stop_reason)


def _carried(task: Task, edges: SupportEdges) -> Carried:
    """Return the edges' flow as the kernels see it."""
    network = task.network
    flow = edges.flow.astype(np.int64)
    square = edges.plane.astype(np.int64) * network.stride + (edges.y + 1) * network.width + edges.x + 1
    flows = no_flows(network, int(flow.sum()))
    flows.flow[square, edges.direction] = flow
    np.add.at(flows.through, square, flow.astype(flows.through.dtype))
    return Carried(flows.flow, flows.through)


def _room(task: Task, carried: Carried) -> Room:
    """Return capacities of each square and edge: those asked for, or what flows already."""
    square, edge = (limit[0] for limit in (task.room.square, task.room.edge))
    return Room(
        np.maximum(carried.through, square).astype(np.int32),
        np.maximum(carried.flow, edge).astype(np.int32).reshape(-1),
        1,
    )
