"""Check the optimality of a minimum-cost flow by its potentials alone."""

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.kernels.flow.records import UNREACHABLE
from amprep.plugins.routers.min_cost_flow import MinCostFlow


def find_optimality_violations(solved: MinCostFlow) -> list[str]:
    """Return which conditions of optimality a flow violates; none for a maximum flow of least cost.

    If no residual arc has a negative reduced cost, there is no residual cycle of negative cost (Ford and Fulkerson
    1962). This extends to the arcs that stand for leaving a red square out, if the red squares left out are at
    least as far from the plate as the connected ones. If capacities leave a red square out, a cut separates it
    from the plate: no residual arc leads from the far side of the cut to the near side.
    """
    task, (edge, square) = solved.task, solved.flow
    network, capacities, (vertical, oblique) = task.network, task.capacities, task.problem.costs
    inward, outward = (solved.potential[side::2].astype(np.int64) for side in (0, 1))
    red = np.zeros(network.passable.size, np.bool_)
    red[task.start[task.reachable]] = True
    usable = red | ((network.passable == 1) & (inward < UNREACHABLE))
    upper = np.flatnonzero(usable & (np.arange(usable.size) >= network.stride))
    has_capacity = square[upper] < capacities.square[upper * capacities.each]
    faults = _negative("into squares", outward[upper] - inward[upper], has_capacity)
    faults += _negative("out of squares", inward[upper] - outward[upper], square[upper] > 0)
    for direction, step in enumerate(network.offset):
        lower = upper - network.stride + step
        cost = oblique if direction else vertical
        limit = capacities.edge[(5 * upper + direction) * capacities.each]
        exists = (network.passable[lower] == 1) & (inward[lower] < UNREACHABLE)
        reduced_cost = cost + inward[lower] - outward[upper]
        faults += _negative("down edges", reduced_cost, exists & (edge[upper, direction] < limit))
        faults += _negative("up edges", -reduced_cost, exists & (edge[upper, direction] > 0))
    distance = inward[task.start]
    left = task.reachable & ~solved.connected
    if left.any() and distance[left].min() < distance[solved.connected].max(initial=0):
        faults.append("a red square left out is nearer to the plate than a connected one")
    return faults


def _negative(place: str, reduced_cost: Int64s, residual: Bools) -> list[str]:
    count = int((residual & (reduced_cost < 0)).sum())
    return [f"{count} residual arcs {place} have a negative reduced cost"] if count else []
