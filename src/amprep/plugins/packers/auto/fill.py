"""The `fill` half of `auto`: sorted orders at once, then blocks of boxes, then disturbed orders."""

import numpy as np

from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.block_building import fill_by_blocks
from amprep.plugins.packers.block_building.integer_instance import is_of_single_boxes
from amprep.plugins.packers.bounds.volume import fill_bound
from amprep.plugins.packers.extreme_points import Runner
from amprep.plugins.packers.instance.orders import Pass, passes
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.instance.solution import Solution, as_packing
from amprep.plugins.packers.params import AutoParams, BlockBuildingParams

DISTURBANCE = 0.1
"""How far an item moves in a disturbed order, as a share of the number of items."""

ORDERS_SHARE = 0.05
"""Share of the time and work that goes into orders before blocks are built."""


def pack_fill(
    problem: PackingProblem, *, params: AutoParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Fill one build: by the sortings of `extreme-points`, by `block-building`, then by disturbed orders.

    Blocks are built when every item is one box and the build volume is no cylinder. The first pass is always
    begun, so that a late stop still gives an answer.
    """
    scene = prepare(problem)
    if not is_of_single_boxes(scene):
        orders = Orders(scene, params, rng, stop)
        return as_packing(scene, orders.best, orders.run(stop, params.work))
    early = stop.within(None if stop.deadline is None else ORDERS_SHARE * stop.remaining())
    orders = Orders(scene, params, rng, early)
    reason, best = orders.run(early, ORDERS_SHARE * params.work), orders.best
    if reason != "bound met" and not stop():
        work = params.work * (1.0 - ORDERS_SHARE)
        found, reason = fill_by_blocks(scene, BlockBuildingParams(work=work), stop, progress)
        best = min(best, found, key=_worth)
        if reason == "no better one found":
            reason = orders.run(stop, params.work)
            best = min(best, orders.best, key=_worth)
    return as_packing(scene, best, reason)


def _worth(solution: Solution) -> float:
    """Return what is smaller for a better one."""
    return solution.rank[0]


class Orders:
    """Packs one order of items after the other by extreme points: the sortings, then disturbed copies.

    Attributes
    ----------
    best
        The best packing so far; the first order is packed at once.
    """

    def __init__(self, scene: Scene, params: AutoParams, rng: np.random.Generator, stop: Stop) -> None:
        self.runner, self.rng, self.plans = Runner(scene), rng, passes(scene)
        self.bound = fill_bound(scene)
        self.number, self.last = 1, len(self.plans) + params.patience
        self.best = self.runner.run(self.plans[0], None, stop)

    def run(self, stop: Stop, work: float) -> str:
        """Go on until the bound is met, or the work, the time or the patience is used up; return which."""
        while not self._met():
            if stop():
                return stop.reason
            if self.runner.work > work * 1e6:
                return "work used up"
            if self.number >= self.last:
                return "no better one found"
            plan = self.plans[self.number] if self.number < len(self.plans) else self._disturbed()
            self.best = min(self.best, self.runner.run(plan, self.best, stop), key=lambda found: found.rank)
            self.number += 1
        return "bound met"

    def _met(self) -> bool:
        """Whether nothing can be better."""
        return self.best.complete and -self.best.rank[0] >= self.bound - 1e-9 * abs(self.bound)

    def _disturbed(self) -> Pass:
        """Return the best order with each item moved a little at random, under the style of some pass."""
        order, style = self.best.plan
        n = len(order)
        order = order[np.argsort(np.arange(n) + self.rng.uniform(0.0, DISTURBANCE * n, n))]
        other = self.plans[int(self.rng.integers(len(self.plans)))].style
        return Pass(order, style if self.rng.random() < 0.5 else other)
