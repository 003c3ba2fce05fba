"""The promise of a support router: paths that exist, are conserved, and stay within capacities."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.violation import Violation
from amprep.model.support_graph import support_graph
from amprep.model.supports import (
    CAPACITY,
    DIRECTIONS,
    ENCLOSED,
    OUT_OF_TIME,
    SupportPlan,
    SupportProblem,
    Voxel,
)

PROMISE = "support plan"


def check_plan(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge a plan: legal edges, integral flow conserved from red to green, capacities, true reasons.

    Capacities bind edges and squares above the plate; squares on the plate are unbounded. They are exceeded
    only when the problem allows it, by no more than the plan says. Every red square is connected or listed
    exactly once, as ``enclosed`` only when no white way leads to the plate at all, as ``capacity`` only when
    there is one and the problem sets capacities that bind, as ``time limit`` only when there is one and the
    plan ended early.
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
    lengths = {len(getattr(plan, name)) for name in ("plane", "y", "x", "direction", "flow", "capacity")}
    if len(lengths) != 1:
        return [_violation("plan", f"the edge arrays must be equally long, got lengths {sorted(lengths)}")]
    plane, y, x, direction = plan.plane, plan.y, plan.x, plan.direction
    inside = (plane >= 1) & (plane <= nz) & (direction < len(DIRECTIONS))
    step = np.array(DIRECTIONS, np.int64)[np.minimum(direction, len(DIRECTIONS) - 1)]
    ends = [(y, x), (y + step[:, 0], x + step[:, 1])]
    for row, column in ends:
        inside &= (row >= 0) & (row < ny) & (column >= 0) & (column < nx)
    found = _first(~inside, plan, "leads out of the grid")
    if found:
        return found
    white = np.ones(len(plane), np.bool_)
    for row, column in ends:
        white &= problem.voxels[plane - 1, row, column] == Voxel.FREE
    found = _first(~white, plan, "meets a voxel that is not white")
    found += _first(plan.flow < 1, plan, "carries no flow")
    found += _first(plan.flow > plan.capacity, plan, "carries more than its reported capacity")
    if problem.edge_capacity > 0:
        limit = problem.edge_capacity + plan.raised
        found += _first(plan.flow > limit, plan, f"exceeds capacity {limit}")
        found += _first(
            plan.capacity > np.maximum(plan.flow, limit), plan, "reports a capacity nobody asked for"
        )
        if problem.escalation != "uniform":
            idle = (plan.capacity > problem.edge_capacity) & (plan.flow < plan.capacity)
            found += _first(idle, plan, "has a raised capacity that it does not use")
    key = ((plane.astype(np.int64) * ny + y) * nx + x) * len(DIRECTIONS) + direction
    if len(np.unique(key)) < len(key):
        found.append(_violation("plan", "an edge is listed twice"))
    return found


def _first(broken: Bools, plan: SupportPlan, message: str) -> list[Violation]:
    rows = np.flatnonzero(broken)
    if not rows.size:
        return []
    e = rows[0]
    edge = f"edge from plane {plan.plane[e]}, y {plan.y[e]}, x {plan.x[e]} in direction {plan.direction[e]}"
    return [_violation(edge, f"{message} ({rows.size} such edges, flow {plan.flow[e]})")]


def _check_listing(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    listed = np.array([each.red for each in plan.unconnected], np.int64)
    count = len(problem.red)
    if ((listed < 0) | (listed >= count)).any():
        return [_violation("unconnected", f"expected numbers of red squares under {count}")]
    if len(np.unique(listed)) < len(listed):
        return [_violation("unconnected", "a red square is listed twice")]
    known = (ENCLOSED, CAPACITY) if plan.stop_reason == "finished" else (ENCLOSED, CAPACITY, OUT_OF_TIME)
    strange = sorted({each.reason for each in plan.unconnected} - set(known))
    return (
        [_violation("unconnected", f"expected one of the reasons {known}, got {strange[0]!r}")]
        if strange
        else []
    )


def _check_flow(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge conservation and node capacities over the squares that occur."""
    _, ny, nx = problem.voxels.shape
    connected = np.ones(len(problem.red), np.bool_)
    connected[[each.red for each in plan.unconnected]] = False
    step = np.array(DIRECTIONS, np.int64)[plan.direction]
    start = (plan.plane.astype(np.int64) * ny + plan.y) * nx + plan.x
    end = ((plan.plane.astype(np.int64) - 1) * ny + plan.y + step[:, 0]) * nx + plan.x + step[:, 1]
    plane, y, x = problem.red[connected].T.astype(np.int64)
    red = (plane * ny + y) * nx + x
    squares, place = np.unique(np.concatenate([start, end, red]), return_inverse=True)
    leaving = np.bincount(place[: len(start)], weights=plan.flow, minlength=len(squares))
    arriving = np.bincount(place[len(start) : 2 * len(start)], weights=plan.flow, minlength=len(squares))
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
    """Judge what escalation has raised: only when asked to, no more than is used, and for everybody."""
    edge = int(plan.flow.max(initial=0)) - problem.edge_capacity if problem.edge_capacity else 0
    node = int(through.max(initial=0)) - problem.node_capacity if problem.node_capacity else 0
    found = []
    if plan.raised != max(edge, node, 0):
        message = f"says that capacities are raised by {plan.raised}, but {max(edge, node, 0)} is used"
        found.append(_violation("plan", message))
    if plan.raised and problem.escalation == "none":
        found.append(_violation("plan", "raises capacities, though the problem forbids it"))
    return found


