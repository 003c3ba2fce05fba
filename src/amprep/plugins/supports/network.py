"""A support problem as the routing kernels see it: padded planes, flows, and the plan read back."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from amprep.kernels.flow_network import Carried, Flowing
from amprep.kernels.routing import FAR, UNBOUNDED, Flows, Ints, Limits, Longs, Network
from amprep.model.arrays import Bools
from amprep.model.supports import DIRECTIONS, Cube, SupportPlan, SupportProblem, Unconnected


def network_of(problem: SupportProblem) -> tuple[Network, Longs]:
    """Return the network up to the highest red square, and the number of each red square in it."""
    _, ny, nx = problem.frame.shape
    width, stride = nx + 2, (nx + 2) * (ny + 2)
    top = int(problem.red[:, 0].max(initial=0))
    white = np.zeros((top + 1, ny + 2, width), np.uint8)
    white[:top, 1:-1, 1:-1] = problem.cubes[:top] == Cube.WHITE
    via = white.copy()
    via[1:] &= white[:-1]
    offset = np.array([dy * width + dx for dy, dx in DIRECTIONS], np.int64)
    plane, y, x = problem.red.astype(np.int64).T
    start = plane * stride + (y + 1) * width + x + 1
    return Network(via.reshape(-1), offset, _boxes(problem, top), stride, width), start


def _boxes(problem: SupportProblem, top: int) -> Longs:
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
    return SupportPlan(
        plane=plane,
        y=y - 1,
        x=x - 1,
        direction=direction.astype(np.uint8),
        flow=flow,
        capacity=np.maximum(flow, asked if problem.edge_capacity else 0),
        unconnected=tuple(Unconnected(red, reason) for red, reason in reasons),
        stop_reason=stop_reason,
        objective=float(straight.sum() * vertical + (~straight).sum() * oblique),
        raised=raised,
    )


def _raised(problem: SupportProblem, flow: Ints, through: Flowing) -> int:
    """Return by how much flow exceeds the capacities asked for, at most."""
    edge = int(flow.max(initial=0)) - problem.edge_capacity if problem.edge_capacity else 0
    node = int(through.max(initial=0)) - problem.node_capacity if problem.node_capacity else 0
    return max(edge, node, 0)
