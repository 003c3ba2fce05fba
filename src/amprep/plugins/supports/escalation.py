"""Raises capacities until every red square that has a way to the plate is connected (thesis 3.3)."""

import numpy as np

from amprep.kernels.flow_cut import reach
from amprep.kernels.flow_network import Carried, Room
from amprep.kernels.routing import Longs
from amprep.model.arrays import Bools
from amprep.model.control import Report, Stop
from amprep.plugins.supports.exact import Task
from amprep.plugins.supports.pushing import push


def escalate(
    task: Task, carried: Carried, connected: Bools, *, stop: Stop, report: Report
) -> tuple[Task, Bools, str]:
    """Connect the rest of the open red squares as `problem.escalation` says; return task, connected, reason.

    `carried` has to be of greatest value; it is modified in place: the flow so far stays (a warm start). The
    task that is returned has the raised capacities. With ``cut`` as many capacities as there are red squares
    left grow at a time, if so many are equally small: at least so many have to.
    """
    raise_all = task.problem.escalation == "uniform"
    while task.problem.escalation != "none" and (task.open & ~connected).any():
        if stop():
            return task, connected, stop.reason
        left = task.start[task.open & ~connected]
        room = _raised_all(task) if raise_all else _raised_cut(task, carried, left)
        task = task._replace(room=room)
        connected, stop_reason = push(task, carried, connected, stop=stop, report=report)
        if stop_reason != "finished":
            return task, connected, stop_reason
    return task, connected, "finished"


def _raised_all(task: Task) -> Room:
    room, problem = task.room, task.problem
    return Room(room.square + (problem.node_capacity > 0), room.edge + (problem.edge_capacity > 0), room.each)


def _raised_cut(task: Task, carried: Carried, left: Longs) -> Room:
    """Add one to the smallest capacities of the minimum cut nearest to the red squares `left`.

    Of equal ones vertical edges come first, then squares, then oblique edges; no more than `left` has squares.
    """
    network, room = task.network, _room_of_each(task)
    seen, reached = np.zeros(2 * network.via.size, np.uint8), np.empty(2 * network.via.size, np.int32)
    reached = np.sort(reached[: reach(network, carried, task.room, left, seen, reached)])
    inward, outward = reached[reached % 2 == 0] // 2, reached[reached % 2 == 1] // 2
    cut = inward[(inward >= network.stride) & (seen[2 * inward + 1] == 0)]
    places, capacities, ranks = [cut], [room.square[cut]], [np.ones(len(cut))]
    for direction, step in enumerate(network.offset):
        lower = outward - network.stride + step
        cut = 5 * outward[(network.via[lower] == 1) & (seen[2 * lower] == 0)] + direction
        places.append(cut)
        capacities.append(room.edge[cut])
        ranks.append(np.full(len(cut), 2.0 if direction else 0.0))
    place, capacity, rank = (np.concatenate(each) for each in (places, capacities, ranks))
    key = capacity * 3.0 + rank
    chosen = np.flatnonzero(key == key.min())[: len(left)]
    grown = room.square if rank[chosen[0]] == 1 else room.edge
    grown[place[chosen]] += 1
    return room


def _room_of_each(task: Task) -> Room:
    """Return capacities of each square and edge by itself, as a copy."""
    room, squares = task.room, task.network.via.size
    if room.each:
        return Room(room.square.copy(), room.edge.copy(), 1)
    return Room(np.full(squares, room.square[0], np.int32), np.full(5 * squares, room.edge[0], np.int32), 1)
