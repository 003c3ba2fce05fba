"""What the exact routers share: the pruned network, nothing flowing yet, and the plan read back."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from amprep.errors import JobError
from amprep.kernels.flow_network import UNREACHED, Carried, Room, measure
from amprep.kernels.routing import Ints, Longs, Network
from amprep.model.arrays import Bools
from amprep.model.supports import CAPACITY, ENCLOSED, OUT_OF_TIME, Status, SupportPlan, SupportProblem
from amprep.plugins.supports.network import network_of, plan_of


class Task(NamedTuple):
    """A problem ready for exact routing.

    Attributes
    ----------
    network
        Pruned: squares without a way to the plate let nothing in.
    start
        ``(m,)`` number of each red square in the network.
    distance
        ``(squares,)`` least cost of a way to the plate; `UNREACHED` where there is none.
    open
        ``(m,)`` bool, the red squares that have a way.
    """

    problem: SupportProblem
    network: Network
    start: Longs
    distance: Ints
    open: Bools
    room: Room


def task_of(problem: SupportProblem) -> Task:
    """Return the network of a problem with all distances; a capacity of 0 becomes one that never binds.

    Raises
    ------
    JobError
        When the costs of a way can add up to more than `UNREACHED`.
    """
    network, start = network_of(problem)
    if network.box.shape[0] * max(problem.costs) >= UNREACHED:
        raise uncountable(problem)
    distance = np.full(network.via.size, UNREACHED, np.int32)
    straight, oblique = problem.costs
    measure(network, straight, oblique, distance)
    ways = distance[start[:, None] - network.stride + network.offset] + [straight, *[oblique] * 4]
    distance[start] = np.minimum(ways.min(axis=1, initial=UNREACHED), UNREACHED)
    square, edge = problem.node_capacity or len(start), problem.edge_capacity or len(start)
    room = Room(np.array([square], np.int32), np.array([edge], np.int32), 0)
    return Task(problem, network, start, distance, distance[start] < UNREACHED, room)


def uncountable(problem: SupportProblem) -> JobError:
    """Return the error that a problem's costs are too high for its planes."""
    return JobError(
        f"costs of {problem.costs[0]} and {problem.costs[1]} an edge add up to more than can be counted over "
        f"{int(problem.red[:, 0].max(initial=0))} planes: choose smaller ones (supports.vertical_cost, oblique_cost)"
    )


def nothing_carried(task: Task) -> Carried:
    """Return flows of zero, in the narrowest type that holds as many paths as may meet."""
    squares, most = task.network.via.size, len(task.start)
    if task.problem.node_capacity and task.problem.escalation == "none":
        most = min(most, task.problem.node_capacity)
    kinds: tuple[type[Any], ...] = (np.uint8, np.uint16, np.int32)
    kind = next(kind for kind in kinds if most <= np.iinfo(kind).max)
    flow, through = np.zeros((squares, 5), kind), np.zeros(squares, kind)
    return Carried(flow, through)


def exact_plan(
    task: Task, carried: Carried, connected: Bools, *, status: Status, stop_reason: str, objective: float
) -> SupportPlan:
    """Read the plan from the flows; an optimal one proves its own objective."""
    reasons = reasons_of(connected, task.open, stop_reason)
    plan = plan_of(task.problem, task.network, carried, reasons, stop_reason=stop_reason)
    bound = objective if status == "optimal" else None
    return replace(plan, status=status, objective=objective, bound=bound)


def reasons_of(connected: Bools, way: Bools, stop_reason: str) -> Iterable[tuple[int, str]]:
    """Yield the red squares left and why: others fill their way, it was not found in time, or there is none."""
    for red in np.flatnonzero(~connected):
        yield int(red), (CAPACITY if stop_reason == "finished" else OUT_OF_TIME) if way[red] else ENCLOSED
