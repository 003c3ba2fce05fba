"""The router `tree`: least material, by local search over merges from two good starts."""

from copy import deepcopy
from dataclasses import replace

import numpy as np

from amprep.arrays import Int64s
from amprep.model.control import Progress, Stop, silent
from amprep.model.supports import SupportPlan, SupportProblem
from amprep.plugins.routers.min_cost_flow import solve_min_cost_flow
from amprep.plugins.routers.params import ShortestPathsParams, TreeParams
from amprep.plugins.routers.rip_up_and_reroute import Routing

_G = (1.0, 0.02, 0.0, 0.0)
"""Cost factors of the local search: an edge in use costs almost nothing, so the material of new edges counts."""


def route_tree(
    problem: SupportProblem,
    *,
    params: TreeParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> SupportPlan:
    """Use as little material as the search finds; an edge in use costs `problem.material`, whatever its flow.

    The search starts from the better of two plans: the plan of `shortest-paths` for the same `rng`, and a
    minimum-cost flow whose paths have been gathered by the same rounds of rip up and reroute. Then it reroutes the
    paths of neighbouring red squares by the material that new edges take, and keeps each change that uses no more
    material in all. So the result never uses more material than either start; the notes compare them. Capacities
    are treated as by `shortest-paths`.
    """
    stop = stop.within(params.seconds)
    gathering = ShortestPathsParams(paths_per_square=params.paths_per_square)
    from_paths = Routing(problem, gathering)
    from_paths.connect_all(stop, silent)
    from_flow = Routing(problem, gathering, problem.material)
    flow = solve_min_cost_flow(_with_capacities(problem, params), stop=stop, progress=silent)
    from_flow.adopt(flow)
    flow_material = from_flow.material
    for routing in (from_paths, from_flow):
        _gather(routing, deepcopy(rng), stop)
    paths_material = from_paths.material
    best = min(from_paths, from_flow, key=lambda each: (each.unrouted_count, each.material))
    if flow_material < best.material and flow.connected.sum() >= best.paths.routed.sum():
        best = Routing(problem, gathering, problem.material)
        best.adopt(flow)
    best.set_prices(_G, 0.0, problem.material)
    stop_reason = _improve(best, params, rng, stop, progress)
    material = best.material
    note = (
        f"tree takes {material:.6g} mm3 of material: "
        f"{_less(material, paths_material)} shortest-paths, {_less(material, flow_material)} min-cost-flow"
    )
    return replace(best.plan(stop_reason), notes=(note,) if best.paths.routed.any() else ())


def _with_capacities(problem: SupportProblem, params: TreeParams) -> SupportProblem:
    """Return the problem with the capacities that rip up and reroute keeps."""
    if problem.node_capacity or problem.edge_capacity or not params.paths_per_square:
        return problem
    return replace(problem, node_capacity=params.paths_per_square, escalation="uniform")


def _gather(routing: Routing, rng: np.random.Generator, stop: Stop) -> None:
    """Run the rounds of `shortest-paths`."""
    for chosen in routing.batches(rng):
        if stop():
            return
        routing.reroute(chosen)


def _improve(
    routing: Routing, params: TreeParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> str:
    """Reroute neighbouring red squares in each round; return why it ended."""
    for done in range(params.rounds if len(routing.reachable) else 0):
        if stop():
            return stop.reason
        routing.improve(_neighbours(routing, int(rng.choice(routing.reachable)), params.neighbours))
        progress((done + 1) / params.rounds, "merging supports")
    return "finished"


def _neighbours(routing: Routing, red: int, count: int) -> Int64s:
    """Return the `count` reachable red squares nearest to square number `red` in the horizontal plane."""
    square = routing.problem.red[routing.reachable, 1:].astype(np.int64)
    distance = ((square - routing.problem.red[red, 1:]) ** 2).sum(axis=1)
    nearest: Int64s = routing.reachable[np.argsort(distance, kind="stable")[:count]]
    return nearest


def _less(material: float, other: float) -> str:
    return f"{100 * (1 - material / other):.1f} % less than" if other > 0 else "as much as"
