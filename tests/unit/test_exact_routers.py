"""The exact routers on grids small enough to know the answer, against networkx, and by their proof."""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from amprep.checks.supports import check_plan
from amprep.model.control import Stop, silent
from amprep.model.support_graph import to_networkx
from amprep.model.supports import CAPACITY, ENCLOSED, Cube, GridFrame, SupportProblem
from amprep.pipeline.bench_supports_rivals import RIVALS
from amprep.plugins.supports import pushing
from amprep.plugins.supports.min_cost_flow import route_min_cost_flow, solve_min_cost_flow
from amprep.plugins.supports.min_cost_flow_proof import find_gaps
from amprep.plugins.supports.push_relabel import route_push_relabel

ROUTERS = {"min-cost-flow": route_min_cost_flow, "push-relabel": route_push_relabel}


def problem(cubes, red, **rules):
    cubes = np.asarray(cubes, np.uint8)
    red = np.array(red, np.int32).reshape(-1, 3)
    nothing = np.zeros(len(red), np.int32)
    frame = GridFrame(np.zeros(3), 1.0, 1.0, cubes.shape)
    return SupportProblem(frame, cubes, red, nothing, nothing, cubes[0] == Cube.WHITE, **rules)


def hanging(shape, squares, **rules):
    """An empty grid of `shape` cubes whose top layer is black over the given ``(y, x)`` squares."""
    cubes = np.zeros(shape, np.uint8)
    top = shape[0] - 1
    for y, x in squares:
        cubes[top, y, x] = Cube.BLACK
    return problem(cubes, [(top, y, x) for y, x in squares], **rules)


def random_problem(seed):
    """Small random grids, capacities and costs; in a third of them paths can pass through red squares."""
    rng = np.random.default_rng(seed)
    cubes = (rng.random(tuple(rng.integers(3, 7, 3))) < rng.uniform(0.1, 0.5)).astype(np.uint8)
    if rng.random() < 0.3:
        red = [at for at in np.add(np.argwhere(cubes[:-1] == Cube.WHITE), (1, 0, 0)) if rng.random() < 0.5]
    else:
        red = [(p, y, x) for p, y, x in np.argwhere(cubes) if p > 0 and not cubes[p - 1, y, x]]
    edge, node = rng.integers(0, 4, 2)
    costs = [(1, 2), (0, 1), (3, 4), (1, 7)][rng.integers(4)]
    return problem(cubes, red, edge_capacity=int(edge), node_capacity=int(node), costs=costs)


def route(router, task, stop=None):
    plan = ROUTERS[router](task, stop=stop or Stop(), report=silent)
    assert check_plan(task, plan) == []
    return plan


@pytest.mark.parametrize("router", ROUTERS)
def test_what_has_no_way_at_all_is_enclosed(router):
    task = hanging((5, 3, 3), [(1, 1)])
    cubes = task.cubes.copy()
    cubes[0] = Cube.CLOSED
    plan = route(router, replace(task, cubes=cubes, green=cubes[0] == Cube.WHITE))
    assert [each.reason for each in plan.unconnected] == [ENCLOSED]
    assert (plan.objective, len(plan.flow)) == (0.0, 0)


@pytest.mark.parametrize("router", ROUTERS)
def test_a_problem_without_red_squares_gets_an_empty_plan(router):
    assert len(route(router, hanging((3, 4, 5), [])).flow) == 0


@pytest.mark.parametrize("router", ROUTERS)
def test_the_same_problem_gives_the_same_plan(router):
    first, second = route(router, random_problem(5)), route(router, random_problem(5))
    for name in ("plane", "y", "x", "direction", "flow"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_a_red_square_over_nothing_gets_a_straight_column():
    plan = route("min-cost-flow", hanging((6, 5, 5), [(2, 3)]))
    assert plan.direction.tolist() == [0] * 5
    assert (plan.objective, plan.bound, plan.status) == (5.0, 5.0, "optimal")


def test_costs_are_summed_over_straight_and_oblique_edges():
    """A roof of 3 by 3 cubes under the red square: two steps sideways and six straight edges."""
    task = hanging((9, 7, 7), [(3, 3)], costs=(3, 10))
    cubes = task.cubes.copy()
    cubes[2:4, 2:5, 2:5] = Cube.BLACK
    assert route("min-cost-flow", replace(task, cubes=cubes)).objective == 6 * 3 + 2 * 10


def one_hole(reds, **rules):
    """A floor with one hole at x = 0 under a row of red squares."""
    task = hanging((8, 1, 6), [(0, x) for x in reds], **rules)
    cubes = task.cubes.copy()
    cubes[1, :, 1:] = Cube.BLACK
    return replace(task, cubes=cubes)


@pytest.mark.parametrize("reds", [(1, 3, 4), (0, 2, 5), (2, 4)])
def test_of_those_that_compete_for_a_hole_the_nearest_are_connected(reds):
    plan = route("min-cost-flow", one_hole(reds, node_capacity=1))
    assert [(each.red, each.reason) for each in plan.unconnected] == [
        (i, CAPACITY) for i in range(1, len(reds))
    ]
    assert plan.objective == 7 + reds[0]


def test_a_stopped_run_gives_what_it_has():
    stop = Stop()
    stop.cancelled.set()
    plan = route("min-cost-flow", one_hole((1, 3, 4), node_capacity=1), stop)
    assert (plan.status, plan.stop_reason, plan.bound) == ("feasible", "interrupted", None)


def test_high_costs_need_no_more_than_larger_buckets():
    plan = route("min-cost-flow", one_hole((1, 3, 4), node_capacity=2, costs=(0, 1_000_000)))
    assert plan.objective == 4_000_000


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 100_000))
@example(14383)  # a unit ends, for nothing, at a red square that is itself yet to be left out
def test_value_and_cost_equal_those_of_networkx_and_are_proven(seed):
    task = random_problem(seed)
    plan = route("min-cost-flow", task)
    graph = to_networkx(task)
    flow = nx.max_flow_min_cost(graph, "source", "sink")
    assert len(task.red) - len(plan.unconnected) == sum(flow["source"].values())
    assert plan.objective == nx.cost_of_flow(graph, flow)
    assert find_gaps(solve_min_cost_flow(task, stop=Stop(), report=silent)) == []


