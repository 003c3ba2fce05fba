"""The result of a packer on a prepared instance, and the packing that it means."""

from typing import NamedTuple

import numpy as np

from amprep.kernels.boxes.records import Arrangement
from amprep.model.packing import Packing, Placement, Status, Unplaced
from amprep.plugins.packers.instance.prepare import PreparedInstance

HEIGHT_TOLERANCE = 1e-10
"""Height (mm) above the bound that is rounding."""


class PackerResult(NamedTuple):
    """An arrangement, and the facts about it that a packing states.

    Attributes
    ----------
    bound
        Proven bound: fewest builds, greatest value of one build, or least height (mm).
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


def height_of(instance: PreparedInstance, arrangement: Arrangement) -> float:
    """Return the height (mm) of the highest item above the plate, fixed items included."""
    placed = arrangement.build >= 0
    height = np.array([orientation.size[2] for orientation in instance.orientations])
    tops = arrangement.position[placed, 2] + height[arrangement.orientation[placed]]
    return float(max(tops.max(initial=0.0), instance.fixed_hi[:, 2].max(initial=0.0)))


def status_of(instance: PreparedInstance, result: PackerResult) -> Status:
    """Return ``optimal`` when the bound is met, ``infeasible`` when an item to be built fits no build."""
    if instance.filling:
        reached = value_of(instance, result.arrangement)
        return "optimal" if reached >= result.bound - 1e-9 * abs(result.bound) else "feasible"
    if instance.too_large.any():
        return "infeasible"
    if instance.in_one_build:
        all_placed = not np.any(instance.free & (result.arrangement.build < 0))
        met = all_placed and height_of(instance, result.arrangement) <= result.bound + HEIGHT_TOLERANCE
    else:
        met = builds_used(instance, result.arrangement) <= result.bound
    return "optimal" if result.complete and met else "feasible"


def as_packing(instance: PreparedInstance, result: PackerResult) -> Packing:
    """Return a result as a packing, with a reason for every unplaced item."""
    build = result.arrangement.build
    left = "out of time" if not result.complete else "no room left" if instance.in_one_build else "too large"
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
