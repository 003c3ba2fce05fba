"""Pushes what flows already to a flow of greatest value: the loop of push-relabel."""

import numpy as np

from amprep.arrays import Bools
from amprep.flows.network import Task
from amprep.kernels.flow.push_relabel import (
    Discharging,
    Preflow,
    activate_all,
    discharge,
    relabel_all,
    send_back,
)
from amprep.kernels.flow.residual import Carried
from amprep.model.control import Progress, Stop

_EFFORT = 14
"""Arcs looked at for each square of the network until all labels are set anew."""

_SLICE = 10_000_000
"""Arcs looked at between two questions whether to stop: a fraction of a second."""


def push(
    task: Task, carried: Carried, connected: Bools, *, stop: Stop, progress: Progress
) -> tuple[Bools, str]:
    """Make the flow as great as it can be; return which red squares it connects, and why it ended.

    Labels of 0 are right for any flow, but slow for one that is jammed: they are set anew at once when there
    is flow already, and whenever the pushes since have cost more than that.

    Parameters
    ----------
    carried
        Modified in place; has to be the flow of the red squares `connected`.
    """
    network, room = task.network, task.room
    preflow, discharging = _preflow(2 * network.via.size), _discharging()
    supply = np.zeros(network.via.size, np.uint8)
    supply[task.start[task.open]] = 1
    activate_all(preflow, discharging, task.start[task.open & ~connected])
    lists = tuple(np.empty(2 * network.via.size, np.int32) for _ in range(3))
    rounds, effort = 0, int(_EFFORT * network.via.size)
    if connected.any():
        relabel_all(network, carried, room, preflow, discharging, *lists)
    stop_reason, left = "finished", effort
    while not discharge(network, carried, room, preflow, discharging, min(left, _SLICE)):
        if stop():
            stop_reason = stop.reason
            break
        left -= _SLICE
        if left <= 0:
            rounds, left = rounds + 1, effort
            progress(1.0 - 1.0 / (1.0 + rounds), "pushing flow down")
            relabel_all(network, carried, room, preflow, discharging, *lists)
    send_back(network, carried, preflow, supply)
    return task.open & (supply[task.start] == 1), stop_reason


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


def _discharging() -> Discharging:
    return Discharging(np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64))
