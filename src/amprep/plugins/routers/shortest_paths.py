"""The router `shortest-paths`: iterated shortest paths that merge where they can (thesis 3.4)."""

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.params import ShortestPathsParams
from amprep.plugins.routers.rip_up_and_reroute import Routing


def route_shortest_paths(
    problem: SupportProblem,
    *,
    params: ShortestPathsParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    """Route a path from every red square, then rip up and reroute a random part of them in each round (thesis 3.4).

    The first paths are shortest by the costs of `problem` alone. In each round the chosen paths are ripped up, one
    sweep finds all distances under ``g(flow) * cost``, and the chosen paths are routed again one after another,
    each at the prices that the flow of that moment gives. The rounds go through random orders of all red squares,
    so every red square is chosen equally often.

    Capacities are never exceeded: full edges and squares are closed to further paths, and red squares that find
    no path are connected by augmentation, so that the flow is maximal. If capacities may be raised for the red
    squares that are left, they grow before the first round, and all paths are routed again with them. If the problem
    has no capacities, `paths_per_square` takes their place and grows until every reachable red square is connected.

    A round takes ``O(squares)``, plus ``O(planes)`` for each chosen path. The plan is the same for the same state
    of `rng`, unless a time limit ends the rounds.
    """
    stop = stop.within(params.seconds)
    routing = Routing(problem, params)
    routing.connect_all(stop, progress)
    stop_reason = "finished"
    for done, chosen in enumerate(routing.batches(rng)):
        if stop():
            stop_reason = stop.reason
            break
        routing.reroute(chosen)
        progress((done + 1) / params.rounds, "rerouting paths")
    return routing.plan(stop_reason)
