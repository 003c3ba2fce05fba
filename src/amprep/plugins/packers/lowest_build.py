"""Boxes in one build, as low as possible: constructive passes below a ceiling that comes down."""

from dataclasses import replace

import numpy as np

from amprep.kernels.boxes.records import LOW, MERIT_OF, WEIGHT
from amprep.model.control import Progress, Stop
from amprep.plugins.packers.bounds.combinatorial import height_bound
from amprep.plugins.packers.extreme_points import (
    ENOUGH,
    ConstructivePass,
    PassResult,
    PassRunner,
    constructive_passes,
    disturbed,
)
from amprep.plugins.packers.instance.arrangement import HEIGHT_TOLERANCE, PackerResult, height_of
from amprep.plugins.packers.instance.prepare import PreparedInstance
from amprep.plugins.packers.params import ExtremePointsParams

STEP = 0.002
"""Least fraction by which a ceiling is below the best height."""

# Strategy. Known: a packing of all items, found by passes that prefer low positions. A ceiling makes height a side of
# the build like the others, so that every placement rule is of use: a pass that places all items below the ceiling is
# a lower packing. The ceiling is first the bound, then halves the interval between the bound and the best height. Where
# it fails, the rest of the passes, and disturbed copies of the best ordering, are tried just below the best height.


def with_ceiling(instance: PreparedInstance, height: float) -> PreparedInstance:
    """Return the instance in a build volume of another height (mm), above which nothing may be."""
    corner = instance.space.hi.copy()
    corner[2] = height
    return replace(instance, space=instance.space._replace(hi=corner))


def lowest_by_orderings(
    instance: PreparedInstance,
    *,
    params: ExtremePointsParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the lowest packing of all items in one build that passes of extreme points find.

    Where not all items have room in one build, it is the packing with the most items.
    """
    search = CeilingSearch(instance, params, stop)
    search.begin()
    low = search.bound
    ceiling = low
    while search.goes_on() and search.height - low > STEP * search.height:
        progress(0.5, f"height {search.height:.4g} mm")
        if not search.below(ceiling, search.passes(ceiling)[:ENOUGH]):
            low = ceiling
        ceiling = (low + search.height) / 2.0
    further = search.passes(search.height)[ENOUGH:] if search.complete else []
    for number in range(len(further) + params.restarts):
        if not search.goes_on():
            break
        progress(0.5 + 0.5 * number / (len(further) + params.restarts), f"height {search.height:.4g} mm")
        random = number >= len(further)
        tried = disturbed(search.best.source, params.disturbance, rng) if random else further[number]
        search.below(search.height * (1.0 - STEP), [tried])
    return search.result()


def _saving_area(instance: PreparedInstance, passes: list[ConstructivePass]) -> list[ConstructivePass]:
    """Return passes that save plate area instead of height; without stacking they have room for more items."""
    changed = []
    for each in passes if instance.space.flat else ():
        rule = each.rule.copy()
        rule[WEIGHT + 2] = 0.0
        changed.append(each._replace(rule=rule))
    return changed


class CeilingSearch:
    """The lowest packing so far, and the passes below ceilings that make it lower.

    Attributes
    ----------
    best
        The result with the most items, then the lowest.
    height
        Height (mm) of the best result; infinite while items have no place.
    work
        Comparisons made so far.
    """

    def __init__(self, instance: PreparedInstance, params: ExtremePointsParams, stop: Stop) -> None:
        self.instance, self.params, self.stop = instance, params, stop
        self.bound, self.work = height_bound(instance), 0
        self.best: PassResult
        self.height = np.inf

    def begin(self) -> None:
        """Run the passes that prefer low positions in the whole build volume; the first one is always begun."""
        passes = constructive_passes(self.instance)
        low = [each for each in passes if each.rule[MERIT_OF] == LOW]
        chosen = [
            *low,
            *(each for each in passes if each.rule[MERIT_OF] != LOW),
            *_saving_area(self.instance, low),
        ]
        runner = PassRunner(self.instance)
        self._keep(runner.run(chosen[0], None, self.stop))
        for number, tried in enumerate(chosen[1:], start=1):
            enough = self.complete and number >= max(len(low), 1)
            self.work += runner.work
            runner.work = 0
            if enough or self.stop() or self.work > self.params.work * 0.5e6 or self._met():
                break
            self._keep(min(self.best, runner.run(tried, self.best, self.stop), key=lambda found: found.rank))

    @property
    def complete(self) -> bool:
        """Whether every item has a place."""
        return self.best.complete and self.best.rank[0] == 0

    def goes_on(self) -> bool:
        """Return whether a lower packing is possible and there are time and work left for it."""
        return self.complete and not self._met() and not self.stop() and self.work <= self.params.work * 1e6

    def passes(self, ceiling: float) -> list[ConstructivePass]:
        """Return the passes for a build of some height (mm), the most successful ones first."""
        return constructive_passes(with_ceiling(self.instance, ceiling))

    def below(self, ceiling: float, passes: list[ConstructivePass]) -> bool:
        """Run passes below a ceiling (mm) until one places all items; return whether one does."""
        runner = PassRunner(with_ceiling(self.instance, max(ceiling, self.bound)))
        for tried in passes:
            found = runner.run(tried, self.best, self.stop)
            self.work += runner.work
            runner.work = 0
            if found.complete and found.rank[0] == 0:
                self._keep(found)
                return True
            if not self.goes_on():
                return False
        return False

    def result(self) -> PackerResult:
        """Return the best packing."""
        reason = self.stop.reason if self.stop() else "bound met" if self._met() else "finished"
        return PackerResult(self.best.arrangement, self.bound, reason, self.best.complete)

    def _keep(self, found: PassResult) -> None:
        self.best = found
        self.height = height_of(self.instance, found.arrangement) if self.complete else np.inf

    def _met(self) -> bool:
        return self.height <= self.bound + HEIGHT_TOLERANCE
