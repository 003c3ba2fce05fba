"""The router `auto`: choose one of the other routers by size and capacities, and report the reason."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.min_cost_flow import route_min_cost_flow
from amprep.plugins.routers.params import ShortestPathsParams, TreeParams
from amprep.plugins.routers.push_relabel import route_push_relabel
from amprep.plugins.routers.shortest_paths import route_shortest_paths
from amprep.plugins.routers.tree import route_tree

TIGHT = 2
"""Capacity up to which gathering paths saves little, because so few may share an edge."""

LARGEST_CONGESTED = 2_000_000
"""Number of voxels up to which a congested least-cost flow takes seconds rather than minutes."""

LARGEST_SEARCHED = 500_000
"""Number of voxels up to which the search for the least material takes about a second."""


class RouterChoice(NamedTuple):
    """A router's name, and the reason for choosing it."""

    router: str
    reason: str


def choose(problem: SupportProblem) -> RouterChoice:
    """Choose the router that suits a problem."""
    capacity = min((c for c in (problem.edge_capacity, problem.node_capacity) if c), default=0)
    voxels = f"{problem.voxels.size:,} voxels"
    if 0 < capacity <= TIGHT:
        few = f"a capacity of {capacity} hardly lets paths merge"
        if problem.voxels.size <= LARGEST_CONGESTED:
            return RouterChoice("min-cost-flow", f"{few}, so they should be straight")
        return RouterChoice(
            "push-relabel", f"{few}, and {voxels} are too many for a congested least-cost flow"
        )
    if problem.voxels.size <= LARGEST_SEARCHED:
        return RouterChoice("tree", f"{voxels} are few enough to search for the least material")
    return RouterChoice("shortest-paths", f"it merges paths quickly, and {voxels} are too many for `tree`")


def route_auto(
    problem: SupportProblem, *, rng: np.random.Generator, stop: Stop, progress: Progress
) -> SupportPlan:
    """Route by the router of `choose`; the plan's first note names it and the reason."""
    router, reason = choose(problem)
    if router == "min-cost-flow":
        plan = route_min_cost_flow(problem, stop=stop, progress=progress)
    elif router == "push-relabel":
        plan = route_push_relabel(problem, stop=stop, progress=progress)
    elif router == "tree":
        plan = route_tree(problem, params=TreeParams(), rng=rng, stop=stop, progress=progress)
    else:
        params = ShortestPathsParams()
        plan = route_shortest_paths(problem, params=params, rng=rng, stop=stop, progress=progress)
    return replace(plan, notes=(f"auto chose the router {router}: {reason}", *plan.notes))
