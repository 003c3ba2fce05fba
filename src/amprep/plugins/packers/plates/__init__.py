"""The packer `plates`: shadows of parts side by side, for printers on whose plates nothing is stacked.

Overlaps are allowed, and removed by guided local search on fields of depth (Umetani, Yagiura, Imahori, Imamichi,
Nonobe, Ibaraki 2009, doi:10.1111/j.1475-3995.2009.00707.x; Egeblad, Nielsen, Odgaard 2007,
doi:10.1016/j.ejor.2005.11.063) and by linear programs (Li, Milenkovic 1995, doi:10.1016/0377-2217(95)00021-H).
"""

from dataclasses import replace

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem, Unplaced
from amprep.plugins.packers.params import PlatesParams
from amprep.plugins.packers.plates.builds import pack_fewest
from amprep.plugins.packers.plates.enclosing import box_layout, pack_enclosing
from amprep.plugins.packers.plates.fill import pack_most
from amprep.plugins.packers.plates.prepare import prepare_plates, with_lowest_shapes
from amprep.plugins.packers.plates.result import as_packing
from amprep.plugins.packers.plates.shapes import PlateInstance
from amprep.plugins.packers.plates.state import make_scene, none_on_plates
from amprep.plugins.packers.separation.state import WorkBudget


def pack_plates(
    problem: PackingProblem,
    *,
    params: PlatesParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack the shadows of the items for any objective; nothing is below or above another item."""
    instance = prepare_plates(problem, params, stop)
    if instance is None:
        return _of_boxes(problem, rng, stop)
    budget = WorkBudget(stop, params.work * 1e6)
    if problem.objective == "height":
        found = _packed(with_lowest_shapes(instance), params, rng, budget, progress)
        if not found.unplaced or budget.over():
            return found
    return _packed(instance, params, rng, budget, progress)


def _packed(
    instance: PlateInstance,
    params: PlatesParams,
    rng: np.random.Generator,
    budget: WorkBudget,
    progress: Progress,
) -> Packing:
    """Return the best packing that is found within a budget."""
    problem, stop = instance.problem, budget.stop
    start = none_on_plates() if params.support_margin_mm > 0.0 else pack_enclosing(instance, rng, stop)
    if not instance.free.any() or stop():
        return as_packing(instance, start, stop)
    scene = make_scene(instance, params, rng, budget)
    if problem.objective == "builds":
        return as_packing(instance, pack_fewest(scene, start, progress), stop)
    values = np.array([item.value for item in problem.items])
    if problem.objective == "height":
        values = np.array([need.area for need in instance.needs])
    return as_packing(instance, pack_most(scene, start, values, progress), stop)


def _of_boxes(problem: PackingProblem, rng: np.random.Generator, stop: Stop) -> Packing:
    """Return a packing of the enclosing boxes, without a bound: there was no time for shadows."""
    packing = box_layout(problem, rng, stop)
    unplaced = tuple(Unplaced(each.item, "out of time") for each in packing.unplaced)
    return replace(packing, unplaced=unplaced, bound=None, status="feasible", stop_reason=stop.reason)
