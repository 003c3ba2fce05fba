"""Detours become straight, flow is conserved, and no support is moved into another one."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.grids import hanging, problem, random_problem, route

from amprep.checks.supports.plan import check_plan
from amprep.model import SupportEdges, SupportPlan
from amprep.model.supports import Voxel
from amprep.model.supports.edges import DIRECTIONS
from amprep.supports.routes.straightening import straighten


def path(start, directions, flow=1):
    """The rows of a path down from a square."""
    rows, (plane, y, x) = [], start
    for direction in directions:
        rows.append([plane, y, x, direction, flow, flow, 0])
        plane, y, x = plane - 1, y + DIRECTIONS[direction][0], x + DIRECTIONS[direction][1]
    return rows


def straightened(task, *paths):
    edges = SupportEdges.from_rows([row for rows in paths for row in rows]).merged()
    found = straighten(task, edges)
    assert check_plan(task, SupportPlan(found)) == []
    return found


def test_a_zig_zag_to_the_plate_becomes_a_straight_column():
    task = hanging((7, 5, 5), [(2, 2)])
    assert straightened(task, path((6, 2, 2), [3, 4, 3, 4, 1, 2])).direction.tolist() == [0] * 6


def test_a_path_around_an_obstacle_is_straight_below_it():
    task = hanging((7, 5, 5), [(2, 2)])
    voxels = task.voxels.copy()
    voxels[3, 2, 2] = Voxel.OCCUPIED
    task = problem(voxels, task.red)
    found = straightened(task, path((6, 2, 2), [0, 1, 1, 2, 0, 0]))
    assert np.count_nonzero(found.direction) == 1


def test_a_support_that_leans_on_the_plate_without_joining_another_becomes_straight():
    task = hanging((7, 5, 5), [(2, 2)])
    assert not straightened(task, path((6, 2, 2), [1, 1, 0, 0, 0, 0])).direction.any()


def test_a_path_that_joins_another_keeps_its_joint_and_goes_sideways_no_more_than_it_has_to():
    task = hanging((8, 5, 5), [(2, 2), (2, 4)])
    trunk = path((7, 2, 4), [0] * 7)
    found = straightened(task, trunk, path((7, 2, 2), [3, 1, 1, 4]), path((3, 2, 4), [0, 0, 0]))
    sideways = np.count_nonzero(found.direction)
    assert sideways == 2
    assert found.flow[(found.plane == 3) & (found.x == 4)].tolist() == [2]


def test_a_straight_column_that_another_support_uses_is_not_taken():
    task = hanging((7, 5, 5), [(2, 2), (2, 3)])
    task = problem(task.voxels, task.red)
    other = path((6, 2, 3), [0, 2, 0, 0, 0, 0])
    found = straightened(task, path((6, 2, 2), [2, 0, 0, 0, 0, 0]), other)
    # the first path finds its own column taken; afterwards the second one moves to its own column
    assert found.flow.tolist() == [1] * 12


def test_plans_stay_as_they_are_where_upright_edges_take_more_material():
    task = hanging((7, 5, 5), [(2, 2)])
    cheap = problem(task.voxels, task.red, material=(2.0, 1.0))
    assert straightened(cheap, path((6, 2, 2), [3, 4, 3, 4, 1, 2])).direction.all()


@given(seed=st.integers(0, 2**32))
@examples(60)
@pytest.mark.parametrize("router", ["shortest-paths", "tree"])
def test_plans_of_random_problems_stay_valid_with_at_most_as_many_oblique_edges(router, seed):
    task = random_problem(seed, escalation="none", edge_capacity=0, node_capacity=0)
    plan = route(router, task)
    edges = straighten(task, plan.edges)
    assert check_plan(task, SupportPlan(edges, plan.unconnected)) == []
    assert len(edges) == len(plan.edges)
    assert np.count_nonzero(edges.direction) <= np.count_nonzero(plan.edges.direction)


@given(seed=st.integers(0, 2**32))
@examples(40)
def test_chains_between_two_squares_have_the_fewest_oblique_edges_that_networkx_finds(seed):
    rng = np.random.default_rng(seed)
    voxels = (rng.random((6, 3, 3)) < 0.15).astype(np.uint8)
    graph = nx.DiGraph()
    for k, y, x in np.argwhere(voxels == Voxel.FREE).tolist():
        for dy, dx in DIRECTIONS:
            below = (k, y + dy, x + dx)
            if 0 <= below[1] < 3 and 0 <= below[2] < 3 and voxels[below] == Voxel.FREE:
                graph.add_edge((k + 1, y, x), below, weight=int((dy, dx) != (0, 0)))
    start, end = (6, 1, 1), (1, 1, 1)
    if start not in graph or end not in graph or not nx.has_path(graph, start, end):
        return
    walk = [start]
    while walk[-1] != end:
        after = [each for each in graph[walk[-1]] if each == end or nx.has_path(graph, each, end)]
        walk.append(after[int(rng.integers(len(after)))])
    steps = [DIRECTIONS.index((b[1] - a[1], b[2] - a[2])) for a, b in zip(walk, walk[1:], strict=False)]
    voxels[0, 1, 1] = Voxel.FREE
    task = problem(np.concatenate([voxels, np.ones((1, 3, 3), np.uint8)]), [start, end])
    found = straightened(task, path(start, steps), path(end, [0], flow=2))
    assert np.count_nonzero(found.direction) == nx.shortest_path_length(graph, start, end, weight="weight")
