"""The router `shortest-paths` on small grids with known answers, and against networkx."""

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.grids import hanging, problem

from amprep.checks.supports.plan import check_plan
from amprep.model.control import Stop, silent
from amprep.model.supports import CAPACITY, ENCLOSED, Voxel
from amprep.model.supports.graph import to_networkx
from amprep.plugins.routers.params import ShortestPathsParams
from amprep.plugins.routers.shortest_paths import route_shortest_paths


def route(task, seed=1, **params):
    plan = route_shortest_paths(
        task,
        params=ShortestPathsParams(**params),
        rng=np.random.default_rng(seed),
        stop=Stop(),
        progress=silent,
    )
    assert check_plan(task, plan) == []
    return plan


def rows(plan):
    return sorted(map(tuple, np.column_stack([plan.edges.upper, plan.edges.direction]).tolist()))


def test_a_lone_red_square_gets_a_straight_column():
    plan = route(hanging((6, 5, 5), [(2, 3)]))
    assert rows(plan) == [(p, 2, 3, 0) for p in range(1, 6)]
    assert plan.edges.flow.tolist() == [1] * 5


def test_two_columns_side_by_side_become_one_trunk():
    """Apart they cost 2 * 20 edges; joined after one sideways step 21."""
    plan = route(hanging((21, 5, 5), [(2, 2), (2, 3)]))
    assert len(plan.edges.flow) == 21
    assert np.bincount(plan.edges.flow).tolist() == [0, 2, 19]


def test_without_a_reward_for_sharing_paths_stay_straight():
    plan = route(hanging((21, 5, 5), [(2, 2), (2, 3)]), g=(1.0, 1.0), neighbour_discount=0.0)
    assert set(plan.edges.direction.tolist()) == {0}


def test_a_path_goes_round_what_is_below_with_the_fewest_sideways_steps():
    task = hanging((9, 7, 7), [(3, 3)])
    voxels = task.voxels.copy()
    voxels[2:4, 2:5, 2:5] = Voxel.OCCUPIED
    plan = route(replace(task, voxels=voxels))
    assert len(plan.edges.flow) == 8
    assert (plan.edges.direction > 0).sum() == 2


def test_a_red_square_above_a_closed_room_is_enclosed():
    task = hanging((9, 7, 7), [(3, 3), (1, 1)])
    voxels = task.voxels.copy()
    voxels[0:8, 2:5, 2:5] = Voxel.OCCUPIED
    voxels[1:8, 3, 3] = Voxel.FREE
    plan = route(replace(task, voxels=voxels))
    assert [(each.red, each.reason) for each in plan.unconnected] == [(0, ENCLOSED)]


def test_an_edge_needs_both_its_cubes_white():
    task = hanging((3, 3, 3), [(1, 1)])
    voxels = task.voxels.copy()
    voxels[1] = Voxel.OCCUPIED
    voxels[1, 1, 1] = Voxel.FREE
    voxels[0] = Voxel.CLOSED
    voxels[0, 1, 2] = Voxel.FREE
    sealed = replace(task, voxels=voxels, green=voxels[0] == Voxel.FREE)
    assert [each.reason for each in route(sealed).unconnected] == [ENCLOSED]
    voxels[0, 1, 1] = Voxel.FREE
    assert route(replace(task, voxels=voxels, green=voxels[0] == Voxel.FREE)).unconnected == ()


def funnel(count, **rules):
    """A row of red squares over a floor with one hole: every path must pass voxel (1, 1, count // 2)."""
    task = hanging((count + 3, 3, count), [(1, x) for x in range(count)], **rules)
    voxels = task.voxels.copy()
    voxels[1] = Voxel.OCCUPIED
    voxels[1, 1, count // 2] = Voxel.FREE
    return replace(task, voxels=voxels)


def test_capacities_are_kept_and_what_they_forbid_is_listed():
    assert len(route(funnel(7, node_capacity=2)).unconnected) == 5
    plan = route(funnel(7, edge_capacity=3))
    assert {each.reason for each in plan.unconnected} == {CAPACITY}
    assert len(plan.unconnected) == 4  # one edge leads into the hole: the vertical one
    assert plan.edges.capacity.tolist() == [3] * len(plan.edges.flow)


def test_paths_per_square_gives_way_where_all_must_pass_one_hole():
    plan = route(funnel(7), paths_per_square=2)
    assert plan.unconnected == ()
    assert plan.edges.flow.max() >= 3


def test_a_crowd_does_not_pile_up_in_one_square():
    task = hanging((30, 20, 20), [(y, x) for y in range(4, 16) for x in range(4, 16)])
    plan = route(task)
    inflow = np.bincount(
        np.ravel_multi_index(tuple(plan.edges.upper.T), (31, 20, 20)), weights=plan.edges.flow
    )
    assert inflow.max() <= 9
    assert len(plan.edges.flow) < 0.5 * 144 * 29


def test_the_same_seed_gives_the_same_plan():
    task = hanging((12, 9, 9), [(y, x) for y in range(2, 7) for x in range(2, 7)])
    first, second = route(task, seed=5), route(task, seed=5)
    assert rows(first) == rows(second)
    assert first.edges.flow.tolist() == second.edges.flow.tolist()


def test_a_stopped_run_still_connects_everything():
    task = hanging((12, 9, 9), [(4, 4), (4, 5)])
    stop = Stop()
    stop.cancelled.set()
    params = ShortestPathsParams()
    plan = route_shortest_paths(task, params=params, rng=np.random.default_rng(0), stop=stop, progress=silent)
    assert check_plan(task, plan) == []
    assert plan.unconnected == ()
    assert plan.stop_reason == "interrupted"


def test_a_problem_without_red_squares_gets_an_empty_plan():
    assert len(route(problem(np.zeros((3, 4, 5)), [])).edges) == 0


@pytest.mark.parametrize(
    "wrong",
    [
        {"g": ()},
        {"g": (-1.0,)},
        {"reroute_ratio": 0.0},
        {"rounds": -1},
        {"seconds": 0.0},
        {"paths_per_square": -1},
    ],
)
def test_parameters_out_of_bounds_are_refused(wrong):
    with pytest.raises(ValueError, match="must be"):
        ShortestPathsParams(**wrong)


@examples(60)
@given(st.integers(0, 100_000), st.sampled_from([(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 2)]))
def test_as_many_are_connected_as_a_maximum_flow_allows(seed, capacities):
    rng = np.random.default_rng(seed)
    voxels = (rng.random((6, 5, 5)) < rng.uniform(0.1, 0.5)).astype(np.uint8)
    red = [(p, y, x) for p, y, x in np.argwhere(voxels) if p > 0 and not voxels[p - 1, y, x]]
    task = problem(voxels, red, edge_capacity=capacities[0], node_capacity=capacities[1])
    plan = route(task, rounds=5)
    graph = to_networkx(task)
    value = nx.maximum_flow_value(graph, "source", "sink")
    assert len(red) - len(plan.unconnected) == value
