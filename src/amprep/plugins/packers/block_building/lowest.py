"""Boxes in one build, as low as possible, by blocks: a build is filled below a ceiling that comes down."""

from dataclasses import replace

import numpy as np

from amprep.model.control import Progress, Stop, silent
from amprep.plugins.packers.block_building import fill_by_blocks
from amprep.plugins.packers.block_building.integer_instance import is_of_single_boxes
from amprep.plugins.packers.instance.arrangement import HEIGHT_TOLERANCE, PackerResult, height_of
from amprep.plugins.packers.instance.prepare import PreparedInstance
from amprep.plugins.packers.lowest_build import with_ceiling
from amprep.plugins.packers.params import BlockBuildingParams

FIRST, LEAST, MOST = 0.02, 0.002, 0.1
"""Fraction by which a ceiling is below the best height: the first, the least and the greatest one."""

ATTEMPTS = 16
"""Number of ceilings among which the work is divided."""


def lowest_by_blocks(
    instance: PreparedInstance,
    start: PackerResult,
    params: BlockBuildingParams,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return a lower packing than that of a start, or the start if none is found.

    Below each ceiling a build is filled with the greatest volume. If that is the volume of all items, it is a lower
    packing, and the next ceiling is lower; else the next one is nearer to the best height.
    """
    placed = start.arrangement.build[instance.free] >= 0
    if not (placed.all() and start.complete) or not is_of_single_boxes(instance):
        return start
    share = replace(params, work=params.work / ATTEMPTS)
    best, height = start, height_of(instance, start.arrangement)
    step = FIRST
    for number in range(ATTEMPTS):
        if height <= start.bound + HEIGHT_TOLERANCE or step < LEAST or stop():
            break
        progress(number / ATTEMPTS, f"height {height:.4g} mm")
        ceiling = max(height * (1.0 - step), start.bound)
        found = fill_by_blocks(_filled(with_ceiling(instance, ceiling)), share, stop, silent)
        if (found.arrangement.build[instance.free] >= 0).all():
            best, height = (
                best._replace(arrangement=found.arrangement),
                height_of(instance, found.arrangement),
            )
            step = min(1.5 * step, MOST)
        else:
            step /= 2.0
    met = height <= start.bound + HEIGHT_TOLERANCE
    return best._replace(stop_reason="bound met" if met else stop.reason if stop() else "no better one found")


def _filled(instance: PreparedInstance) -> PreparedInstance:
    """Return the instance as a fill problem in which the value of an item is the volume of its box."""
    volume = [float(np.prod(instance.types[kind][0].size)) for kind in instance.type_of.tolist()]
    items = (replace(item, value=v) for item, v in zip(instance.problem.items, volume, strict=True))
    return replace(instance, problem=replace(instance.problem, items=tuple(items), objective="fill"))
