"""The promise of a support router: paths that exist, are conserved, and stay within capacities."""

import numpy as np

from amprep.checks.violation import Violation
from amprep.model.arrays import Bools
from amprep.model.supports import CAPACITY, DIRECTIONS, ENCLOSED, Cube, SupportPlan, SupportProblem

PROMISE = "support plan"


def check_plan(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge a plan: legal edges, integral flow conserved from red to green, capacities, true reasons.

    Capacities bind edges and squares above the plate; squares on the plate are unbounded. Every red square is
    connected or listed exactly once, as ``enclosed`` only when no white way leads to the plate at all, as
    ``capacity`` only when there is one and the problem sets capacities.
    """
    found = _check_edges(problem, plan)
    if found:
        return found
    found = _check_listing(problem, plan)
    if found:
        return found
    return _check_flow(problem, plan) + _check_reasons(problem, plan)


def _check_edges(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    nz, ny, nx = problem.cubes.shape
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
        white &= problem.cubes[plane - 1, row, column] == Cube.WHITE
    found = _first(~white, plan, "meets a cube that is not white")
    found += _first(plan.flow < 1, plan, "carries no flow")
    found += _first(plan.flow > plan.capacity, plan, "carries more than its reported capacity")
    if problem.edge_capacity > 0:
        found += _first(plan.flow > problem.edge_capacity, plan, f"exceeds capacity {problem.edge_capacity}")
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
    known = (ENCLOSED, CAPACITY)
    strange = sorted({each.reason for each in plan.unconnected} - set(known))
    return (
        [_violation("unconnected", f"expected one of the reasons {known}, got {strange[0]!r}")]
        if strange
        else []
    )


def _check_flow(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    """Judge conservation and node capacities over the squares that occur."""
    _, ny, nx = problem.cubes.shape
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
    full = np.flatnonzero(~on_plate & (arriving > problem.node_capacity))
    if problem.node_capacity > 0 and full.size:
        message = f"{arriving[full[0]]:.0f} paths exceed the node capacity {problem.node_capacity}"
        found.append(_violation(_square(int(squares[full[0]]), ny, nx), message))
    return found


def _check_reasons(problem: SupportProblem, plan: SupportPlan) -> list[Violation]:
    if not plan.unconnected:
        return []
    way = has_way(problem)
    found = []
    for each in plan.unconnected:
        if way[each.red] == (each.reason == ENCLOSED):
            truth = "there is a white way" if way[each.red] else "there is no white way at all"
            found.append(_violation(f"red square {each.red}", f"listed as {each.reason!r}, but {truth}"))
        elif each.reason == CAPACITY and not (problem.node_capacity or problem.edge_capacity):
            message = "listed as 'capacity', but the problem sets none"
            found.append(_violation(f"red square {each.red}", message))
    return found


def has_way(problem: SupportProblem) -> Bools:
    """Tell which red squares have any white way to the plate: one sweep up, independent of all routers."""
    top = int(problem.red[:, 0].max(initial=0))
    reached = problem.green.copy()
    way = np.zeros(len(problem.red), np.bool_)
    for plane in range(1, top + 1):
        white = problem.cubes[plane - 1] == Cube.WHITE
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
