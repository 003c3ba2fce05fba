"""Capacities that give way: on grids small enough to know the answer, and needed by scipy's greatest flow."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from amprep.checks.supports import check_plan, check_raises
from amprep.host import Host
from amprep.model.control import Stop, silent
from amprep.model.supports import CAPACITY, Cube, GridFrame, SupportProblem
from amprep.plugins.supports.min_cost_flow import solve_min_cost_flow
from amprep.plugins.supports.min_cost_flow_proof import find_gaps

HOST = Host.load()
ROUTERS = ["min-cost-flow", "push-relabel", "shortest-paths"]


def problem(cubes, red, **rules):
    cubes = np.asarray(cubes, np.uint8)
    red = np.array(red, np.int32).reshape(-1, 3)
    nothing = np.zeros(len(red), np.int32)
    frame = GridFrame(np.zeros(3), 1.0, 1.0, cubes.shape)
    return SupportProblem(frame, cubes, red, nothing, nothing, cubes[0] == Cube.WHITE, **rules)


def floor_with_holes(holes, **rules):
    """Seven red squares in a row, high above a floor with holes at the given x."""
    cubes = np.zeros((12, 3, 7), np.uint8)
    cubes[11, 1] = cubes[1] = Cube.BLACK
    cubes[1, 1, list(holes)] = Cube.WHITE
    return problem(cubes, [(11, 1, x) for x in range(7)], **rules)


def route(router, task, stop=None):
    listed = HOST.choose("router", router)
    rng = np.random.default_rng(0)
    return HOST.call(
        listed, task, params=HOST.params(listed, {}), rng=rng, stop=stop or Stop(), report=silent
    )


@pytest.mark.parametrize("router", ROUTERS)
@pytest.mark.parametrize("rules", [{"edge_capacity": 2}, {"node_capacity": 2}], ids=str)
def test_all_come_through_one_hole_by_raising_what_is_at_it_alone(router, rules):
    task = floor_with_holes([3], escalation="cut", **rules)
    plan = route(router, task)
    assert check_plan(task, plan) == check_raises(task, plan) == []
    assert (plan.unconnected, plan.raised) == ((), 5)
    if "edge_capacity" in rules:
        assert set(plan.capacity.tolist()) <= set(range(2, 8))


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
    assert set(plan.capacity.tolist()) == {4}


@pytest.mark.parametrize("router", ROUTERS)
def test_without_escalation_they_are_listed(router):
    plan = route(router, floor_with_holes([3], node_capacity=2))
    assert [each.reason for each in plan.unconnected] == [CAPACITY] * 5
    assert plan.raised == 0


@pytest.mark.parametrize("router", ["min-cost-flow", "push-relabel"])
def test_a_stopped_escalation_is_a_legal_plan(router):
    class Late(Stop):
        """Says stop from the second time on."""

        def __call__(self):
            late, self.__dict__["asked"] = "asked" in self.__dict__, True
            return late

    task = floor_with_holes([3], node_capacity=1, escalation="cut")
    plan = route(router, task, Late())
    assert check_plan(task, plan) == []
    assert plan.stop_reason != "finished"


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 100_000), st.sampled_from(["cut", "uniform"]))
def test_every_red_square_with_a_way_is_served_and_what_was_raised_was_needed(seed, escalation):
    rng = np.random.default_rng(seed)
    cubes = (rng.random(tuple(rng.integers(3, 7, 3))) < rng.uniform(0.1, 0.5)).astype(np.uint8)
    red = [(p, y, x) for p, y, x in np.argwhere(cubes) if p > 0 and not cubes[p - 1, y, x]]
    edge, node = (int(each) for each in rng.integers(0, 3, 2))
    task = problem(cubes, red, edge_capacity=edge, node_capacity=node, escalation=escalation)
    for router in ROUTERS:
        plan = route(router, task)
        assert check_plan(task, plan) == check_raises(task, plan) == []
    assert find_gaps(solve_min_cost_flow(task, stop=Stop(), report=silent)) == []


def test_the_judge_finds_raises_that_are_not_allowed_not_used_or_not_needed():
    task = floor_with_holes([3], edge_capacity=2, escalation="cut")
    plan = route("push-relabel", task)
    found = [each.message for each in check_plan(replace(task, escalation="none"), plan)]
    assert "raises capacities, though the problem forbids it" in found
    assert "is used" in check_plan(task, replace(plan, raised=6))[0].message
    idle = check_plan(task, replace(plan, capacity=np.where(plan.flow == 1, 3, plan.capacity)))
    assert "a raised capacity that it does not use" in idle[0].message
    wide = replace(task, edge_capacity=7)
    assert "without that all 7" in check_raises(wide, plan)[0].message
    left = route("push-relabel", replace(task, escalation="none"))
    assert "leaves out 5" in check_raises(task, left)[0].message
