"""The router `push-relabel`: as many paths as fit, vertical edges before oblique ones (thesis 3.3)."""

import numpy as np

from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import maximise_flow
from amprep.flows.network import flow_problem_of, narrow_zero_flow
from amprep.flows.plans import exact_plan
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem


def route_push_relabel(problem: SupportProblem, *, stop: Stop, progress: Progress) -> SupportPlan:
    """Connect as many red squares as the capacities allow, or all reachable ones if these may be raised.

    The number is the greatest possible, unless the loop is stopped. The preference for vertical edges is a
    heuristic (thesis 3.3). The plan's objective is the number of connected red squares.
    """
    task = flow_problem_of(problem)
    flow, connected = narrow_zero_flow(task), np.zeros(len(task.start), np.bool_)
    connected, stop_reason = maximise_flow(task, flow, connected, stop=stop, progress=progress)
    if stop_reason == "finished":
        task, connected, stop_reason = escalate(task, flow, connected, stop=stop, progress=progress)
    return exact_plan(task, flow, connected, objective=float(connected.sum()), stop_reason=stop_reason)
