"""The built-in support routers."""

from collections.abc import Iterable

import numpy as np

from amprep.hookspecs import NoParams, SupportRouter, hookimpl, later
from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.params import ShortestPathsParams, TreeParams

amprep_api = 1


def _min_cost_flow(
    problem: SupportProblem,
    *,
    params: NoParams,  # noqa: ARG001  # the hook fixes the signature
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    from amprep.plugins.routers.min_cost_flow import route_min_cost_flow

    return route_min_cost_flow(problem, stop=stop, progress=progress)


def _push_relabel(
    problem: SupportProblem,
    *,
    params: NoParams,  # noqa: ARG001  # the hook fixes the signature
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    from amprep.plugins.routers.push_relabel import route_push_relabel

    return route_push_relabel(problem, stop=stop, progress=progress)


def _auto(
    problem: SupportProblem,
    *,
    params: NoParams,  # noqa: ARG001  # the hook fixes the signature
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    from amprep.plugins.routers.auto import route_auto

    return route_auto(problem, rng=rng, stop=stop, progress=progress)


@hookimpl
def amprep_support_routers() -> Iterable[SupportRouter]:
    """Yield the built-in support routers."""
    yield SupportRouter(
        name="shortest-paths",
        summary="Iterated shortest paths that merge where they can; fast on large grids (thesis 3.4).",
        run=later("amprep.plugins.routers.shortest_paths:route_shortest_paths"),
        params=ShortestPathsParams,
    )
    yield SupportRouter(
        name="min-cost-flow",
        summary="As many paths as the capacities allow at the least cost; exact (thesis 3.3).",
        run=_min_cost_flow,
    )
    yield SupportRouter(
        name="push-relabel",
        summary="As many paths as the capacities allow, vertical edges before oblique ones; the fastest (thesis 3.3).",
        run=_push_relabel,
    )
    yield SupportRouter(
        name="tree",
        summary="Least material: local search over merges, from shortest paths and from a least-cost flow.",
        run=later("amprep.plugins.routers.tree:route_tree"),
        params=TreeParams,
    )
    yield SupportRouter(
        name="auto",
        summary="Chooses one of the other routers by size and capacities, and reports the reason.",
        run=_auto,
    )
