"""What a pass of a packer found, and the packing it stands for."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.packing import Packing, Placement, Status, Unplaced
from amprep.plugins.packers.bounds.volume import builds_bound, fill_bound
from amprep.plugins.packers.instance.orders import Pass
from amprep.plugins.packers.instance.prepare import Scene, placements


@dataclass(frozen=True, eq=False)
class Solution:
    """What a pass found: per item its build (-1: none), variant and place.

    Attributes
    ----------
    rank
        Smaller for a better one.
    complete
        False when it was stopped on its way.
    """

    plan: Pass
    rank: tuple[float, ...]
    complete: bool
    build: Int64s
    variant: Int64s
    place: Floats


def value_of(scene: Scene, build: Int64s) -> float:
    """Return the value of what is placed, fixed items included."""
    fixed = [placement.item for placement in scene.problem.fixed]
    return sum(scene.problem.items[i].value for i in [*np.flatnonzero(build >= 0).tolist(), *fixed])


def as_packing(scene: Scene, best: Solution, stop_reason: str, *, proved: int | None = None) -> Packing:
    """Return the solution as a packing, with what is known: the builds it takes are `proved`, or bounded here."""
    filling = scene.problem.objective == "fill"
    builds = _builds(scene, best)
    left = "out of time" if not best.complete else "no room left" if filling else "too large"
    reasons = {int(i): "too large" for i in np.flatnonzero(scene.too_large)}
    reasons |= {int(i): left for i in np.flatnonzero(scene.free & (best.build < 0))}
    bound = fill_bound(scene) if filling else float(builds_bound(scene) if proved is None else proved)
    reached = value_of(scene, best.build) if filling else float(len(builds))
    return Packing(
        builds=builds,
        unplaced=tuple(Unplaced(i, reasons[i]) for i in sorted(reasons)),
        bound=bound,
        status=_status(scene, best, reached, bound),
        stop_reason=stop_reason,
    )


def _status(scene: Scene, best: Solution, reached: float, bound: float) -> Status:
    """Return ``optimal`` when the bound is met, ``infeasible`` when an item to be built fits nowhere."""
    if scene.problem.objective == "fill":
        return "optimal" if reached >= bound - 1e-9 * abs(bound) else "feasible"
    if scene.too_large.any():
        return "infeasible"
    return "optimal" if best.complete and reached <= bound else "feasible"


def _builds(scene: Scene, best: Solution) -> tuple[tuple[Placement, ...], ...]:
    """Return the builds, the fixed placements first, then by item."""
    count = max(int(best.build.max(initial=-1)) + 1, 1 if scene.problem.fixed else 0)
    builds: list[tuple[Placement, ...]] = []
    for number in range(count):
        items = np.flatnonzero(best.build == number)
        placed = placements(scene, items.tolist(), best.variant[items].tolist(), best.place[items])
        builds.append((*(scene.problem.fixed if number == 0 else ()), *placed))
    return tuple(builds)
