"""A support problem as the routing kernels see it: padded planes, flows, and the plan read back."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Bools, Int32s, Int64s
from amprep.errors import JobError
from amprep.kernels.flow.residual import UNREACHED, Carried, Flowing, Room, measure
from amprep.kernels.flow.shortest_paths import FAR, UNBOUNDED, Flows, Limits, Network
from amprep.model.supports import (
    CAPACITY,
    ENCLOSED,
    OUT_OF_TIME,
    Status,
    SupportPlan,
    SupportProblem,
    Unconnected,
    Voxel,
)
from amprep.model.supports.edges import DIRECTIONS, SupportEdges


def network_of(problem: SupportProblem) -> tuple[Network, Int64s]:
    """Return the network up to the highest red square, and the number of each red square in it."""
    _, ny, nx = problem.frame.shape
    width, stride = nx + 2, (nx + 2) * (ny + 2)
    top = int(problem.red[:, 0].max(initial=0))
    white = np.zeros((top + 1, ny + 2, width), np.uint8)
    white[:top, 1:-1, 1:-1] = problem.voxels[:top] == Voxel.FREE
    via = white.copy()
    via[1:] &= white[:-1]
    offset = np.array([dy * width + dx for dy, dx in DIRECTIONS], np.int64)
    plane, y, x = problem.red.astype(np.int64).T
    start = plane * stride + (y + 1) * width + x + 1
    return Network(via.reshape(-1), offset, _boxes(problem, top), stride, width), start


def _boxes(problem: SupportProblem, top: int) -> Int64s:
    """Return in each plane the rectangle that paths can reach, one square wider with every plane down."""
    _, ny, nx = problem.frame.shape
    box = np.full((top + 1, 4), (ny + 1, 0, nx + 1, 0), np.int64)
    plane, y, x = problem.red.T
    for column, values in ((0, y), (2, x)):
        np.minimum.at(box[:, column], plane, values + 1)
        np.maximum.at(box[:, column + 1], plane, values + 1)
    for p in range(top - 1, -1, -1):
        wider = box[p + 1] + (-1, 1, -1, 1)
        box[p, ::2] = np.maximum(np.minimum(box[p, ::2], wider[::2]), 1)
        box[p, 1::2] = np.minimum(np.maximum(box[p, 1::2], wider[1::2]), (ny, nx))
    return box


def no_flows(network: Network, most: int) -> Flows:
    """Return flows of zero on `network`, in a type that holds `most` paths."""
    squares = network.via.size
    kind: type[Any] = np.uint16 if most <= np.iinfo(np.uint16).max else np.int32
    return Flows(
        flow=np.zeros((squares, len(DIRECTIONS)), kind),
        through=np.zeros(squares, kind),
        special=np.zeros(squares, np.uint8),
        rows=np.zeros(squares // network.width, np.uint8),
        entry=np.full(squares, FAR, np.float32),
        dead=np.zeros(squares, np.int32),
        used=np.zeros(2, np.int64),
    )


def hard_limits(problem: SupportProblem) -> Limits:
    """Return the problem's capacities; squares on the plate are unbounded."""
    return Limits(problem.node_capacity or UNBOUNDED, UNBOUNDED, problem.edge_capacity or UNBOUNDED)


def plan_of(
    problem: SupportProblem,
    network: Network,
    flows: Flows | Carried,
    reasons: Iterable[tuple[int, str]],
    *,
    stop_reason: str,
) -> SupportPlan:
    """Read the plan from the flows; its objective is the material of the edges in use, mm3.

    Capacities are reported as the least ones that carry it: those asked for, and the flow where escalation
    has raised them; with ``uniform`` all edges are raised alike.
    """
    used = np.flatnonzero(flows.through)
    row, direction = np.nonzero(flows.flow[used])
    square = used[row]
    flow = flows.flow[square, direction].astype(np.int32)
    plane, rest = np.divmod(square, network.stride)
    y, x = np.divmod(rest, network.width)
    straight: Bools = direction == 0
    vertical, oblique = problem.material
    raised = _raised(problem, flow, flows.through[used[used >= network.stride]])
    asked = problem.edge_capacity + (raised if problem.escalation == "uniform" else 0)
    capacity = np.maximum(flow, asked if problem.edge_capacity else 0)
    return SupportPlan(
        SupportEdges(plane, y - 1, x - 1, direction.astype(np.uint8), flow, capacity),
        unconnected=tuple(Unconnected(red, reason) for red, reason in reasons),
        stop_reason=stop_reason,
        objective=float(straight.sum() * vertical + (~straight).sum() * oblique),
        raised=raised,
    )


def _raised(problem: SupportProblem, flow: Int32s, through: Flowing) -> int:
    """Return by how much flow exceeds the capacities asked for, at most."""
    edge = int(flow.max(initial=0)) - problem.edge_capacity if problem.edge_capacity else 0
    node = int(through.max(initial=0)) - problem.node_capacity if problem.node_capacity else 0
    return max(edge, node, 0)


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
    start: Int64s
    distance: Int32s
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
