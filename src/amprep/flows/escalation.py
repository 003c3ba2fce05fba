"""Raises capacities until every red square that has a way to the plate is connected (thesis 3.3)."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Bytes, Int32s
from amprep.flows.maximum_flow import push
from amprep.flows.minimum_cut import Extender
from amprep.flows.network import Task
from amprep.kernels.flow.residual import Carried, Room
from amprep.model.control import Progress, Stop


class Cut(NamedTuple):
    """The arcs of a minimum cut that have a capacity.

    Attributes
    ----------
    squares
        ``(n,)`` the squares that let nothing more through.
    edges
        ``(k,)`` the edges that are full, as numbers into `Room.edge`.
    """

    squares: Int32s
    edges: Int32s


def escalate(
    task: Task, carried: Carried, connected: Bools, *, stop: Stop, progress: Progress
) -> tuple[Task, Bools, str]:
    """Connect the rest of the open red squares as `problem.escalation` says; return task, connected, reason.

    `carried` has to be of greatest value; it is modified in place: the flow so far stays (a warm start). The
    task that is returned has the raised capacities. With ``cut`` as many capacities as there are red squares
    left grow at a time, if so many are equally small: at least so many have to. With ``uniform`` all grow by
    the least number that can give a minimum cut room for all that are left.
    """
    escalation = task.problem.escalation
    if escalation == "none" or not (task.open & ~connected).any():
        return task, connected, "finished"
    if escalation == "cut":
        task = task._replace(room=_room_of_each(task))
    ground = np.full(task.network.stride, len(task.start), np.int32)
    extender, count = Extender(task.network, carried, ground), int((task.open & ~connected).sum())
    while (task.open & ~connected).any():
        if stop():
            return task, connected, stop.reason
        left = np.flatnonzero(task.open & ~connected)
        served, reached = extender.extend(task.room, task.start[left])
        connected = connected.copy()
        connected[left[served]] = True
        progress(1.0 - left.size / count, "raising capacities")
        if served.any():
            continue
        cut = _minimum_cut(task, np.sort(reached), extender.marks)
        if escalation == "cut":
            _raise_smallest(task.room, cut, left.size)
            continue
        task = task._replace(room=_raised_all(task, cut, left.size))
        connected, stop_reason = push(task, carried, connected, stop=stop, progress=progress)
        if stop_reason != "finished":
            return task, connected, stop_reason
    return task, connected, "finished"


def _minimum_cut(task: Task, reached: Int32s, marks: Bytes) -> Cut:
    """Return the arcs that lead out of the states `reached`; `marks` is a work array, 0 afterwards."""
    network = task.network
    marks[reached] = 1
    inward, outward = reached[reached % 2 == 0] // 2, reached[reached % 2 == 1] // 2
    squares = inward[(inward >= network.stride) & (marks[2 * inward + 1] == 0)]
    edges = []
    for direction, step in enumerate(network.offset):
        lower = outward - network.stride + step
        edges.append(5 * outward[(network.via[lower] == 1) & (marks[2 * lower] == 0)] + direction)
    marks[reached] = 0
    return Cut(squares, np.concatenate(edges))


def _raised_all(task: Task, cut: Cut, left: int) -> Room:
    """Return capacities that have all grown alike, by as much as the cut has to grow for those that are left."""
    room, problem = task.room, task.problem
    bounded = len(cut.squares) * (problem.node_capacity > 0) + len(cut.edges) * (problem.edge_capacity > 0)
    more = -(-left // bounded)
    return Room(
        room.square + more * (problem.node_capacity > 0),
        room.edge + more * (problem.edge_capacity > 0),
        room.each,
    )


def _raise_smallest(room: Room, cut: Cut, left: int) -> None:
    """Add one to the smallest capacities of a cut, in place; to no more of them than red squares are left.

    Of equal ones vertical edges come first, then squares, then oblique edges.
    """
    edge_ranks = np.where(cut.edges % 5 == 0, 0, 2)
    key = np.concatenate([3.0 * room.square[cut.squares] + 1, 3.0 * room.edge[cut.edges] + edge_ranks])
    chosen = np.flatnonzero(key == key.min())[:left]
    if chosen[0] < len(cut.squares):
        room.square[cut.squares[chosen]] += 1
    else:
        room.edge[cut.edges[chosen - len(cut.squares)]] += 1


def _room_of_each(task: Task) -> Room:
    """Return capacities of each square and edge by itself, as a copy."""
    room, squares = task.room, task.network.via.size
    if room.each:
        return Room(room.square.copy(), room.edge.copy(), 1)
    return Room(np.full(squares, room.square[0], np.int32), np.full(5 * squares, room.edge[0], np.int32), 1)
