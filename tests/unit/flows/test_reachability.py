"""Reachable red squares: the planner's distances against the judge's sweep and networkx, on random grids."""

import networkx as nx
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.grids import hanging, random_problem

from amprep.checks.supports.plan import check_plan
from amprep.flows.reachability import find_reachable
from amprep.model.supports import CAPACITY, ENCLOSED, SupportEdges, SupportPlan, Unconnected
from amprep.model.supports.graph import to_networkx


def plan_without_paths(reasons):
    unconnected = tuple(Unconnected(red, reason) for red, reason in enumerate(reasons))
    return SupportPlan(SupportEdges.from_rows([]), unconnected=unconnected)


@examples(60)
@given(st.integers(0, 100_000))
def test_the_planner_and_the_judge_agree_on_what_is_reachable(seed):
    """The judge rejects a reason that contradicts its own sweep."""
    problem = random_problem(seed, node_capacity=1)
    reachable = find_reachable(problem)
    right = np.where(reachable, CAPACITY, ENCLOSED).tolist()
    assert check_plan(problem, plan_without_paths(right)) == []
    for red, is_reachable in enumerate(reachable.tolist()):
        wrong = [*right[:red], ENCLOSED if is_reachable else CAPACITY, *right[red + 1 :]]
        assert check_plan(problem, plan_without_paths(wrong)) != []


@examples(30)
@given(st.integers(0, 100_000))
def test_a_red_square_is_reachable_if_the_graph_has_a_path_to_the_sink(seed):
    problem = random_problem(seed)
    graph = to_networkx(problem)
    expected = [nx.has_path(graph, ("in", *square), "sink") for square in problem.red.tolist()]
    assert find_reachable(problem).tolist() == expected


def test_a_problem_without_red_squares_has_nothing_to_reach():
    assert find_reachable(hanging((3, 4, 5), [])).tolist() == []
