"""Paths that leave the cones of the red squares they carry are routed again; flows are taken apart path by path."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.grids import problem, random_problem, route

from amprep.checks.supports.plan import check_plan
from amprep.geometry.supports.drift import DriftLimits, have_path_within
from amprep.model import SupportEdges, SupportPlan
from amprep.model.supports import ENCLOSED, Unconnected, Voxel
from amprep.supports.routes.drifting import reroute_drifting, take_apart

LIMITS = DriftLimits(1.0, 1.0, 1 / 3, 15.0)


def connected_of(task, plan):
    left = [each.red for each in plan.unconnected]
    return np.setdiff1d(np.arange(len(task.red)), left)


@given(seed=st.integers(0, 2**32))
@examples(60)
@pytest.mark.parametrize("router", ["shortest-paths", "min-cost-flow"])
def test_a_flow_is_one_path_from_each_connected_red_square_to_the_plate(router, seed):
    task = random_problem(seed)
    plan = route(router, task)
    connected = connected_of(task, plan)
    squares = {int(red): [task.red[red].tolist()] for red in connected}
    flow = np.zeros(len(plan.edges), np.int64)
    for red, edge in take_apart(plan.edges, task.red, connected):
        np.add.at(flow, edge, 1)
        for each, one in zip(red.tolist(), edge.tolist(), strict=True):
            assert squares[each][-1] == plan.edges.upper[one].tolist()
            squares[each].append(plan.edges.lower[one].tolist())
    assert (flow == plan.edges.flow).all()
    assert all(path[-1][0] == 0 for path in squares.values())


@given(seed=st.integers(0, 2**32))
@examples(60)
def test_afterwards_every_square_carries_a_red_square_that_is_near_enough(seed):
    task = random_problem(seed, edge_capacity=0, node_capacity=0)
    open_to = have_path_within(task.voxels == Voxel.FREE, task.red, LIMITS)
    if not open_to.any():
        return
    task = problem(task.voxels, task.red[open_to])
    plan = route("push-relabel", task)
    edges, lost = reroute_drifting(task, plan.edges, connected_of(task, plan), LIMITS)
    assert lost.size == 0
    assert check_plan(task, SupportPlan(edges, plan.unconnected)) == []
    near: dict[tuple[int, ...], bool] = {}
    for red, edge in take_apart(edges, task.red, np.arange(len(task.red))):
        for each, one in zip(red.tolist(), edge.tolist(), strict=True):
            lower, top = edges.lower[one], task.red[each]
            within = np.hypot(*(lower - top)[1:]) <= LIMITS.at(top[0] - lower[0] - 1)
            near[tuple(lower.tolist())] = near.get(tuple(lower.tolist()), False) or bool(within)
    assert all(near.values())


def test_red_squares_without_a_path_within_the_drift_are_left_over():
    voxels = np.zeros((5, 1, 9), np.uint8)
    voxels[4, 0, 0] = Voxel.OCCUPIED
    voxels[1, 0, :2] = Voxel.OCCUPIED
    task = problem(voxels, [(4, 0, 0)])
    plan = route("min-cost-flow", task)
    assert plan.unconnected == ()
    edges, lost = reroute_drifting(task, plan.edges, np.array([0]), LIMITS)
    assert lost.tolist() == [0]
    assert len(edges) == 0
    assert check_plan(task, SupportPlan(edges, (Unconnected(0, ENCLOSED),))) != []  # a router must connect it


def test_plans_without_drift_are_returned_as_they_are():
    task = problem(np.zeros((4, 3, 3), np.uint8), [(4, 1, 1)])
    edges = SupportEdges.from_rows([[p, 1, 1, 0, 1, 1, 0] for p in (4, 3, 2, 1)])
    assert reroute_drifting(task, edges, np.array([0]), LIMITS)[0] is edges
