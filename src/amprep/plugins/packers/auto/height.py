"""The part of `auto` for the lowest build: orderings below a ceiling that comes down, then blocks of boxes."""

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.plugins.packers.block_building.lowest import lowest_by_blocks
from amprep.plugins.packers.instance.arrangement import PackerResult
from amprep.plugins.packers.instance.prepare import PreparedInstance
from amprep.plugins.packers.lowest_build import lowest_by_orderings
from amprep.plugins.packers.params import AutoParams, BlockBuildingParams, ExtremePointsParams

ORDERINGS_FRACTION = 0.1
"""Fraction of the time and work for orderings before blocks are built."""


def lower_build(
    instance: PreparedInstance,
    *,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Pack into one low build: by the passes of `extreme-points`, then by `block-building`.

    Blocks are built when every item is one box and the build volume is no cylinder; else further orderings are tried.
    """
    early = stop.within(None if stop.deadline is None else ORDERINGS_FRACTION * stop.remaining())
    orderings = ExtremePointsParams(work=ORDERINGS_FRACTION * params.work, restarts=params.patience)
    found = lowest_by_orderings(instance, params=orderings, rng=rng, stop=early, progress=progress)
    if found.stop_reason == "bound met" or stop():
        return found
    blocks = BlockBuildingParams(work=params.work * (1.0 - ORDERINGS_FRACTION))
    return lowest_by_blocks(instance, found, blocks, stop, progress)
