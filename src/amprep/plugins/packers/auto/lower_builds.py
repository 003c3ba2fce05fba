"""Low builds as the second aim of a builds problem: each build of a packing is packed again, as low as possible."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.measures.objective import greatest_height
from amprep.measures.parts_bound import parts_bound
from amprep.model.control import Stop, silent
from amprep.model.packing import Packing, PackingProblem, Placement
from amprep.plugins.packers.auto.lists import in_lists
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.params import AutoParams, SeparationParams

BOXES_FRACTION = 0.05
"""Fraction of the work for boxes that each build gets."""

NEAR = 0.02
"""Fraction of the height above its bound up to which a build is low enough."""

LOWER = 1e-6
"""Height (mm) by which a build must be lower to replace another."""


class LowBuild(NamedTuple):
    """The placements of a build, their height (mm), and the excess of the convex pieces of items (`Packing.excess`)."""

    placements: tuple[Placement, ...]
    height: float
    excess: dict[int, float]


def lower_builds(
    problem: PackingProblem,
    packing: Packing,
    pack_boxes: Callable[..., PackerResult],
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
) -> Packing:
    """Return a packing with the same items in each build, and lower builds, or the given one if no build is lower.

    The last build, which is least full, comes first. Each build is packed as enclosing boxes, and if that leaves it
    higher than its bound, as true shapes.
    """
    builds = [_as_it_is(problem, packing, build) for build in packing.builds]
    share = 0.3 * params.separation / max(len(builds), 1)
    for number in reversed(range(len(builds))):
        if stop():
            break
        part = stop.within(stop.remaining() / (number + 1)) if stop.deadline is not None else stop
        builds[number] = _lowered(problem, builds[number], number, pack_boxes, params, share, rng, part)
    lowered = tuple(build.placements for build in builds)
    excess = {item: value for build in builds for item, value in build.excess.items()}
    return packing if lowered == packing.builds else replace(packing, builds=lowered, excess=excess)


def _as_it_is(problem: PackingProblem, packing: Packing, build: tuple[Placement, ...]) -> LowBuild:
    excess = {each.item: packing.excess[each.item] for each in build if each.item in packing.excess}
    return LowBuild(build, greatest_height(problem, build), excess)


def heights_of(problem: PackingProblem, packing: Packing) -> list[float]:
    """Return the height (mm) of each build."""
    return [greatest_height(problem, build) for build in packing.builds] or [0.0]


def _lowered(
    problem: PackingProblem,
    build: LowBuild,
    number: int,
    pack_boxes: Callable[..., PackerResult],
    params: AutoParams,
    work: float,
    rng: np.random.Generator,
    stop: Stop,
) -> LowBuild:
    """Return the lowest placements of the items of a build that are found."""
    items = [placement.item for placement in build.placements]
    own = in_lists(_alone(problem, items, number))
    bound = parts_bound(own)
    if build.height <= bound * (1.0 + NEAR):
        return build
    instance = prepare(own, enclosing=True)
    budget = replace(params, work=BOXES_FRACTION * params.work, patience=0)
    found = pack_boxes(instance, params=budget, rng=rng, stop=stop, progress=silent)
    build = _better(problem, build, items, as_packing(instance, found))
    if build.height <= bound * (1.0 + NEAR) or work <= 0.0 or stop():
        return build
    from amprep.plugins.packers.separation import pack_separation

    shaped = pack_separation(own, params=SeparationParams(work=work), rng=rng, stop=stop, progress=silent)
    return _better(problem, build, items, shaped)


def _alone(problem: PackingProblem, items: list[int], number: int) -> PackingProblem:
    """Return the height problem of some items, which are counted anew; fixed ones are in the first build."""
    new = {item: index for index, item in enumerate(items)}
    fixed = tuple(replace(placed, item=new[placed.item]) for placed in problem.fixed) if number == 0 else ()
    own = tuple(problem.items[item] for item in items)
    return replace(problem, items=own, objective="height", fixed=fixed)


def _better(problem: PackingProblem, build: LowBuild, items: list[int], found: Packing) -> LowBuild:
    """Return the lower one of a build and a packing of its items."""
    if found.unplaced or len(found.builds) != 1:
        return build
    placed = tuple(replace(each, item=items[each.item]) for each in found.builds[0])
    lower = greatest_height(problem, placed)
    excess = {items[item]: value for item, value in found.excess.items()}
    return LowBuild(placed, lower, excess) if lower < build.height - LOWER else build
