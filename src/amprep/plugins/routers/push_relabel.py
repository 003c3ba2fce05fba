"""The router `push-relabel`: as many paths as fit, straight rather than sideways (thesis 3.3)."""

import numpy as np

from amprep.flows.escalation import escalate
from amprep.flows.maximum_flow import push
from amprep.flows.network import exact_plan, nothing_carried, task_of
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem


def route_push_relabel(problem: SupportProblem, *, stop: Stop, progress: Progress) -> SupportPlan:
    """Connect as many red squares as the capacities allow, or all when these may be raised.

    The number is the greatest possible, unless stopped; that straight edges are preferred is a rule of thumb
    (thesis 3.3). The plan's objective is the number of red squares connected.
    """
    task = task_of(problem)
    carried, nobody = nothing_carried(task), np.zeros(len(task.start), np.bool_)
    connected, stop_reason = push(task, carried, nobody, stop=stop, progress=progress)
    if stop_reason == "finished":
        task, connected, stop_reason = escalate(task, carried, connected, stop=stop, progress=progress)
    return exact_plan(
        task,
        carried,
        connected,
        status="optimal" if stop_reason == "finished" else "feasible",
        stop_reason=stop_reason,
        objective=float(connected.sum()),
    )
