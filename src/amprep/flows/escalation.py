"""Raise capacities until every reachable red square is connected (thesis 3.3)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Bytes, Int32s
from amprep.flows.augmentation import Augmentation
from amprep.flows.maximum_flow import maximise_flow
from amprep.flows.network import FlowProblem
from amprep.kernels.flow.records import Capacities, Flow
from amprep.model.control import Progress, Stop


class MinimumCut(NamedTuple):
    """The saturated arcs of a minimum cut.

    Attributes
    ----------
    squares
        ``(n,)`` squares through which no more flow can pass.
    edges
        ``(k,)`` full edges, as indices into `Capacities.edge`.
    """

    squares: Int32s
    edges: Int32s


def escalate(
    task: FlowProblem, flow: Flow, connected: Bools, *, stop: Stop, progress: Progress
) -> tuple[FlowProblem, Bools, str]:
    """Connect the other reachable red squares by raising capacities as `problem.escalation` says.

    With ``cut``, the smallest capacities of a minimum cut grow by 1 each. In each step their number is that of the
    red squares that are left, because at least that many have to grow. With ``uniform``, all capacities grow alike,
    by the least number that can give the minimum cut enough capacity for all red squares that are left.

    Parameters
    ----------
    flow
        A maximum flow; it is augmented in place.
    connected
        ``(m,)`` the red squares whose paths are that flow.

    Returns
    -------
    FlowProblem, (m,) bool, str
        The problem with the raised capacities, the red squares connected now, and ``"finished"`` or the reason
        of `stop`.
    """
    escalation = task.problem.escalation
    if escalation == "none" or not (task.reachable & ~connected).any():
        return task, connected, "finished"
    if escalation == "cut":
        task = task._replace(capacities=_capacities_of_each(task))
    plate_capacity = np.full(task.network.stride, len(task.start), np.int32)
    augmentation = Augmentation(task.network, flow, plate_capacity)
    count = int((task.reachable & ~connected).sum())
    while (task.reachable & ~connected).any():
        if stop():
            return task, connected, stop.reason
        left = np.flatnonzero(task.reachable & ~connected)
        served, reached = augmentation.augment(task.capacities, task.start[left])
        connected = connected.copy()
        connected[left[served]] = True
        progress(1.0 - left.size / count, "raising capacities")
        if served.any():
            continue
        cut = _minimum_cut(task, np.sort(reached), augmentation.marks)
        if escalation == "cut":
            _raise_smallest(task.capacities, cut, left.size)
            continue
        task = task._replace(capacities=_raise_all(task, cut, left.size))
        connected, stop_reason = maximise_flow(task, flow, connected, stop=stop, progress=progress)
        if stop_reason != "finished":
            return task, connected, stop_reason
    return task, connected, "finished"


def _minimum_cut(task: FlowProblem, reached: Int32s, marks: Bytes) -> MinimumCut:
    """Return the arcs that lead out of the states `reached`; `marks` is a work array, 0 before and after."""
    network = task.network
    marks[reached] = 1
    inward, outward = reached[reached % 2 == 0] // 2, reached[reached % 2 == 1] // 2
    squares = inward[(inward >= network.stride) & (marks[2 * inward + 1] == 0)]
    edges = []
    for direction, step in enumerate(network.offset):
        lower = outward - network.stride + step
        edges.append(5 * outward[(network.passable[lower] == 1) & (marks[2 * lower] == 0)] + direction)
    marks[reached] = 0
    return MinimumCut(squares, np.concatenate(edges))


def _raise_all(task: FlowProblem, cut: MinimumCut, left: int) -> Capacities:
    """Return capacities that have all grown alike, by the least number that lets `left` more units through `cut`."""
    capacities, problem = task.capacities, task.problem
    bounded = len(cut.squares) * (problem.node_capacity > 0) + len(cut.edges) * (problem.edge_capacity > 0)
    more = -(-left // bounded)
    return Capacities(
        capacities.square + more * (problem.node_capacity > 0),
        capacities.edge + more * (problem.edge_capacity > 0),
        capacities.each,
    )


def _raise_smallest(capacities: Capacities, cut: MinimumCut, left: int) -> None:
    """Add 1 to the smallest capacities of a cut, in place; to at most `left` of them.

    Of equal capacities, those of vertical edges come first, then squares, then oblique edges.
    """
    edge_rank = np.where(cut.edges % 5 == 0, 0, 2)
    key = np.concatenate(
        [3.0 * capacities.square[cut.squares] + 1, 3.0 * capacities.edge[cut.edges] + edge_rank]
    )
    chosen = np.flatnonzero(key == key.min())[:left]
    if chosen[0] < len(cut.squares):
        capacities.square[cut.squares[chosen]] += 1
    else:
        capacities.edge[cut.edges[chosen - len(cut.squares)]] += 1


def _capacities_of_each(task: FlowProblem) -> Capacities:
    """Return a copy of the capacities with a number for each square and edge."""
    capacities, squares = task.capacities, task.network.passable.size
    if capacities.each:
        return Capacities(capacities.square.copy(), capacities.edge.copy(), 1)
    return Capacities(
        np.full(squares, capacities.square[0], np.int32),
        np.full(5 * squares, capacities.edge[0], np.int32),
        1,
    )
