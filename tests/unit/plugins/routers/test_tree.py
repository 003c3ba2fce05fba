"""The routers `tree` and `auto`: no more material than the routers they start from; choices with reasons."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples

from amprep.checks.supports.plan import check_plan, check_raises
from amprep.geometry.voxels.grid import Grid
from amprep.host import Host
from amprep.model.control import Stop, silent
from amprep.model.supports import SupportProblem, Voxel
from amprep.plugins.routers import auto
from amprep.plugins.routers.params import TreeParams
from amprep.testing.support_scenes import support_scene

pytestmark = pytest.mark.compiled

HOST = Host.load()


def route(router, task, stop=None, **table):
    listed, rng = HOST.choose("router", router), np.random.default_rng(3)
    params = HOST.params(listed, table)
    plan = HOST.call(listed, task, params=params, rng=rng, stop=stop or Stop(), progress=silent)
    assert check_plan(task, plan) == []
    return plan


def material(task, plan):
    return float(np.array(task.material)[np.minimum(plan.edges.direction, 1)].sum())


@pytest.mark.parametrize("name", ["ball", "two-balls", "plate"])
@pytest.mark.parametrize("rules", [{}, {"edge_capacity": 3}, {"material": (1.0, 3.0)}], ids=str)
def test_it_takes_no_more_material_than_the_routers_it_starts_from(name, rules):
    task = replace(support_scene(name, 30), **rules)
    plan = route("tree", task)
    assert plan.objective == material(task, plan)
    for other in ("shortest-paths", "min-cost-flow"):
        assert plan.objective <= material(task, route(other, task))
    assert "shortest-paths" in plan.notes[0]


def test_four_columns_in_a_square_become_one_trunk():
    """Apart 4 * 20 edges; the least known joins them by 3 sideways steps and goes down as one."""
    voxels = np.zeros((21, 6, 6), np.uint8)
    red = np.array([(20, y, x) for y in (2, 3) for x in (2, 3)])
    voxels[tuple(red.T)] = Voxel.OCCUPIED
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    task = SupportProblem(grid, voxels, red, np.zeros(4), np.zeros(4), voxels[0] == Voxel.FREE)
    assert route("tree", task).objective <= 24


def shaft():
    """Nine red squares above a shaft of one square."""
    voxels = np.zeros((12, 7, 7), np.uint8)
    voxels[:4] = Voxel.CLOSED
    voxels[:4, 3, 3] = Voxel.FREE
    red = np.array([(11, y, x) for y in (2, 3, 4) for x in (2, 3, 4)])
    voxels[tuple(red.T)] = Voxel.OCCUPIED
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    return SupportProblem(grid, voxels, red, np.zeros(9), np.zeros(9), voxels[0] == Voxel.FREE)


def test_its_note_tells_what_raised_capacities_take():
    task = replace(shaft(), node_capacity=1, escalation="cut")
    plan = route("tree", task)
    (note,) = plan.notes
    assert note.startswith(f"tree takes {material(task, plan):.6g} mm3 of material: ")


@pytest.mark.parametrize(("router", "most"), [("tree", 31), ("shortest-paths", 32), ("auto", 31)])
def test_paths_are_gathered_again_where_capacities_were_raised(router, most):
    """Each row of three joins at once to a trunk of six edges, the last one into the shaft, and goes down as one.

    Three times 3 + 6 edges and 4 in the shaft. Paths that the capacity of 3 had made avoid the shaft took 52 edges.
    """
    task = replace(shaft(), node_capacity=3, escalation="cut")
    plan = route(router, task)
    assert (plan.unconnected, plan.raised) == ((), 6)
    assert material(task, plan) <= most


@examples(12)
@given(st.integers(0, 100_000))
def test_it_connects_as_many_as_the_exact_routers(seed):
    rng = np.random.default_rng(seed)
    voxels = (rng.random((7, 5, 5)) < rng.uniform(0.1, 0.5)).astype(np.uint8)
    red = np.array([(p, y, x) for p, y, x in np.argwhere(voxels) if p > 0 and not voxels[p - 1, y, x]])
    nothing = np.zeros(len(red), np.int32)
    grid = Grid(np.zeros(3), 1.0, 1.0, voxels.shape)
    edge, node = (int(each) for each in rng.integers(0, 3, 2))
    task = SupportProblem(
        grid, voxels, red.reshape(-1, 3), nothing, nothing, voxels[0] == Voxel.FREE, edge, node
    )
    for escalation in ("none", "cut", "uniform"):
        again = replace(task, escalation=escalation)
        plan = route("tree", again, rounds=5)
        assert check_raises(again, plan) == []
        assert len(plan.unconnected) == len(route("push-relabel", again).unconnected)


def test_a_stopped_search_is_a_legal_plan():
    stop = Stop()
    stop.cancelled.set()
    assert route("tree", support_scene("ball", 20), stop).stop_reason == "interrupted"


@pytest.mark.parametrize("wrong", [{"rounds": -1}, {"neighbours": 0}, {"seconds": 0.0}])
def test_parameters_out_of_bounds_are_refused(wrong):
    with pytest.raises(ValueError, match="must be"):
        TreeParams(**wrong)


@pytest.mark.parametrize(
    ("rules", "searched", "congested", "expected"),
    [
        ({}, 10**6, 10**6, "tree"),
        ({}, 10, 10**6, "shortest-paths"),
        ({"node_capacity": 1}, 10**6, 10**6, "min-cost-flow"),
        ({"edge_capacity": 2}, 10**6, 10, "push-relabel"),
        ({"edge_capacity": 3}, 10**6, 10**6, "tree"),
    ],
)
def test_auto_picks_by_size_and_capacity_and_says_so(monkeypatch, rules, searched, congested, expected):
    monkeypatch.setattr(auto, "LARGEST_SEARCHED", searched)
    monkeypatch.setattr(auto, "LARGEST_CONGESTED", congested)
    task = replace(support_scene("ball", 16), **rules)
    plan, chosen = route("auto", task), route(expected, task)
    assert plan.notes[0].startswith(f"auto chose the router {expected}: ")
    assert plan.edges.flow.tolist() == chosen.edges.flow.tolist()