def check_raises(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge whether escalation left nobody out and was needed, by a greatest flow that scipy finds.

    With the capacities asked for (``cut``), or with one less than those of the plan (``uniform``), it must not
    be possible to connect every red square that has a way. Takes about 300 bytes a square.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_flow

    left = sum(each.reason == CAPACITY for each in plan.unconnected)
    if left and problem.escalation != "none" and plan.stop_reason == "finished":
        return [_violation("plan", f"leaves out {left} red squares, though capacities may be raised")]
    if not plan.raised:
        return []
    graph = support_graph(problem, raised=plan.raised - 1 if problem.escalation == "uniform" else 0)
    nodes = graph.sink + 1
    matrix = csr_array((graph.capacity, (graph.tail, graph.head)), shape=(nodes, nodes))
    possible = maximum_flow(matrix, graph.source, graph.sink).flow_value
    wanted = int(_has_way(problem).sum())
    if possible < wanted:
        return []
    return [_violation("plan", f"raises capacities, though without that all {wanted} could be connected")]


def _check_reasons(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    if not plan.unconnected:
        return []
    way = _has_way(problem)
    found = []
    for each in plan.unconnected:
        if way[each.red] == (each.reason == ENCLOSED):
            truth = "there is a white way" if way[each.red] else "there is no white way at all"
            found.append(_violation(f"red square {each.red}", f"listed as {each.reason!r}, but {truth}"))
        elif each.reason == CAPACITY and not (problem.node_capacity or problem.edge_capacity):
            message = "listed as 'capacity', but the problem sets none"
            found.append(_violation(f"red square {each.red}", message))
    return found


def _has_way(problem: SupportProblem) -> Bools:
    """Tell which red squares have any white way to the plate: one sweep up, independent of all routers."""
    top = int(problem.red[:, 0].max(initial=0))
    reached = problem.green.copy()
    way = np.zeros(len(problem.red), np.bool_)
    for plane in range(1, top + 1):
        white = problem.voxels[plane - 1] == Voxel.FREE
        below = reached & white
        reached = below.copy()
        reached[1:] |= below[:-1]
        reached[:-1] |= below[1:]
        reached[:, 1:] |= below[:, :-1]
        reached[:, :-1] |= below[:, 1:]
        reached &= white
        here = problem.red[:, 0] == plane
        way[here] = reached[problem.red[here, 1], problem.red[here, 2]]
    return way


def _square(number: int, ny: int, nx: int) -> str:
    plane, rest = divmod(number, ny * nx)
    return f"square at plane {plane}, y {rest // nx}, x {rest % nx}"


def _violation(subject: str, message: str) -> Violation:
    return Violation(PROMISE, subject, message)
