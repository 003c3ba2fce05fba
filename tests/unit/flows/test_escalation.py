"""Escalation: on small grids with known answers, and necessary by scipy's maximum flow."""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.grids import Late, floor_with_holes, problem, random_problem, route

from amprep.checks.supports.plan import check_plan, check_raises
from amprep.model.control import Stop, silent
from amprep.model.supports import CAPACITY, Voxel
from amprep.plugins.routers.min_cost_certificate import find_optimality_violations
from amprep.plugins.routers.min_cost_flow import cost_of, solve_min_cost_flow

ROUTERS = ["min-cost-flow", "push-relabel", "shortest-paths"]


@pytest.mark.parametrize("router", ROUTERS)
@pytest.mark.parametrize("rules", [{"edge_capacity": 2}, {"node_capacity": 2}], ids=str)
def test_all_come_through_one_hole_by_raising_what_is_at_it_alone(router, rules):
    task = floor_with_holes([3], escalation="cut", **rules)
    plan = route(router, task)
    assert check_plan(task, plan) == check_raises(task, plan) == []
    assert (plan.unconnected, plan.raised) == ((), 5)
    if "edge_capacity" in rules:
        assert set(plan.edges.capacity.tolist()) <= set(range(2, 8))


@pytest.mark.parametrize("router", ROUTERS)
def test_two_holes_share_what_is_raised(router):
    task = floor_with_holes([1, 5], node_capacity=1, escalation="cut")
    assert route(router, task).raised == 3  # 4 and 3 paths: the smallest grows first


@pytest.mark.parametrize("router", ROUTERS)
def test_uniform_raises_all_edges_alike(router):
    task = floor_with_holes([1, 5], edge_capacity=1, escalation="uniform")
    plan = route(router, task)
    assert check_plan(task, plan) == check_raises(task, plan) == []
    assert (plan.unconnected, plan.raised) == ((), 3)
    assert set(plan.edges.capacity.tolist()) == {4}


def test_the_loop_starts_again_where_capacities_were_raised():
    """Twenty-five paths through a shaft: those that the capacity of 3 had led to the corner took 227 edges."""
    voxels = np.zeros((16, 9, 9), np.uint8)
    voxels[:4] = Voxel.CLOSED
    voxels[:4, 4, 4] = voxels[:4, 0, 0] = Voxel.FREE
    red = np.array([(15, y, x) for y in range(2, 7) for x in range(2, 7)])
    voxels[tuple(red.T)] = Voxel.OCCUPIED
    task = problem(voxels, red, node_capacity=3, escalation="cut")
    plan = route("push-relabel", task)
    assert check_plan(task, plan) == []
    assert (plan.unconnected, plan.raised) == ((), 10)
    assert len(plan.edges) <= 223


@pytest.mark.parametrize("router", ROUTERS)
def test_without_escalation_they_are_listed(router):
    plan = route(router, floor_with_holes([3], node_capacity=2))
    assert [each.reason for each in plan.unconnected] == [CAPACITY] * 5
    assert plan.raised == 0


@pytest.mark.parametrize("router", ["min-cost-flow", "push-relabel"])
def test_a_stopped_escalation_is_a_legal_plan(router):
    task = floor_with_holes([3], node_capacity=1, escalation="cut")
    plan = route(router, task, Late(1))
    assert check_plan(task, plan) == []
    assert plan.stop_reason != "finished"


@examples(60)
@given(st.integers(0, 100_000), st.sampled_from(["cut", "uniform"]))
def test_every_red_square_with_a_way_is_served_and_what_was_raised_was_needed(seed, escalation):
    task = random_problem(seed, escalation=escalation)
    for router in ROUTERS:
        plan = route(router, task)
        assert check_plan(task, plan) == check_raises(task, plan) == []
    assert find_optimality_violations(solve_min_cost_flow(task, stop=Stop(), progress=silent)) == []


def graph_of(task):
    """The flow problem as a graph of networkx; a red square sends a unit, which passes its own square."""
    network, (square, edge, each) = task.network, task.capacities
    graph = nx.DiGraph()
    graph.add_nodes_from(["red", "plate"])
    for red in task.start[task.reachable].tolist():
        graph.add_edge("red", (red, "in"), capacity=1)
    for u in range(network.stride, network.passable.size):
        graph.add_edge((u, "in"), (u, "out"), capacity=int(square[u * each]), weight=0)
        for direction, step in enumerate(network.offset.tolist()):
            below = u - network.stride + step
            cost = task.problem.costs[direction > 0]
            if network.passable[below]:
                head = "plate" if below < network.stride else (below, "in")
                tail = ((u, direction), head)
                graph.add_edge((u, "out"), tail, capacity=int(edge[(5 * u + direction) * each]), weight=cost)
                graph.add_edge(tail, head)
    return graph


@examples(15)
@given(st.integers(0, 100_000), st.sampled_from(["cut", "uniform"]))
def test_the_flow_is_the_cheapest_for_the_raised_capacities_in_networkx(seed, escalation):
    task = random_problem(seed, escalation=escalation)
    solved = solve_min_cost_flow(task, stop=Stop(), progress=silent)
    graph = graph_of(solved.task)
    flow = nx.max_flow_min_cost(graph, "red", "plate")
    assert sum(flow["red"].values()) == solved.connected.sum()
    assert nx.cost_of_flow(graph, flow) == cost_of(solved.task, solved.flow)


def test_the_judge_finds_raises_that_are_not_allowed_not_used_or_not_needed():
    task = floor_with_holes([3], edge_capacity=2, escalation="cut")
    plan = route("push-relabel", task)
    found = [each.message for each in check_plan(replace(task, escalation="none"), plan)]
    assert "raises capacities, which the problem does not allow" in found
    assert "the flow uses 5" in check_plan(task, replace(plan, raised=6))[0].message
    unused = replace(plan.edges, capacity=np.where(plan.edges.flow == 1, 3, plan.edges.capacity))
    idle = check_plan(task, replace(plan, edges=unused))
    assert "a raised capacity that it does not use" in idle[0].message
    wide = replace(task, edge_capacity=7)
    assert "although all 7 reachable" in check_raises(wide, plan)[0].message
    left = route("push-relabel", replace(task, escalation="none"))
    assert "leaves 5 red squares" in check_raises(task, left)[0].message
