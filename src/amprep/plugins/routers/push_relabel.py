"""The router `push-relabel`: as many paths as fit, vertical edges before oblique ones (thesis 3.3)."""

import numpy as np

from amprep.arrays import Bools
from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import maximise_flow
from amprep.flows.network import FlowProblem, flow_problem_of, narrow_zero_flow
from amprep.flows.plans import exact_plan
from amprep.kernels.flow.records import Flow
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem


def route_push_relabel(problem: SupportProblem, *, stop: Stop, progress: Progress) -> SupportPlan:
    """Connect as many red squares as the capacities allow, or all reachable ones if these may be raised.

    The number is the greatest possible, unless the loop is stopped. The preference for vertical edges is a
    heuristic (thesis 3.3). The plan's objective is the number of connected red squares.

    Where capacities are raised, the loop starts again with them: the paths that the smaller capacities have led
    around a full square may be long.
    """
    task = flow_problem_of(problem)
    flow, connected, stop_reason = _maximum_flow(task, stop, progress)
    if stop_reason != "finished":
        return _plan(task, flow, connected, stop_reason)
    raised, connected, stop_reason = escalate(task, flow, connected, stop=stop, progress=progress)
    if raised.capacities is not task.capacities and stop_reason == "finished":
        again, all_connected, stop_reason = _maximum_flow(raised, stop, progress)
        if stop_reason == "finished":
            flow, connected = again, all_connected
    return _plan(raised, flow, connected, stop_reason)


def _maximum_flow(task: FlowProblem, stop: Stop, progress: Progress) -> tuple[Flow, Bools, str]:
    """Return a maximum flow, the red squares that it connects, and why the loop ended."""
    flow, nothing = narrow_zero_flow(task), np.zeros(len(task.start), np.bool_)
    return flow, *maximise_flow(task, flow, nothing, stop=stop, progress=progress)


def _plan(task: FlowProblem, flow: Flow, connected: Bools, stop_reason: str) -> SupportPlan:
    return exact_plan(task, flow, connected, objective=float(connected.sum()), stop_reason=stop_reason)
