"""The part of `auto` for fill problems: sorted orderings, then blocks of boxes, then disturbed orderings."""

import numpy as np

from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Progress, Stop
from amprep.plugins.packers.auto.enclosing_boxes import enclosing_instance, with_own_boxes
from amprep.plugins.packers.block_building import fill_by_blocks
from amprep.plugins.packers.block_building.integer_instance import is_of_single_boxes
from amprep.plugins.packers.bounds.combinatorial import fill_bound
from amprep.plugins.packers.extreme_points import ConstructivePass, PassRunner, constructive_passes, disturbed
from amprep.plugins.packers.instance.arrangement import PackerResult, value_of
from amprep.plugins.packers.instance.prepare import PreparedInstance
from amprep.plugins.packers.params import AutoParams, BlockBuildingParams

DISTURBANCE = 0.1
"""Greatest distance by which an item moves in a disturbed ordering, as a fraction of the number of items."""

ORDERINGS_FRACTION = 0.05
"""Fraction of the time and work for orderings before blocks are built."""


def fill_build(
    instance: PreparedInstance,
    *,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Fill one build: by the passes of `extreme-points`, by `block-building`, then by disturbed orderings.

    Blocks are built when every item is one box and the build volume is no cylinder. See `_fill_with_several_boxes` for
    the others.
    """
    if not is_of_single_boxes(instance):
        return _fill_with_several_boxes(instance, params, rng, stop, progress)
    early = stop.within(None if stop.deadline is None else ORDERINGS_FRACTION * stop.remaining())
    orderings = OrderingSearch(instance, params, rng, early)
    best = orderings.result(orderings.run(early, ORDERINGS_FRACTION * params.work))
    if best.stop_reason == "bound met" or stop():
        return best
    blocks = BlockBuildingParams(work=params.work * (1.0 - ORDERINGS_FRACTION))
    found = fill_by_blocks(instance, blocks, stop, progress)
    reason, results = found.stop_reason, [best, found]
    if reason == "no better one found":
        reason = orderings.run(stop, params.work)
        results.append(orderings.result(reason))
    best = max(results, key=lambda result: value_of(instance, result.arrangement))
    # an ordering that only the early limit ended leaves items for lack of room, once the blocks have had their time
    return best._replace(stop_reason=reason, complete=best.complete or not stop())


def _fill_with_several_boxes(
    instance: PreparedInstance,
    params: AutoParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Fill one build with items of several boxes, by orderings and by blocks of their enclosing boxes.

    The enclosing boxes lose the room inside them, but are packed far better by blocks than boxes by orderings. The
    items are then packed again in the order in which the blocks placed them, so that others use that room.
    """
    half = stop.within(None if stop.deadline is None else 0.5 * stop.remaining())
    orderings = OrderingSearch(instance, params, rng, half)
    best = orderings.result(orderings.run(half, 0.5 * params.work))
    enclosed = enclosing_instance(instance)
    if enclosed is None or best.stop_reason == "bound met" or stop():
        return best if stop() else orderings.result(orderings.run(stop, params.work))
    blocks = BlockBuildingParams(work=max(params.work - orderings.runner.work / 1e6, 0.0))
    found = fill_by_blocks(enclosed, blocks, stop, progress)
    packed = with_own_boxes(instance, enclosed, found.arrangement)
    orderings.repeat(packed, stop)
    again = orderings.result(orderings.run(stop, params.work) if not stop() else stop.reason)
    by_blocks = again._replace(arrangement=packed)
    return max(again, by_blocks, key=lambda result: value_of(instance, result.arrangement))


class OrderingSearch:
    """Packs one ordering after another by extreme points: the sorted ones, then disturbed copies of the best.

    Attributes
    ----------
    best
        The best result so far; the first ordering is packed at once.
    """

    def __init__(
        self, instance: PreparedInstance, params: AutoParams, rng: np.random.Generator, stop: Stop
    ) -> None:
        self.runner, self.rng, self.passes = PassRunner(instance), rng, constructive_passes(instance)
        self.bound = fill_bound(instance)
        self.number, self.last = 1, len(self.passes) + params.patience
        self.best = self.runner.run(self.passes[0], None, stop)

    def run(self, stop: Stop, work: float) -> str:
        """Go on until the bound is met, or the work, the time or the patience is used up; return the reason."""
        while not self._met():
            if stop():
                return stop.reason
            if self.runner.work > work * 1e6:
                return "work used up"
            if self.number >= self.last:
                return "no better one found"
            tried = self.passes[self.number] if self.number < len(self.passes) else self._disturbed()
            self.best = min(self.best, self.runner.run(tried, self.best, stop), key=lambda found: found.rank)
            self.number += 1
        return "bound met"

    def repeat(self, packed: Arrangement, stop: Stop) -> None:
        """Pack the items in the order of their heights in an arrangement, then the others, by each placement rule."""
        placed = np.flatnonzero(packed.build >= 0)
        x, y, z = packed.position[placed].T
        others = self.best.source.order[packed.build[self.best.source.order] < 0]
        order = np.concatenate((placed[np.lexsort((x, y, z))], others))
        for rule in np.unique([tried.rule for tried in self.passes], axis=0):
            if stop():
                return
            tried = ConstructivePass(order, rule)
            self.best = min(self.best, self.runner.run(tried, self.best, stop), key=lambda found: found.rank)
        self.last = self.number + self.last // 4

    def result(self, reason: str) -> PackerResult:
        """Return the best result so far."""
        return PackerResult(self.best.arrangement, self.bound, reason, self.best.complete)

    def _met(self) -> bool:
        """Return whether the bound is met."""
        return self.best.complete and -self.best.rank[0] >= self.bound - 1e-9 * abs(self.bound)

    def _disturbed(self) -> ConstructivePass:
        """Return a disturbed copy of the best ordering, with its own placement rule or that of a random pass."""
        tried = disturbed(self.best.source, DISTURBANCE, self.rng)
        other = self.passes[int(self.rng.integers(len(self.passes)))].rule
        return tried if self.rng.random() < 0.5 else tried._replace(rule=other)
