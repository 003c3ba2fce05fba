"""The packer `separation`: overlaps are allowed, and removed by guided local search on no-fit solids.

After Umetani, Yagiura, Imahori, Imamichi, Nonobe, Ibaraki 2009 (doi:10.1111/j.1475-3995.2009.00707.x) and Egeblad,
Nielsen, Brazil 2009 (doi:10.1016/j.comgeo.2008.03.004): the builds are fixed, items may overlap, and one overlapping
item at a time moves to the position of least weighted overlap.
"""

from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.measures.bounding_volume import points_of
from amprep.measures.objective import objective_reached
from amprep.measures.parts_bound import parts_bound
from amprep.measures.too_large import proved_too_large
from amprep.model.bounding_volume import Solid
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem, Placement, Status, Unplaced
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.boxes import better_as_boxes
from amprep.plugins.packers.separation.builds import pack_builds
from amprep.plugins.packers.separation.fill import pack_most
from amprep.plugins.packers.separation.height import pack_lowest
from amprep.plugins.packers.separation.no_fit import prepare_no_fit
from amprep.plugins.packers.separation.shapes import ShapeInstance, prepare_shapes
from amprep.plugins.packers.separation.state import UNLIMITED, Placed, Scene, WorkBudget, nothing_placed, only

TOP_TOLERANCE = 1e-6
"""Length (mm) by which an item may be higher than the build volume."""

ROUNDING = 1e-5
"""Length (mm) by which pieces may be larger than an item that they contain exactly."""

DEFAULT_WORK = 6000.0
"""Work of all workers if neither time nor work is limited, in millions of field values."""


def pack_separation(
    problem: PackingProblem,
    *,
    params: SeparationParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack true shapes, as convex pieces, for any objective; or their boxes when time is too short."""
    progress(0.0, "convex pieces of the parts")
    instance = prepare_shapes(problem, stop)
    budget = WorkBudget(stop, _work(params, stop))
    progress(0.0, "no-fit solids of the parts")
    no_fit = prepare_no_fit(instance, params, stop) if instance.free.any() else None
    bound, placed = parts_bound(problem, np.flatnonzero(instance.too_large).tolist()), nothing_placed()
    if no_fit is not None:
        scene = Scene(instance, no_fit, params, rng, budget, progress)
        pack = {"height": pack_lowest, "builds": pack_builds, "fill": pack_most}[problem.objective]
        placed = _below_top(instance, pack(scene, bound))
    packing = _as_packing(instance, placed, budget, bound)
    early = no_fit is None or budget.over()
    if early and any(unplaced.reason != "too large" for unplaced in packing.unplaced):
        return better_as_boxes(problem, packing, rng, stop)
    return packing


def _work(params: SeparationParams, stop: Stop) -> float:
    """Return the work in field values; without limit if only the time is limited."""
    if params.work is None:
        return DEFAULT_WORK * 1e6 if stop.deadline is None else UNLIMITED
    return params.work * 1e6


def _below_top(instance: ShapeInstance, placed: Placed) -> Placed:
    """Return the items that are not higher than the build volume."""
    problem = instance.problem
    tops = placed.position[:, 2] + instance.size[placed.shape, 2]
    limit = instance.positions(float(problem.space.size[2]) - problem.clearance).hi[:, 2]
    fits = placed.position[:, 2] <= limit[placed.shape] + TOP_TOLERANCE
    return placed if fits.all() or not len(tops) else only(placed, np.flatnonzero(fits))


def _as_packing(instance: ShapeInstance, placed: Placed, budget: WorkBudget, bound: float) -> Packing:
    """Return a layout as a packing, with a reason for every item that is left out.

    The bound is for packings without all items that have no known position, also those not proved to be too large.
    """
    problem, builds = instance.problem, _builds(instance, placed)
    left = np.setdiff1d(np.flatnonzero(instance.free | instance.too_large), placed.items)
    reason = "out of time" if budget.stop() else "no room left"
    claimed = set(np.flatnonzero(instance.too_large).tolist())
    too_large = proved_too_large(problem, claimed)
    if too_large != claimed:
        bound = parts_bound(problem, too_large)
    packing = Packing(
        builds=builds,
        unplaced=tuple(Unplaced(int(i), "too large" if i in too_large else reason) for i in left),
        bound=bound,
        stop_reason=_stop_reason(budget),
        bound_for=problem.bound_for,
        excess=_excess(instance, placed),
    )
    return replace(packing, status=_status(problem, packing, infeasible=bool(too_large)))


def _excess(instance: ShapeInstance, placed: Placed) -> dict[int, float]:
    """Return the excess of the pieces of each placed solid; other volumes are pieces themselves."""
    items = instance.problem.items
    return {k: float(instance.excess[k]) for k in placed.items.tolist() if isinstance(items[k].volume, Solid)}


def _stop_reason(budget: WorkBudget) -> str:
    if budget.stop():
        return budget.stop.reason
    return "work used up" if budget.left <= 0.0 else "finished"


def _builds(instance: ShapeInstance, placed: Placed) -> tuple[tuple[Placement, ...], ...]:
    """Return the placements of each build that has any: the fixed ones first, then by item."""
    builds: list[list[Placement]] = [[] for _ in range(max(placed.builds, 1))]
    builds[0] += instance.problem.fixed
    for row in np.argsort(placed.items, kind="stable").tolist():
        shape = instance.shapes[placed.shape[row]]
        position = placed.position[row] + shape.shift
        item = int(placed.items[row])
        position[2] -= _air(instance, item, shape.rotation, position)
        builds[int(placed.build[row])].append(Placement(item, shape.rotation, position))
    return tuple(tuple(build) for build in builds if build)


def _air(instance: ShapeInstance, item: int, rotation: Floats, position: Floats) -> float:
    """Return how far an item is above the lift, if it is only for the rounding of its pieces; else 0."""
    lowest = (points_of(instance.problem.items[item].volume) @ rotation[2]).min() + position[2]
    air = float(lowest - instance.low[2])
    return air if abs(air) < ROUNDING else 0.0


def _status(problem: PackingProblem, packing: Packing, *, infeasible: bool) -> Status:
    """Return ``optimal`` when the bound is met, ``infeasible`` when an item that is to be built fits no build."""
    reached, bound = objective_reached(problem, packing), packing.bound or 0.0
    slack = 1e-9 * max(1.0, abs(reached))
    if problem.objective == "fill":
        return "optimal" if reached >= bound - slack else "feasible"
    if packing.unplaced:
        return "infeasible" if infeasible else "feasible"
    return "optimal" if reached <= bound + slack else "feasible"
