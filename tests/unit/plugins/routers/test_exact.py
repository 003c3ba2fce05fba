"""The exact routers on small grids with known answers, against networkx, and by their certificate."""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from tests.shared import grids
from tests.shared.examples import examples
from tests.shared.grids import Late, hanging, random_problem

from amprep.bench.routing.rivals import RIVALS
from amprep.checks.supports.plan import check_plan
from amprep.errors import JobError
from amprep.flows import maximum_flow
from amprep.model.control import Stop, silent
from amprep.model.supports import CAPACITY, ENCLOSED, OUT_OF_TIME, Voxel
from amprep.model.supports.graph import to_networkx
from amprep.plugins.routers.min_cost_certificate import find_optimality_violations
from amprep.plugins.routers.min_cost_flow import solve_min_cost_flow

ROUTERS = ["min-cost-flow", "push-relabel"]


def route(router, task, stop=None):
    plan = grids.route(router, task, stop)
    assert check_plan(task, plan) == []
    return plan


@pytest.mark.parametrize("router", ROUTERS)
def test_what_has_no_way_at_all_is_enclosed(router):
    task = hanging((5, 3, 3), [(1, 1)])
    voxels = task.voxels.copy()
    voxels[0] = Voxel.CLOSED
    plan = route(router, replace(task, voxels=voxels, green=voxels[0] == Voxel.FREE))
    assert [each.reason for each in plan.unconnected] == [ENCLOSED]
    assert (plan.objective, len(plan.edges.flow)) == (0.0, 0)


@pytest.mark.parametrize("router", ROUTERS)
def test_a_problem_without_red_squares_gets_an_empty_plan(router):
    assert len(route(router, hanging((3, 4, 5), [])).edges) == 0


@pytest.mark.parametrize("router", ROUTERS)
def test_the_same_problem_gives_the_same_plan(router):
    first, second = route(router, random_problem(5)), route(router, random_problem(5))
    for name in ("plane", "y", "x", "direction", "flow"):
        np.testing.assert_array_equal(getattr(first.edges, name), getattr(second.edges, name))


def test_a_red_square_over_nothing_gets_a_straight_column():
    plan = route("min-cost-flow", hanging((6, 5, 5), [(2, 3)]))
    assert plan.edges.direction.tolist() == [0] * 5
    assert (plan.objective, plan.bound, plan.status) == (5.0, 5.0, "optimal")


def test_costs_are_summed_over_straight_and_oblique_edges():
    """A roof of 3 by 3 voxels under the red square: two steps sideways and six straight edges."""
    task = hanging((9, 7, 7), [(3, 3)], costs=(3, 10))
    voxels = task.voxels.copy()
    voxels[2:4, 2:5, 2:5] = Voxel.OCCUPIED
    assert route("min-cost-flow", replace(task, voxels=voxels)).objective == 6 * 3 + 2 * 10


def one_hole(reds, **rules):
    """A floor with one hole at x = 0 under a row of red squares."""
    task = hanging((8, 1, 6), [(0, x) for x in reds], **rules)
    voxels = task.voxels.copy()
    voxels[1, :, 1:] = Voxel.OCCUPIED
    return replace(task, voxels=voxels)


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


@pytest.mark.compiled
def test_high_costs_need_no_more_than_larger_buckets():
    plan = route("min-cost-flow", one_hole((1, 3, 4), node_capacity=2, costs=(0, 10_000)))
    assert plan.objective == 40_000


def test_costs_beyond_32_bits_are_refused():
    with pytest.raises(JobError, match="between 0 and 10000"):
        hanging((3, 3, 3), [(1, 1)], costs=(1, 10_001))
    tall = hanging((107_400, 1, 1), [(0, 0)], costs=(10_000, 1))
    with pytest.raises(JobError, match="over 107399 planes; reduce"):
        grids.route("push-relabel", tall)
    assert (
        route("min-cost-flow", hanging((107_300, 1, 1), [(0, 0)], costs=(10_000, 1))).objective
        == 1_072_990_000
    )


