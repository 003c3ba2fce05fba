"""Judge a support router: its edges exist, its flow is conserved, and capacities hold."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.violation import Violation
from amprep.model.counting import counted
from amprep.model.supports import (
    CAPACITY,
    ENCLOSED,
    OUT_OF_TIME,
    ROUTER_REASONS,
    SupportPlan,
    SupportProblem,
    Voxel,
)
from amprep.model.supports.edges import DIRECTIONS, SupportEdges, square_keys
from amprep.model.supports.graph import support_graph

PROMISE = "support plan"


def check_plan(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge a plan: edges exist, the flow from red to green squares is conserved, capacities hold, reasons are true.

    Capacities apply to edges and to squares above the plate; squares on the plate have none. They are exceeded
    only if the problem allows it, and by no more than the plan reports. Every red square is connected or listed
    once: as ``enclosed`` only if no path over free voxels leads to the plate, as ``capacity`` only if there is a
    path and the problem has capacities, as ``time limit`` only if there is a path and the router ended early.
    """
    found = _check_edges(problem, plan)
    if found:
        return found
    found = _check_listing(problem, plan)
    if found:
        return found
    return _check_flow(problem, plan) + _check_reasons(problem, plan)


def _check_edges(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    nz, ny, nx = problem.voxels.shape
    edges = plan.edges
    plane, y, x, direction = edges.plane, edges.y, edges.x, edges.direction
    inside = (plane >= 1) & (plane <= nz) & (direction < len(DIRECTIONS))
    step = np.array(DIRECTIONS, np.int64)[np.minimum(direction, len(DIRECTIONS) - 1)]
    ends = [(y, x), (y + step[:, 0], x + step[:, 1])]
    for row, column in ends:
        inside &= (row >= 0) & (row < ny) & (column >= 0) & (column < nx)
    found = _first(~inside, edges, "leads out of the grid")
    if found:
        return found
    free = np.ones(len(plane), np.bool_)
    for row, column in ends:
        free &= problem.voxels[plane - 1, row, column] == Voxel.FREE
    found = _first(~free, edges, "meets a voxel that is not free")
    found += _first(edges.flow < 1, edges, "carries no flow")
    found += _first(edges.flow > edges.capacity, edges, "carries more than its reported capacity")
    if problem.edge_capacity > 0:
        limit = problem.edge_capacity + plan.raised
        found += _first(edges.flow > limit, edges, f"exceeds capacity {limit}")
        unasked = edges.capacity > np.maximum(edges.flow, limit)
        found += _first(unasked, edges, "reports a capacity above the limit that it does not need")
        if problem.escalation != "uniform":
            idle = (edges.capacity > problem.edge_capacity) & (edges.flow < edges.capacity)
            found += _first(idle, edges, "has a raised capacity that it does not use")
    if len(np.unique(square_keys(edges.upper) * len(DIRECTIONS) + direction)) < len(edges):
        found.append(_violation("plan", "an edge is listed twice"))
    return found


def _first(broken: Bools, edges: SupportEdges, message: str) -> list[Violation]:
    """Return a violation that names the first of the broken edges and their number; none if no edge is broken."""
    rows = np.flatnonzero(broken)
    if not rows.size:
        return []
    e = rows[0]
    edge = (
        f"edge from plane {edges.plane[e]}, y {edges.y[e]}, x {edges.x[e]} in direction {edges.direction[e]}"
    )
    return [_violation(edge, f"{message} ({rows.size} such edges, flow {edges.flow[e]})")]


def _check_listing(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    listed = np.array([each.red for each in plan.unconnected], np.int64)
    count = len(problem.red)
    if ((listed < 0) | (listed >= count)).any():
        return [_violation("unconnected", f"expected numbers of red squares under {count}")]
    if len(np.unique(listed)) < len(listed):
        return [_violation("unconnected", "a red square is listed twice")]
    reasons = {each.reason for each in plan.unconnected}
    strange = sorted(reasons - set(ROUTER_REASONS))
    if strange:
        return [
            _violation("unconnected", f"expected one of the reasons {ROUTER_REASONS}, got {strange[0]!r}")
        ]
    if OUT_OF_TIME in reasons and plan.stop_reason == "finished":
        message = (
            f"{OUT_OF_TIME!r} is a reason only if the plan's stop_reason is that of stop, got 'finished'"
        )
        return [_violation("unconnected", message)]
    return []


def _check_flow(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge flow conservation and node capacities at the squares that the plan uses."""
    _, ny, nx = problem.voxels.shape
    connected = np.ones(len(problem.red), np.bool_)
    connected[[each.red for each in plan.unconnected]] = False
    start, end, red = (
        (plane * ny + y) * nx + x
        for plane, y, x in (
            each.T.astype(np.int64) for each in (plan.edges.upper, plan.edges.lower, problem.red[connected])
        )
    )
    squares, place = np.unique(np.concatenate([start, end, red]), return_inverse=True)
    leaving = np.bincount(place[: len(start)], weights=plan.edges.flow, minlength=len(squares))
    arriving = np.bincount(
        place[len(start) : 2 * len(start)], weights=plan.edges.flow, minlength=len(squares)
    )
    arriving += np.bincount(place[2 * len(start) :], minlength=len(squares))
    on_plate = squares < ny * nx
    found = []
    unequal = np.flatnonzero(~on_plate & (arriving != leaving))
    if unequal.size:
        s = unequal[0]
        message = f"receives {arriving[s]:.0f} and passes on {leaving[s]:.0f} ({unequal.size} such squares)"
        found.append(_violation(_square(int(squares[s]), ny, nx), message))
    grounded = problem.green.reshape(-1)[squares[on_plate]]
    if not grounded[arriving[on_plate] > 0].all():
        found.append(_violation("plate", "flow arrives on a square that is not green"))
    limit = problem.node_capacity + plan.raised
    full = np.flatnonzero(~on_plate & (arriving > limit))
    if problem.node_capacity > 0 and full.size:
        message = f"{arriving[full[0]]:.0f} paths exceed the node capacity {limit}"
        found.append(_violation(_square(int(squares[full[0]]), ny, nx), message))
    return found + _check_raised(problem, plan, arriving[~on_plate])


def _check_raised(problem: SupportProblem, plan: SupportPlan, through: Floats) -> list[Violation]:
    """Judge the amount by which capacities are raised: as reported, and only if the problem allows it."""
    edge = int(plan.edges.flow.max(initial=0)) - problem.edge_capacity if problem.edge_capacity else 0
    node = int(through.max(initial=0)) - problem.node_capacity if problem.node_capacity else 0
    found = []
    if plan.raised != max(edge, node, 0):
        message = f"reports capacities raised by {plan.raised}, but the flow uses {max(edge, node, 0)}"
        found.append(_violation("plan", message))
    if plan.raised and problem.escalation == "none":
        found.append(_violation("plan", "raises capacities, which the problem does not allow"))
    return found


def check_raises(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge whether escalation was needed and connected every reachable red square, by a maximum flow of scipy.

    With the capacities of the problem (``cut``), or with capacities smaller by one than those of the plan
    (``uniform``), it must be impossible to connect every reachable red square. The judge takes about 300 bytes for
    each square.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_flow

    left = sum(each.reason == CAPACITY for each in plan.unconnected)
    if left and problem.escalation != "none" and plan.stop_reason == "finished":
        return [
            _violation(
                "plan", f"leaves {counted(left, 'red square')} unconnected, although capacities may be raised"
            )
        ]
    if not plan.raised:
        return []
    graph = support_graph(problem, raised=plan.raised - 1 if problem.escalation == "uniform" else 0)
    nodes = graph.sink + 1
    matrix = csr_array((graph.capacity, (graph.tail, graph.head)), shape=(nodes, nodes))
    possible = maximum_flow(matrix, graph.source, graph.sink).flow_value
    wanted = int(_reachable(problem).sum())
    if possible < wanted:
        return []
    return [
        _violation(
            "plan",
            f"raises capacities, although all {wanted} reachable red squares can be connected without it",
        )
    ]


def _check_reasons(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    if not plan.unconnected:
        return []
    reachable = _reachable(problem)
    untrue: dict[str, list[int]] = {}
    for each in plan.unconnected:
        if reachable[each.red] == (each.reason == ENCLOSED):
            truth = "there is a path" if reachable[each.red] else "there is no path"
        elif each.reason == CAPACITY and not (problem.node_capacity or problem.edge_capacity):
            truth = "the problem has no capacities"
        else:
            continue
        untrue.setdefault(f"listed as {each.reason!r}, but {truth}", []).append(each.red)
    return [
        _violation(f"red square {red_squares[0]}", f"{message} ({len(red_squares)} such squares)")
        for message, red_squares in untrue.items()
    ]


def _reachable(problem: SupportProblem) -> Bools:
    """Tell which red squares some path of free voxels connects to the plate.

    The squares reached are dilated by a cross from plane to plane. This way is independent of all routers.
    """
    from scipy.ndimage import binary_dilation

    free = problem.voxels == Voxel.FREE
    reached = np.zeros((len(free) + 1, *problem.green.shape), np.bool_)
    reached[0] = problem.green
    for plane, layer in enumerate(free[: int(problem.red[:, 0].max(initial=0))], start=1):
        reached[plane] = layer & binary_dilation(reached[plane - 1] & layer)
    return np.asarray(reached[tuple(problem.red.T)])


def _square(number: int, ny: int, nx: int) -> str:
    plane, rest = divmod(number, ny * nx)
    return f"square at plane {plane}, y {rest // nx}, x {rest % nx}"


def _violation(subject: str, message: str) -> Violation:
    return Violation(PROMISE, subject, message)
