"""The result of a packer on a prepared instance, and the packing that it means."""

from typing import NamedTuple

import numpy as np

from amprep.kernels.boxes.records import Arrangement
from amprep.model.packing import Packing, Placement, Status, Unplaced
from amprep.plugins.packers.instance.prepare import PreparedInstance


class PackerResult(NamedTuple):
    """An arrangement, and the facts about it that a packing states.

    Attributes
    ----------
    bound
        Proven bound: fewest builds, or greatest value of one build.
    complete
        False when items are unplaced because the packer had to stop.
    found_by
        The method that found the arrangement, where the packer has several.
    """

    arrangement: Arrangement
    bound: float
    stop_reason: str
    complete: bool = True
    found_by: str = ""


def value_of(instance: PreparedInstance, arrangement: Arrangement) -> float:
    """Return the total value of the placed items, fixed items included."""
    fixed = [placement.item for placement in instance.problem.fixed]
    items = [*np.flatnonzero(arrangement.build >= 0).tolist(), *fixed]
    return float(sum(instance.problem.items[item].value for item in items))


def builds_used(instance: PreparedInstance, arrangement: Arrangement) -> int:
    """Return the number of builds; fixed items always take the first one."""
    return max(arrangement.builds, 1 if instance.problem.fixed else 0)


def status_of(instance: PreparedInstance, result: PackerResult) -> Status:
    """Return ``optimal`` when the bound is met, ``infeasible`` when an item to be built fits no build."""
    if instance.filling:
        reached = value_of(instance, result.arrangement)
        return "optimal" if reached >= result.bound - 1e-9 * abs(result.bound) else "feasible"
    if instance.too_large.any():
        return "infeasible"
    met = builds_used(instance, result.arrangement) <= result.bound
    return "optimal" if result.complete and met else "feasible"


def as_packing(instance: PreparedInstance, result: PackerResult) -> Packing:
    """Return a result as a packing, with a reason for every unplaced item."""
    build = result.arrangement.build
    left = "out of time" if not result.complete else "no room left" if instance.filling else "too large"
    out = np.flatnonzero((instance.free & (build < 0)) | instance.too_large).tolist()
    return Packing(
        builds=_builds(instance, result.arrangement),
        unplaced=tuple(Unplaced(item, "too large" if instance.too_large[item] else left) for item in out),
        bound=result.bound,
        status=status_of(instance, result),
        stop_reason=result.stop_reason,
        found_by=result.found_by,
        bound_for=instance.problem.bound_for,
    )


def _builds(instance: PreparedInstance, arrangement: Arrangement) -> tuple[tuple[Placement, ...], ...]:
    """Return the placements of each build: the fixed ones first, then by item."""
    builds = []
    for number in range(builds_used(instance, arrangement)):
        placed = list(instance.problem.fixed if number == 0 else ())
        for item in np.flatnonzero(arrangement.build == number).tolist():
            chosen = instance.orientations[arrangement.orientation[item]]
            placed.append(Placement(item, chosen.rotation, arrangement.position[item] + chosen.shift))
        builds.append(tuple(placed))
    return tuple(builds)
