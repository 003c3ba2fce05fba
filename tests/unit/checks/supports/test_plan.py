"""The judge of plans refuses every kind of broken plan."""

from dataclasses import replace

import numpy as np
import pytest

from amprep.checks.supports.plan import check_plan
from amprep.geometry.voxels.grid import Grid
from amprep.model.supports import CAPACITY, ENCLOSED, OUT_OF_TIME, SupportPlan, SupportProblem, Unconnected
from amprep.model.supports.edges import SupportEdges


@pytest.fixture
def task():
    """Two red squares, four voxels above the plate, in an empty grid; one square further up is walled in."""
    voxels = np.zeros((6, 3, 5), np.uint8)
    voxels[4, 1, 1] = voxels[4, 1, 3] = 1
    voxels[4:, 0, :] = voxels[3:, 2, :] = 1
    voxels[0:4, 1, 4] = 1
    red = np.array([(4, 1, 1), (4, 1, 3), (4, 0, 4)])
    voxels[0:3, 0, 4] = 1
    voxels[3, 0, 4] = 0
    voxels[3, 0, 3] = 1
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    return SupportProblem(grid, voxels, red, np.zeros(3), np.zeros(3), voxels[0] == 0)


@pytest.fixture
def plan():
    """Two straight columns; the third red square is listed as enclosed, which it is."""
    planes = [4, 3, 2, 1] * 2
    nothing = np.zeros(8)
    edges = SupportEdges(planes, [1] * 8, [1] * 4 + [3] * 4, nothing, nothing + 1, nothing + 1)
    return SupportPlan(edges, (Unconnected(2, ENCLOSED),))


def changed(plan, index, **values):
    arrays = {name: np.array(getattr(plan.edges, name)) for name in values}
    for name, value in values.items():
        arrays[name][index] = value
    return replace(plan, edges=replace(plan.edges, **arrays))


def messages(task, plan):
    return " | ".join(f"{each.subject} {each.message}" for each in check_plan(task, plan))


def test_a_sound_plan_has_no_violations(task, plan):
    assert check_plan(task, plan) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x": 9}, "leads out of the grid"),
        ({"plane": 0}, "leads out of the grid"),
        ({"plane": 5}, "not free"),
        ({"direction": 4}, "not free|receives"),
        ({"direction": 7}, "leads out of the grid"),
        ({"flow": 0}, "carries no flow"),
        ({"flow": 2}, "more than its reported capacity"),
        ({"flow": 2, "capacity": 2}, "receives 2 and passes on 1"),
        ({"plane": 3}, "listed twice"),
    ],
)
def test_a_wrong_edge_is_found(task, plan, change, message):
    found = messages(task, changed(plan, 0, **change))
    assert any(each in found for each in message.split("|"))


def test_a_step_into_an_occupied_voxel_is_found(task, plan):
    assert "not free" in messages(task, changed(plan, 4, direction=1))


def test_a_column_that_ends_in_the_air_is_found(task, plan):
    short = replace(plan, edges=plan.edges[:-1])
    assert "receives 1 and passes on 0" in messages(task, short)


def test_red_squares_must_be_connected_or_listed_once_with_a_true_reason(task, plan):
    enclosed = plan.unconnected[0]
    assert "receives" in messages(task, replace(plan, unconnected=()))
    assert "twice" in messages(task, replace(plan, unconnected=(enclosed, enclosed)))
    assert "under 3" in messages(task, replace(plan, unconnected=(enclosed, Unconnected(3, ENCLOSED))))
    assert "expected one of the reasons" in messages(
        task, replace(plan, unconnected=(Unconnected(2, "tired"),))
    )
    assert "only if the plan's stop_reason" in messages(
        task, replace(plan, unconnected=(Unconnected(2, OUT_OF_TIME),))
    )
    assert "there is no path" in messages(task, replace(plan, unconnected=(Unconnected(2, CAPACITY),)))
    half = replace(plan, edges=plan.edges[:4])
    lazy = replace(half, unconnected=(enclosed, Unconnected(1, ENCLOSED)))
    assert "there is a path" in messages(task, lazy)
    lazy = replace(half, unconnected=(enclosed, Unconnected(1, CAPACITY)))
    assert "has no capacities" in messages(task, lazy)
    assert check_plan(replace(task, edge_capacity=1), lazy) == []


def test_red_squares_with_the_same_untrue_reason_are_one_violation(task, plan):
    listed = tuple(Unconnected(red, CAPACITY) for red in range(3))
    found = check_plan(task, replace(plan, edges=plan.edges[:0], unconnected=listed))
    assert [(each.subject, each.message) for each in found] == [
        ("red square 0", "listed as 'capacity', but the problem has no capacities (2 such squares)"),
        ("red square 2", "listed as 'capacity', but there is no path (1 such squares)"),
    ]


def merged_plan(plan):
    """Both columns joined in the middle: x 1 and 3 step to 2, then two straight edges of two paths."""
    edges = SupportEdges(
        [4, 4, 3, 2, 1], [1] * 5, [1, 3, 2, 2, 2], [1, 2, 0, 0, 0], [1, 1, 2, 2, 2], [1, 1, 2, 2, 2]
    )
    return SupportPlan(edges, plan.unconnected)


def test_capacities_of_the_problem_bind_edges_and_squares_above_the_plate(task, plan):
    joined = merged_plan(plan)
    assert check_plan(task, joined) == []
    assert "exceeds capacity 1" in messages(replace(task, edge_capacity=1), joined)
    assert "node capacity 1" in messages(replace(task, node_capacity=1), joined)
    assert check_plan(replace(task, node_capacity=2, edge_capacity=2), joined) == []


def test_flow_may_end_on_green_squares_only(task, plan):
    green = task.green.copy()
    green[1, 1] = False
    assert "not green" in messages(replace(task, green=green), plan)
