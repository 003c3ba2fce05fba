"""The packing that the integer program starts from: of extreme points, or of blocks where these are better."""

import numpy as np

from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Progress, Stop
from amprep.plugins.packers.block_building import fill_by_blocks
from amprep.plugins.packers.block_building.integer_instance import is_of_single_boxes
from amprep.plugins.packers.extreme_points import construct
from amprep.plugins.packers.instance.arrangement import PackerResult, status_of, value_of
from amprep.plugins.packers.instance.prepare import PreparedInstance
from amprep.plugins.packers.params import BlockBuildingParams, ExtremePointsParams, IpParams

WORK = 20.0
"""Work of `block-building`, some tenths of a second; more of it changed nothing up to 35 boxes."""

FRACTION = 0.25
"""Greatest fraction of the time that is left for blocks."""


def heuristic_packing(
    instance: PreparedInstance,
    params: IpParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the better one of the packings by extreme points and, in a fill problem, by blocks."""
    known = construct(instance, params=ExtremePointsParams(), rng=rng, stop=stop, progress=progress)
    known = known._replace(found_by="extreme points")
    useful = instance.filling and params.start == "blocks" and is_of_single_boxes(instance)
    if not useful or status_of(instance, known) == "optimal" or stop():
        return known
    early = stop.within(None if stop.deadline is None else FRACTION * stop.remaining())
    found = fill_by_blocks(instance, BlockBuildingParams(work=WORK), early, progress)
    if value_of(instance, found.arrangement) <= value_of(instance, known.arrangement):
        return known
    return found._replace(found_by="block building", stop_reason=known.stop_reason)


def without_start(known: PackerResult) -> PackerResult:
    """Return the result with nothing packed, so that any packing of the solver is better."""
    return known._replace(arrangement=Arrangement.unassigned(len(known.arrangement.build)), found_by="")
