"""A support problem as a flow problem: the network, distances to the plate, and capacities."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Bools, Int32s, Int64s
from amprep.errors import JobError
from amprep.kernels.flow.records import UNREACHABLE, Capacities, Flow, FlowNetwork
from amprep.kernels.flow.residual import find_distances
from amprep.model.supports import SupportProblem, Voxel
from amprep.model.supports.edges import DIRECTIONS


class FlowProblem(NamedTuple):
    """A support problem ready for maximum flow and minimum-cost flow.

    Attributes
    ----------
    network
        Squares from which no path leads to the plate are impassable in it.
    start
        ``(m,)`` number of each red square in the network.
    distance
        ``(squares,)`` least cost of a path to the plate, or `UNREACHABLE`.
    reachable
        ``(m,)`` the red squares from which a path leads to the plate.
    """

    problem: SupportProblem
    network: FlowNetwork
    start: Int64s
    distance: Int32s
    reachable: Bools
    capacities: Capacities


def flow_problem_of(problem: SupportProblem) -> FlowProblem:
    """Return the flow problem of a support problem; a capacity of 0 becomes one that never binds.

    Raises
    ------
    JobError
        If the costs of a path can add up to more than `UNREACHABLE`.
    """
    network, start = build_network(problem)
    if network.box.shape[0] * max(problem.costs) >= UNREACHABLE:
        raise cost_overflow(problem)
    distance = distances_of(network, start, problem.costs)
    square, edge = problem.node_capacity or len(start), problem.edge_capacity or len(start)
    capacities = Capacities(np.array([square], np.int32), np.array([edge], np.int32), 0)
    return FlowProblem(problem, network, start, distance, distance[start] < UNREACHABLE, capacities)


def cost_overflow(problem: SupportProblem) -> JobError:
    """Return the error that the costs of a path exceed 32 bits."""
    return JobError(
        f"the costs of a path must fit 32 bits, got edges of {problem.costs[0]} and {problem.costs[1]} over "
        f"{int(problem.red[:, 0].max(initial=0))} planes; reduce supports.vertical_cost and supports.oblique_cost"
    )


def build_network(problem: SupportProblem) -> tuple[FlowNetwork, Int64s]:
    """Return the network up to the highest red square, and the number of each red square in it."""
    _, ny, nx = problem.grid.shape
    width, stride = nx + 2, (nx + 2) * (ny + 2)
    top = int(problem.red[:, 0].max(initial=0))
    free = np.zeros((top + 1, ny + 2, width), np.uint8)
    free[:top, 1:-1, 1:-1] = problem.voxels[:top] == Voxel.FREE
    passable = free.copy()
    passable[1:] &= free[:-1]
    offset = np.array([dy * width + dx for dy, dx in DIRECTIONS], np.int64)
    plane, y, x = problem.red.astype(np.int64).T
    start = plane * stride + (y + 1) * width + x + 1
    return FlowNetwork(passable.reshape(-1), offset, _boxes(problem, top), stride, width), start


def _boxes(problem: SupportProblem, top: int) -> Int64s:
    """Return the rectangle that paths can reach in each plane: one square wider with every plane down."""
    _, ny, nx = problem.grid.shape
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


def distances_of(network: FlowNetwork, start: Int64s, costs: tuple[int, int]) -> Int32s:
    """Return the least cost of a path from each square to the plate, or `UNREACHABLE`.

    Squares from which no path leads to the plate become impassable in `network`.

    Parameters
    ----------
    start
        ``(m,)`` squares with red squares above them; their distances hold although no path arrives there.
    costs
        Cost of one unit over a vertical and over an oblique edge.
    """
    distance = np.full(network.passable.size, UNREACHABLE, np.int32)
    vertical, oblique = costs
    find_distances(network, vertical, oblique, distance)
    over_edges = distance[start[:, None] - network.stride + network.offset] + [vertical, *[oblique] * 4]
    distance[start] = np.minimum(over_edges.min(axis=1, initial=UNREACHABLE), UNREACHABLE)
    return distance


def zero_flow(network: FlowNetwork, most: int, types: Sequence[type[Any]] = (np.uint16, np.int32)) -> Flow:
    """Return a flow of zero, in the first of `types` that can count to `most`."""
    squares = network.passable.size
    chosen = next(each for each in types if most <= np.iinfo(each).max)
    return Flow(np.zeros((squares, len(DIRECTIONS)), chosen), np.zeros(squares, chosen))


def narrow_zero_flow(task: FlowProblem) -> Flow:
    """Return a flow of zero in the narrowest type that can count the paths that may meet in a square."""
    most, problem = len(task.start), task.problem
    if problem.node_capacity and problem.escalation == "none":
        most = min(most, problem.node_capacity)
    return zero_flow(task.network, most, (np.uint8, np.uint16, np.int32))
