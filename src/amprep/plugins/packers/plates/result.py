"""Layouts on plates as packings, with a reason for every item that is left out."""

from dataclasses import replace

import numpy as np

from amprep.measures.objective import objective_reached
from amprep.model.control import Stop
from amprep.model.packing import Packing, PackingProblem, Placement, Status, Unplaced
from amprep.plugins.packers.bounds.reasons import with_proved_reasons
from amprep.plugins.packers.plates.bounds import builds_bound, fill_bound, height_bound
from amprep.plugins.packers.plates.shapes import PlateInstance
from amprep.plugins.packers.plates.state import OnPlates


def as_packing(instance: PlateInstance, placed: OnPlates, stop: Stop) -> Packing:
    """Return a layout as a packing, with a reason for every item that is left out."""
    problem = instance.problem
    builds = _builds(instance, placed)
    inside = {placement.item for build in builds for placement in build}
    left = [item for item in range(len(problem.items)) if item not in inside]
    reason = "out of time" if stop() else "no room left"
    bound = {"height": height_bound, "builds": builds_bound, "fill": fill_bound}[problem.objective](instance)
    packing = Packing(
        builds=builds,
        unplaced=tuple(Unplaced(i, "too large" if instance.too_large[i] else reason) for i in left),
        bound=float(bound),
        bound_for=problem.bound_for,
        stop_reason=stop.reason if stop() else "finished",
    )
    return with_proved_reasons(problem, replace(packing, status=_status(instance, packing, float(bound))))


def _builds(instance: PlateInstance, placed: OnPlates) -> tuple[tuple[Placement, ...], ...]:
    """Return the placements of each build that has any: fixed ones first, then by item, last those of items alone."""
    problem = instance.problem
    builds: list[list[Placement]] = [[] for _ in range(max(placed.plates, 1))]
    builds[0] += problem.fixed
    for row in np.argsort(placed.items, kind="stable").tolist():
        placement = instance.placement(int(placed.items[row]), int(placed.shape[row]), placed.position[row])
        builds[int(placed.plate[row])].append(placement)
    alone = np.flatnonzero(instance.alone).tolist()
    if problem.objective == "builds":
        builds += [[_alone(instance, item)] for item in alone]
    elif alone and not problem.fixed:
        best = max(alone, key=lambda item: problem.items[item].value)
        if not builds[0] or problem.items[best].value > _value(problem, builds[0]):
            builds[0] = [_alone(instance, best)]
    return tuple(tuple(build) for build in builds if build)


def _alone(instance: PlateInstance, item: int) -> Placement:
    """Return the placement of an item that is alone in a build, beside the forbidden zones."""
    shapes = range(int(instance.first[item]), int(instance.end[item]))
    shape = next(k for k in shapes if instance.shapes[k].fits_alone)
    return instance.placement(item, shape, instance.shapes[shape].beside_zones)


def _value(problem: PackingProblem, build: list[Placement]) -> float:
    return float(sum(problem.items[placement.item].value for placement in build))


def _status(instance: PlateInstance, packing: Packing, bound: float) -> Status:
    """Return ``optimal`` when the bound is met, ``infeasible`` when an item that is to be built fits no build."""
    problem = instance.problem
    if problem.objective == "fill":
        reached = sum(_value(problem, list(build)) for build in packing.builds)
        return "optimal" if reached >= bound - 1e-9 * max(1.0, abs(bound)) else "feasible"
    if instance.too_large.any():
        return "infeasible"
    if packing.unplaced:
        return "feasible"
    if problem.objective == "builds":
        return "optimal" if len(packing.builds) <= bound else "feasible"
    return "optimal" if objective_reached(problem, packing) <= bound + 1e-9 else "feasible"
