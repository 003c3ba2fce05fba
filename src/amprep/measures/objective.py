"""Measure how far a packing reaches its objective, and the gap to the bound."""

from collections.abc import Iterable

from amprep.measures.bounding_volume import points_of
from amprep.model.packing import Objective, Packing, PackingProblem, Placement


def objective_reached(problem: PackingProblem, packing: Packing) -> float:
    """Return the value of the objective.

    That is the number of builds, the total value of the placed items, or the height of the highest bounding volume
    above the plate (mm).
    """
    placed = [placement for build in packing.builds for placement in build]
    if problem.objective == "builds":
        return float(len(packing.builds))
    if problem.objective == "fill":
        return float(sum(problem.items[placement.item].value for placement in placed))
    return greatest_height(problem, placed)


def relative_gap(objective: Objective, reached: float, bound: float | None) -> float | None:
    """Return by which fraction of the reached value the objective may still improve; 0 is a proven optimum.

    None if no bound is known, or if nothing was reached.
    """
    if bound is None or reached <= 0.0:
        return None
    better = bound - reached if objective == "fill" else reached - bound
    return max(0.0, better) / reached


def greatest_height(problem: PackingProblem, placed: Iterable[Placement]) -> float:
    """Return the height (mm) of the highest of some placed volumes above the plate; 0 without any."""
    return max((_top(problem, placement) for placement in placed), default=0.0)


def _top(problem: PackingProblem, placement: Placement) -> float:
    points = points_of(problem.items[placement.item].volume)
    return float((points @ placement.rotation[2]).max() + placement.translation[2])