@examples(60)
@given(st.integers(0, 100_000))
@example(14383)  # a unit ends, for nothing, at a red square that is itself yet to be left out
def test_value_and_cost_equal_those_of_networkx_and_are_proven(seed):
    task = random_problem(seed)
    plan = route("min-cost-flow", task)
    graph = to_networkx(task)
    flow = nx.max_flow_min_cost(graph, "source", "sink")
    assert len(task.red) - len(plan.unconnected) == sum(flow["source"].values())
    assert plan.objective == nx.cost_of_flow(graph, flow)
    assert find_optimality_violations(solve_min_cost_flow(task, stop=Stop(), progress=silent)) == []


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
    solved = solve_min_cost_flow(hanging((6, 5, 5), [(2, 2)]), stop=Stop(), progress=silent)
    used = np.flatnonzero(solved.flow.square)
    solved.flow.edge[used[0]] = solved.flow.edge[used[0]][::-1]
    assert find_optimality_violations(solved) == ["1 residual arcs up edges have a negative reduced cost"]


def test_straight_edges_come_first_where_there_is_a_choice():
    plan = route(
        "push-relabel",
        hanging((9, 6, 6), [(y, x) for y in range(1, 5) for x in range(1, 5)], node_capacity=1),
    )
    assert plan.unconnected == ()
    assert set(plan.edges.direction.tolist()) == {0}


def test_what_does_not_fit_through_a_hole_is_listed():
    task = hanging((8, 3, 7), [(1, x) for x in range(7)], node_capacity=2)
    voxels = task.voxels.copy()
    voxels[1] = Voxel.OCCUPIED
    voxels[1, 1, 3] = Voxel.FREE
    plan = route("push-relabel", replace(task, voxels=voxels))
    assert [each.reason for each in plan.unconnected] == [CAPACITY] * 5
    assert (plan.objective, plan.bound, plan.status) == (2.0, 2.0, "optimal")


def congested():
    """More red squares over a small hole than fit, in a high room: excess is pushed to and fro many times."""
    task = hanging((14, 9, 9), [(y, x) for y in range(9) for x in range(9)], node_capacity=1)
    voxels = task.voxels.copy()
    voxels[2] = Voxel.OCCUPIED
    voxels[2, 3:6, 3:6] = Voxel.FREE
    return replace(task, voxels=voxels)


@pytest.mark.parametrize("router", ["min-cost-flow", "push-relabel", "shortest-paths", "tree", "auto"])
@pytest.mark.parametrize("rules", [{}, {"edge_capacity": 1, "escalation": "cut"}], ids=str)
def test_whenever_it_is_stopped_a_plan_is_legal_and_says_so(router, rules):
    task = random_problem(11, **rules)
    whole = grids.route(router, task, Late(10**9))
    for number in (0, 1, 2, 5, 20):
        stop = Late(number)
        plan = grids.route(router, task, stop)
        assert check_plan(task, plan) == []
        if stop.asked <= number:
            assert plan.unconnected == whole.unconnected
        else:
            assert (plan.stop_reason, plan.bound) == ("time limit", None)
            assert {each.reason for each in plan.unconnected} <= {ENCLOSED, OUT_OF_TIME}


def test_more_paths_than_16_bits_count_meet_in_a_square():
    """Red squares throughout a shaft of 16 x 16 x 270 voxels that is closed at the bottom but for one hole."""
    voxels = np.zeros((270, 16, 16), np.uint8)
    voxels[0] = Voxel.OCCUPIED
    voxels[0, 8, 8] = Voxel.FREE
    task = grids.problem(voxels, np.argwhere(np.ones((254, 16, 16))) + (17, 0, 0))
    plan = grids.route("shortest-paths", task, rounds=0)
    assert check_plan(task, plan) == []
    assert (plan.unconnected, int(plan.edges.flow.max())) == ((), 254 * 16 * 16)


def test_relabelling_all_at_any_time_changes_nothing_in_the_value(monkeypatch):
    assert len(route("push-relabel", congested()).unconnected) == 72
    monkeypatch.setattr(maximum_flow, "_EFFORT", 0.01)
    assert len(route("push-relabel", congested()).unconnected) == 72


def test_a_stopped_run_is_a_legal_plan(monkeypatch):
    monkeypatch.setattr(maximum_flow, "_EFFORT", 0.01)
    stop = Stop()
    stop.cancelled.set()
    plan = route("push-relabel", congested(), stop)
    assert (plan.status, plan.stop_reason, plan.bound) == ("feasible", "interrupted", None)


@examples(60)
@given(st.integers(0, 100_000), st.sampled_from([6, 0.05]))
def test_as_many_are_connected_as_networkx_connects(seed, effort):
    task = random_problem(seed)
    usual, maximum_flow._EFFORT = maximum_flow._EFFORT, effort
    try:
        plan = route("push-relabel", task)
    finally:
        maximum_flow._EFFORT = usual
    assert len(task.red) - len(plan.unconnected) == nx.maximum_flow_value(to_networkx(task), "source", "sink")