def test_values_and_costs_equal_those_of_or_tools_on_hundreds_of_grids():
    pytest.importorskip("ortools")
    rivals = {each.name: each.solve for each in RIVALS}
    for seed in range(300):
        task = random_problem(seed)
        if not len(task.red):
            continue
        plan, pushed = route("min-cost-flow", task), route("push-relabel", task)
        value, cost, _ = rivals["or-tools min-cost-flow"](task)
        assert len(task.red) - len(plan.unconnected) == value == rivals["or-tools max-flow"](task)[0]
        assert (plan.objective, pushed.objective) == (cost, value)


def test_the_proof_fails_for_a_flow_that_costs_too_much():
    solved = solve_min_cost_flow(hanging((6, 5, 5), [(2, 2)]), stop=Stop(), report=silent)
    used = np.flatnonzero(solved.carried.through)
    solved.carried.flow[used[0]] = solved.carried.flow[used[0]][::-1]
    assert find_gaps(solved) == ["1 residual arcs up edges have a negative reduced cost"]


def test_straight_edges_come_first_where_there_is_a_choice():
    plan = route(
        "push-relabel",
        hanging((9, 6, 6), [(y, x) for y in range(1, 5) for x in range(1, 5)], node_capacity=1),
    )
    assert plan.unconnected == ()
    assert set(plan.direction.tolist()) == {0}


def test_what_does_not_fit_through_a_hole_is_listed():
    task = hanging((8, 3, 7), [(1, x) for x in range(7)], node_capacity=2)
    cubes = task.cubes.copy()
    cubes[1] = Cube.BLACK
    cubes[1, 1, 3] = Cube.WHITE
    plan = route("push-relabel", replace(task, cubes=cubes))
    assert [each.reason for each in plan.unconnected] == [CAPACITY] * 5
    assert (plan.objective, plan.bound, plan.status) == (2.0, 2.0, "optimal")


def crowd():
    """More red squares over a small hole in a high room than fit, after much pushing to and fro."""
    task = hanging((14, 9, 9), [(y, x) for y in range(9) for x in range(9)], node_capacity=1)
    cubes = task.cubes.copy()
    cubes[2] = Cube.BLACK
    cubes[2, 3:6, 3:6] = Cube.WHITE
    return replace(task, cubes=cubes)


def test_relabelling_all_at_any_time_changes_nothing_in_the_value(monkeypatch):
    assert len(route("push-relabel", crowd()).unconnected) == 72
    monkeypatch.setattr(pushing, "_EFFORT", 0.01)
    assert len(route("push-relabel", crowd()).unconnected) == 72


def test_a_stopped_run_is_a_legal_plan(monkeypatch):
    monkeypatch.setattr(pushing, "_EFFORT", 0.01)
    stop = Stop()
    stop.cancelled.set()
    plan = route("push-relabel", crowd(), stop)
    assert (plan.status, plan.stop_reason, plan.bound) == ("feasible", "interrupted", None)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 100_000), st.sampled_from([6, 0.05]))
def test_as_many_are_connected_as_networkx_connects(seed, effort):
    task = random_problem(seed)
    usual, pushing._EFFORT = pushing._EFFORT, effort
    try:
        plan = route("push-relabel", task)
    finally:
        pushing._EFFORT = usual
    assert len(task.red) - len(plan.unconnected) == nx.maximum_flow_value(to_networkx(task), "source", "sink")
