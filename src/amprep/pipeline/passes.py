"""Divide the overhangs of a build among passes of planning, and plan these in an order.

Regions with equal settings are supported together. The order is that of the job, unless another one connects more.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Ints
from amprep.model import PlacedPart
from amprep.model.supports import ENCLOSED
from amprep.overhangs.known import KnownOverhangs
from amprep.overhangs.of_part import PartOverhangs
from amprep.overhangs.paint import paint_of, split_by_paint
from amprep.overhangs.selection import measure_regions, select_regions
from amprep.pipeline.resolve import ResolvedJob
from amprep.supports.plan import SupportLayout


class TakenRegions(NamedTuple):
    """The overhangs of a build, and the rules that take their regions.

    Attributes
    ----------
    overhangs
        The overhangs of each placed part.
    rules
        For each placed part ``(r,)``: number of the ``[[rule]]`` entry, from 1, that takes each region; 0 where no
        entry does.
    """

    overhangs: tuple[PartOverhangs, ...]
    rules: tuple[Ints, ...]

    def chosen(self, numbers: Sequence[int], excepted: Sequence[int]) -> tuple[PartOverhangs, ...]:
        """Return the overhangs of the regions that rules take; contacts may not extend to `excepted` ones."""
        return tuple(
            select_regions(own, np.isin(taken, numbers), ~np.isin(taken, excepted))
            for own, taken in zip(self.overhangs, self.rules, strict=True)
        )

    @property
    def used(self) -> set[int]:
        """The numbers of the rules that take a region."""
        return {number for taken in self.rules for number in taken.tolist()}


class RegionPass(NamedTuple):
    """Regions with equal settings.

    Attributes
    ----------
    rules
        Numbers of the ``[[rule]]`` entries with these settings; 0 for the settings of the job.
    resolved
        The job with these settings.
    """

    rules: tuple[int, ...]
    resolved: ResolvedJob


def take_regions(
    resolved: ResolvedJob, parts: Sequence[PlacedPart], known: KnownOverhangs | None = None
) -> TakenRegions:
    """Find the overhangs of the parts, and for each region the first rule whose conditions it meets.

    Faces that are painted in a colour that a rule names are regions of their own. Overhangs that are `known` are not
    searched again.
    """
    job = resolved.job
    known = known or KnownOverhangs(job.supports)
    colours = {rule.paint or rule.colour for rule in job.rules if rule.colour is not None}
    overhangs, rules = [], []
    for placed in parts:
        own = known.of(placed)
        own = split_by_paint(placed, own if job.supports.has_limits else measure_regions(own), colours)
        paint = paint_of(placed, own, colours)
        overhangs.append(own)
        rules.append(
            np.array(
                [
                    next(
                        (
                            number
                            for number, rule in enumerate(job.rules, 1)
                            if rule.are_met(region, placed.part, painted)
                        ),
                        0,
                    )
                    for region, painted in zip(own.overhangs.regions, paint, strict=True)
                ],
                np.int32,
            )
        )
    return TakenRegions(tuple(overhangs), tuple(rules))


def passes_of(resolved: ResolvedJob, taken: TakenRegions) -> tuple[tuple[RegionPass, ...], tuple[int, ...]]:
    """Return the passes of a build, the first with the settings of the job, and the rules that allow no supports.

    Rules that take no region make no pass.
    """
    job = resolved.job
    excepted = tuple(number for number, rule in enumerate(job.rules, 1) if not rule.support)
    passes = [RegionPass((0,), resolved)]
    for number in sorted(taken.used - {0, *excepted}):
        own = resolved.for_rule(number)
        for index, each in enumerate(passes):
            if (each.resolved.job.cells, each.resolved.job.supports) == (own.job.cells, own.job.supports):
                passes[index] = each._replace(rules=(*each.rules, number))
                break
        else:
            passes.append(RegionPass((number,), own))
    return tuple(passes), excepted


class PlannedPass(NamedTuple):
    """One pass of planning: some of the overhangs of a build, supported with the same settings.

    Attributes
    ----------
    rules
        Numbers of the ``[[rule]]`` entries with these settings, from 1; 0 for the settings of the job.
    pitch_mm
        Horizontal size of a voxel of the support grid.
    layout
        Layout of the supports.
    """

    rules: tuple[int, ...]
    pitch_mm: float
    layout: SupportLayout


PlanPass = Callable[[int, Sequence[PlannedPass]], PlannedPass]
"""Plans the pass of a number around the passes that were planned before it."""


def plan_in_order(count: int, plan: PlanPass) -> tuple[PlannedPass, ...]:
    """Return all passes, planned one after another; a pass that others enclose is planned first instead.

    Only red squares that have a way without the other passes count as enclosed by them. An order is kept if more red
    squares are connected in it, so the result is never worse than the order of the job.

    Parameters
    ----------
    count
        Number of passes, which are returned by their numbers.
    plan
        Plans one pass.
    """
    best = _planned(range(count), plan)
    for number in range(1, count):
        enclosed = _enclosed(best[number])
        if not enclosed or _enclosed(plan(number, ())) >= enclosed:
            continue
        again = _planned([number, *(each for each in range(count) if each != number)], plan)
        if _unconnected(again) < _unconnected(best):
            best = again
    return tuple(best)


def _planned(order: Iterable[int], plan: PlanPass) -> list[PlannedPass]:
    """Plan passes in an order, and return them by their numbers."""
    done: dict[int, PlannedPass] = {}
    for number in order:
        done[number] = plan(number, tuple(done.values()))
    return [done[number] for number in sorted(done)]


def _enclosed(planned: PlannedPass) -> int:
    """Return the number of red squares without a way."""
    return planned.layout.reasons.count(ENCLOSED)


def _unconnected(planned: Sequence[PlannedPass]) -> int:
    """Return the number of red squares that are not connected."""
    return sum(int((~each.layout.connected).sum()) for each in planned)
