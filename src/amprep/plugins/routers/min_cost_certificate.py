"""Judges a min-cost flow by its potentials: by them alone it is of greatest value and least cost."""

import numpy as np

from amprep.arrays import Bools
from amprep.kernels.flow.residual import UNREACHED
from amprep.plugins.routers.min_cost_flow import MinCostFlow


def find_gaps(solved: MinCostFlow) -> list[str]:
    """Return what is missing in the proof of optimality; nothing in a correct answer.

    With potentials that no residual arc falls by more than its cost, no residual cycle is of negative cost
    (Ford and Fulkerson 1962); this holds for the arcs that stand for leaving a red square out too when those
    left out are at least as far from the plate as those connected. And when a red square is left out because
    of capacities, a cut must separate it from the plate: no residual arc leads from beyond it to below.
    """
    task, (flow, through) = solved.task, solved.carried
    network, room, (straight, oblique) = task.network, task.room, task.problem.costs
    inward, outward = (solved.potential[side::2].astype(np.int64) for side in (0, 1))
    red = np.zeros(network.via.size, np.bool_)
    red[task.start[task.open]] = True
    usable = red | ((network.via == 1) & (inward < UNREACHED))
    upper = np.flatnonzero(usable & (np.arange(usable.size) >= network.stride))
    faults = _ascents(
        "into squares", outward[upper] - inward[upper], through[upper] < room.square[upper * room.each]
    )
    faults += _ascents("out of squares", inward[upper] - outward[upper], through[upper] > 0)
    for direction, step in enumerate(network.offset):
        lower = upper - network.stride + step
        cost = oblique if direction else straight
        limit = room.edge[(5 * upper + direction) * room.each]
        legal = (network.via[lower] == 1) & (inward[lower] < UNREACHED)
        rise = cost + inward[lower] - outward[upper]
        faults += _ascents("down edges", rise, legal & (flow[upper, direction] < limit))
        faults += _ascents("up edges", -rise, legal & (flow[upper, direction] > 0))
    distance = inward[task.start]
    left = task.open & ~solved.connected
    if left.any() and distance[left].min() < distance[solved.connected].max(initial=0):
        faults.append("a red square left out is nearer to the plate than a connected one")
    return faults


def _ascents(where: str, reduced_cost: np.ndarray, residual: Bools) -> list[str]:
    count = int((residual & (reduced_cost < 0)).sum())
    return [f"{count} residual arcs {where} have a negative reduced cost"] if count else []
