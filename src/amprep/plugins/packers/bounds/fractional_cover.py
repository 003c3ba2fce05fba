"""How few builds can do, by a fractional cover: set covering over sets of boxes that may fit a build.

Column generation as in thesis 2.1, but priced by `amprep.kernels.boxes.pricing`: it considers every set of boxes
that is not proved impossible, and is fast for it. The bound holds for real builds all the more (Farley 1990,
doi:10.1287/opre.38.5.922). Items of several boxes, turns, clearance and round plates are relaxed as in
`relaxed_boxes`.
"""

import math
from collections.abc import Callable

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes import pricing as kernel
from amprep.kernels.boxes.relations import relation_scratch
from amprep.model.control import Stop
from amprep.plugins.packers.auto.set_covering import MOST_KINDS
from amprep.plugins.packers.bounds.dual_feasible import heavy_scales
from amprep.plugins.packers.bounds.relaxation import relaxed_boxes
from amprep.plugins.packers.bounds.volume import counted_items
from amprep.plugins.packers.instance.prepare import Scene

MOST_CHECKED = 12
"""Boxes up to which sets are looked at exactly."""


SCALES, COLUMNS, MEMORY, DECISIONS = 12, 10, 1 << 19, 3000
ENOUGH = 1.05
"""A set worth this much is good enough to go on with."""

SLACK = 1e-6
"""mm of rounding in lengths that are not multiples of a unit; and builds of rounding in a bound."""


class CoverBound:
    """The moving state of the column generation: columns so far, and the bound proved.

    With more than `MOST_KINDS` kinds nothing is tried: the bound stays at what is known.

    Attributes
    ----------
    builds
        What is proved so far; at first what is known already.
    spent
        Comparisons made.
    """

    def __init__(self, scene: Scene, known: int) -> None:
        self.builds, self.spent = known, 0.0
        counted = np.bincount(scene.kind[counted_items(scene)], minlength=len(scene.kinds))
        kept = np.flatnonzero(counted) if np.count_nonzero(counted) <= MOST_KINDS else np.empty(0, np.int64)
        boxes, self.demand = relaxed_boxes(scene), counted[kept].astype(np.int64)
        kinds, most = len(kept), int(self.demand.sum())
        self.sets = kernel.Sets(
            self.demand,
            np.ascontiguousarray(boxes.size[kept]),
            boxes.room + SLACK,
            heavy_scales(boxes.size[kept] / boxes.room, self.demand, SCALES),
            _conflicts(boxes.size[kept], boxes.room),
            np.random.default_rng(0).integers(1, 2**63, kinds, dtype=np.uint64),
        )
        self.memory = kernel.Memory(np.zeros(MEMORY, np.uint64), np.zeros(MEMORY, np.uint8))
        self.scratch = kernel.PricingScratch(
            np.zeros(most + 1, np.int64), np.zeros(most + 2, np.uint64), np.zeros(kinds, np.int64),
            np.zeros(kinds, np.int64), np.ones(self.sets.load.shape[1]), np.zeros((MOST_CHECKED, 3)),
        )  # fmt: skip
        self.relations = relation_scratch(MOST_CHECKED)
        self.columns = np.eye(kinds, dtype=np.int64)
        self.outcome = np.zeros(4)

    def halt(self) -> None:
        """Make `prove` return soon; may be called from another thread."""
        self.outcome[kernel.HALT] = 1.0

    def prove(self, reached: Callable[[], int], work: float, stop: Stop) -> None:
        """Raise the bound until it meets what is `reached`, cannot be raised, or `work` is used up."""
        while self._may_go_on(work, stop) and self.builds < reached():
            price = self._prices()
            if price is None:
                return
            total = float(price @ self.demand)
            code, worth, found = self._price(price, work / 8.0)
            self.spent += 20.0 * self.columns.size
            if code == kernel.EXACT:
                self.builds = max(self.builds, math.ceil(total / max(1.0, worth) - SLACK))
            if not len(found):
                return
            self.columns = np.concatenate((self.columns, found))

    def _may_go_on(self, work: float, stop: Stop) -> bool:
        halted = not len(self.demand) or self.outcome[kernel.HALT] or stop()
        return self.spent < work and not halted

    def _prices(self) -> Floats | None:
        """Return the dual values ``(k,)`` of the best fractional cover, at least 0; None if it was not found."""
        from scipy.optimize import linprog

        cover = -self.columns.T.astype(np.float64)
        solved = linprog(np.ones(len(self.columns)), A_ub=cover, b_ub=-self.demand, method="highs")
        return np.maximum(-solved.ineqlin.marginals, 0.0) if solved.success else None

    def _price(self, price: Floats, work: float) -> tuple[int, float, Int64s]:
        """Return whether the search was complete, the greatest worth of a set, and sets worth more than 1."""
        load = np.maximum(self.sets.load.T, 1e-9)
        order = np.argsort(-price / load, axis=1, kind="stable")
        place = np.empty(len(price), np.int64)
        place[order[0]] = np.arange(len(price))
        columns, outcome = np.zeros((COLUMNS, len(price)), np.int64), self.outcome
        code = kernel.price(
            price, np.vstack((place, order)), ENOUGH, work, MOST_CHECKED, DECISIONS, self.sets, self.memory,
            self.scratch, self.relations, columns, outcome,
        )  # fmt: skip
        self.spent += outcome[kernel.SPENT]
        return code, float(outcome[kernel.WORTH]), columns[: int(outcome[kernel.FOUND])]


def _conflicts(size: Floats, room: Floats) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    """Return which kinds do not go with which: along every axis they are too long together."""
    both = size[:, None] + size[None]
    return np.asarray((both > room + SLACK).all(axis=2))
