"""The built-in support routers."""

from collections.abc import Iterable

import numpy as np

from amprep.hookspecs import SupportRouter, hookimpl
from amprep.model.control import Report, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.supports.params import ShortestPathsParams

amprep_api = 1


def _shortest_paths(
    problem: SupportProblem,
    *,
    params: ShortestPathsParams,
    rng: np.random.Generator,
    stop: Stop,
    report: Report,
) -> SupportPlan:
    from amprep.plugins.supports.shortest_paths import route_shortest_paths

    return route_shortest_paths(problem, params=params, rng=rng, stop=stop, report=report)


@hookimpl
def amprep_support_routers() -> Iterable[SupportRouter]:
    """Yield the built-in support routers."""
    yield SupportRouter(
        name="shortest-paths",
        summary="Iterated shortest paths that gather into trunks; fast on large grids (thesis 3.4).",
        run=_shortest_paths,
        params=ShortestPathsParams,
    )
