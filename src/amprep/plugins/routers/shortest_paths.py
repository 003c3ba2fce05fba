"""The router `shortest-paths`: iterated shortest paths that gather into trunks (thesis 3.4)."""

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.params import ShortestPathsParams
from amprep.plugins.routers.path_state import Drawing


def route_shortest_paths(
    problem: SupportProblem,
    *,
    params: ShortestPathsParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    """Draw a path from every red square, then redraw a random share of them round by round (thesis 3.4).

    First every path is shortest by the costs of `problem` alone. In each round the chosen paths are taken
    back, one sweep finds all distances under ``g(flow) * cost``, and the chosen paths are drawn again one
    after the other, each pricing its edges by the flow of that moment. Every red square is chosen equally
    often: the rounds go through random orders of all of them.

    Capacities are never exceeded: full edges and squares are closed to further paths, and red squares that
    find no way are connected by augmenting paths, so that the flow is maximal. When capacities may be raised
    for those that are left, all grow alike before the first round (``uniform``), or those of a minimum cut
    after the last one (``cut``). Without capacities in the problem, `paths_per_square` acts as one that grows
    until every red square with a way is connected.

    Every red square is drawn in ``O(squares)`` a round. Deterministic for one state of `rng`, unless a time
    limit ends it.
    """
    stop = stop.within(params.seconds)
    drawing = Drawing(problem, params)
    drawing.connect_all(stop, progress)
    stop_reason = "finished"
    for done, chosen in enumerate(drawing.choices(rng)):
        if stop():
            stop_reason = stop.reason
            break
        drawing.redraw(chosen)
        progress((done + 1) / params.rounds, "redrawing paths")
    if stop_reason == "finished":
        stop_reason = drawing.escalate(stop, progress)
    return drawing.plan(stop_reason)
