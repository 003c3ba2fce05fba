"""The router `push-relabel`: as many paths as fit, straight rather than sideways (thesis 3.3)."""

import numpy as np

from amprep.kernels.flow_network import Carried
from amprep.kernels.flow_push_relabel import (
    Preflow,
    Progress,
    activate_all,
    discharge,
    relabel_all,
    send_back,
)
from amprep.model.arrays import Bools
from amprep.model.control import Report, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.supports.exact import Task, exact_plan, nothing_carried, task_of

_EFFORT = 14
"""Arcs looked at for each square of the network until all labels are set anew."""


def route_push_relabel(problem: SupportProblem, *, stop: Stop, report: Report) -> SupportPlan:
    """Connect as many red squares as the capacities allow.

    The number is the greatest possible, unless stopped; that straight edges are preferred is a rule of thumb
    (thesis 3.3). The plan's objective is the number of red squares connected.
    """
    task = task_of(problem)
    carried, connected, stop_reason = push_relabel(task, stop=stop, report=report)
    return exact_plan(
        task,
        carried,
        connected,
        status="optimal" if stop_reason == "finished" else "feasible",
        stop_reason=stop_reason,
        objective=float(connected.sum()),
    )


def push_relabel(task: Task, *, stop: Stop, report: Report) -> tuple[Carried, Bools, str]:
    """Return a flow of greatest value, which red squares it connects, and why it ended.

    All labels are set anew whenever the pushes since have cost about as much as that.
    """
    network, room = task.network, task.room
    carried = nothing_carried(task)
    preflow, progress = _preflow(2 * network.via.size), _progress()
    supply = np.zeros(network.via.size, np.uint8)
    supply[task.start[task.open]] = 1
    activate_all(preflow, progress, task.start[task.open])
    lists = tuple(np.empty(2 * network.via.size, np.int32) for _ in range(3))
    rounds, effort = 0, int(_EFFORT * network.via.size)
    stop_reason = "finished"
    while not discharge(network, carried, room, preflow, progress, effort):
        if stop():
            stop_reason = stop.reason
            break
        rounds += 1
        report(1.0 - 1.0 / (1.0 + rounds), "pushing flow down")
        relabel_all(network, carried, room, preflow, progress, *lists)
    send_back(network, carried, preflow, supply)
    return carried, task.open & (supply[task.start] == 1), stop_reason


def _preflow(states: int) -> Preflow:
    return Preflow(
        excess=np.zeros(states, np.int32),
        level=np.zeros(states, np.int32),
        arc=np.zeros(states, np.uint8),
        counts=np.zeros(states + 1, np.int32),
        raised=np.empty(states, np.int32),
        heads=np.zeros(states + 1, np.int32),
        below=np.empty(states, np.int32),
    )


def _progress() -> Progress:
    return Progress(np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64))
