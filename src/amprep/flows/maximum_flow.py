"""Raise a flow to a maximum flow: the push-relabel loop."""

import numpy as np

from amprep.arrays import Bools
from amprep.flows.network import FlowProblem
from amprep.kernels.flow.push_relabel import (
    PushRelabelState,
    activate,
    discharge,
    relabel_globally,
    return_excess,
)
from amprep.kernels.flow.records import Flow, ResidualNetwork
from amprep.model.control import Progress, Stop

_EFFORT = 14
"""Arcs looked at for each square of the network between two global relabels."""

_SLICE = 10_000_000
"""Arcs looked at between two calls of `stop`: a fraction of a second."""


def maximise_flow(
    task: FlowProblem, flow: Flow, connected: Bools, *, stop: Stop, progress: Progress
) -> tuple[Bools, str]:
    """Raise a flow to a maximum flow; return the red squares that it connects, and why the loop ended.

    Levels of 0 are valid for any flow, but slow for a congested one. So levels are set by a global relabel at
    once if there is flow already, and again whenever the pushes since the last one have cost more than a relabel.

    Parameters
    ----------
    flow
        Flow of the red squares `connected`; modified in place.
    connected
        ``(m,)`` the red squares that have a path.

    Returns
    -------
    (m,) bool, str
        The red squares that have a path now, and ``"finished"`` or the reason of `stop`.
    """
    residual, states = ResidualNetwork(task.network, flow, task.capacities), 2 * task.network.passable.size
    work = _initial_state(states)
    supplied = np.zeros(task.network.passable.size, np.uint8)
    supplied[task.start[task.reachable]] = 1
    activate(work, task.start[task.reachable & ~connected])
    lists = tuple(np.empty(states, np.int32) for _ in range(3))
    rounds, effort = 0, int(_EFFORT * task.network.passable.size)
    if connected.any():
        relabel_globally(residual, work, *lists)
    stop_reason, left = "finished", effort
    while not discharge(residual, work, min(left, _SLICE)):
        if stop():
            stop_reason = stop.reason
            break
        left -= _SLICE
        if left <= 0:
            rounds, left = rounds + 1, effort
            progress(1.0 - 1.0 / (1.0 + rounds), "computing a maximum flow")
            relabel_globally(residual, work, *lists)
    return_excess(residual, work, supplied)
    return task.reachable & (supplied[task.start] == 1), stop_reason


def _initial_state(states: int) -> PushRelabelState:
    return PushRelabelState(
        excess=np.zeros(states, np.int32),
        level=np.zeros(states, np.int32),
        current_arc=np.zeros(states, np.uint8),
        level_count=np.zeros(states + 1, np.int32),
        raised=np.empty(states, np.int32),
        bucket=np.zeros(states + 1, np.int32),
        below=np.empty(states, np.int32),
        lowest=np.zeros(1, np.int64),
        highest=np.zeros(1, np.int64),
        raised_count=np.zeros(1, np.int64),
    )
