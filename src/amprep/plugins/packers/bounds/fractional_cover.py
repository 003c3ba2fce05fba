"""The fractional covering bound: a lower bound on the builds from set covering over sets of boxes that may fit.

Column generation as in thesis 2.1, but priced by `amprep.kernels.boxes.pricing`, which is fast: it considers every
set of boxes that is not proved impossible. Feasible builds are among these sets, so the bound is valid for them
(Farley 1990, doi:10.1287/opre.38.5.922). Items of several boxes, orientations, clearance and round plates are relaxed
as in `relaxed_boxes`.
"""

import math
from collections.abc import Callable

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.kernels.boxes import pricing as kernel
from amprep.kernels.boxes.relations import relation_scratch
from amprep.model.control import Stop
from amprep.plugins.packers.bounds.combinatorial import counted_items, relaxed_boxes
from amprep.plugins.packers.bounds.dual_feasible import greatest_scales
from amprep.plugins.packers.instance.prepare import PreparedInstance

MOST_TYPES = 400
"""Greatest number of item types for which fractional covers are solved; with more they take too long."""

MOST_CHECKED, DECISIONS = 12, 3000
"""Greatest size of a set that is tested exactly, and greatest number of decisions of a test."""

SCALES, COLUMNS, MEMORY = 12, 10, 1 << 19
"""Number of conservative scales, of sets kept in a round, and of verdicts remembered."""

GOAL = 1.05
"""A set of this value is good enough to end a round of pricing early."""

SLACK = 1e-6
"""Rounding of lengths that are not multiples of a unit (mm), and of a bound (builds)."""


class CoveringBound:
    """The state of the column generation: its columns, and the bound proved so far.

    With more than `MOST_TYPES` item types nothing is tried, and the bound stays as it is.

    Attributes
    ----------
    builds
        The bound proved so far; at first a known one.
    spent
        Comparisons made.
    """

    def __init__(self, instance: PreparedInstance, known: int) -> None:
        self.builds, self.spent = known, 0.0
        counted = np.bincount(instance.type_of[counted_items(instance)], minlength=len(instance.types))
        kept = np.flatnonzero(counted) if np.count_nonzero(counted) <= MOST_TYPES else np.empty(0, np.int64)
        boxes, self.demand = relaxed_boxes(instance), counted[kept].astype(np.int64)
        types, most = len(kept), int(self.demand.sum())
        self.sets = kernel.Sets(
            self.demand,
            np.ascontiguousarray(boxes.size[kept]),
            boxes.room + SLACK,
            greatest_scales(boxes.size[kept] / boxes.room, self.demand, SCALES),
            _conflicts(boxes.size[kept], boxes.room),
            np.random.default_rng(0).integers(1, 2**63, types, dtype=np.uint64),
        )
        self.state = kernel.PricingState(
            memory=kernel.Memory(np.zeros(MEMORY, np.uint64), np.zeros(MEMORY, np.uint8)),
            chosen=np.zeros(most + 1, np.int64),
            keys=np.zeros(most + 2, np.uint64),
            held=np.zeros(types, np.int64),
            blocked=np.zeros(types, np.int64),
            left=np.ones(self.sets.load.shape[1]),
            sizes=np.zeros((MOST_CHECKED, 3)),
            relations=relation_scratch(MOST_CHECKED),
            outcome=np.zeros(4),
        )
        self.columns = np.eye(types, dtype=np.int64)

    def halt(self) -> None:
        """Make `prove` return soon; may be called from another thread."""
        self.state.outcome[kernel.HALT] = 1.0

    def prove(self, reached: Callable[[], int], work: float, stop: Stop) -> None:
        """Raise the bound until it meets the builds `reached`, cannot be raised, or `work` is used up."""
        while self._may_go_on(work, stop) and self.builds < reached():
            price = self._prices()
            if price is None:
                return
            total = float(price @ self.demand)
            code, value, found = self._price(price, work / 8.0)
            self.spent += 20.0 * self.columns.size
            if code == kernel.EXACT:
                self.builds = max(self.builds, math.ceil(total / max(1.0, value) - SLACK))
            if not len(found):
                return
            self.columns = np.concatenate((self.columns, found))

    def _may_go_on(self, work: float, stop: Stop) -> bool:
        halted = not len(self.demand) or self.state.outcome[kernel.HALT] or stop()
        return self.spent < work and not halted

    def _prices(self) -> Floats | None:
        """Return the dual values ``(k,)`` of the least fractional cover, at least 0; None if it was not found."""
        from scipy.optimize import linprog

        cover = -self.columns.T.astype(np.float64)
        solved = linprog(np.ones(len(self.columns)), A_ub=cover, b_ub=-self.demand, method="highs")
        return np.maximum(-solved.ineqlin.marginals, 0.0) if solved.success else None

    def _price(self, price: Floats, work: float) -> tuple[int, float, Int64s]:
        """Return the code of the pricing search, the greatest value of a set, and sets of value above 1."""
        load = np.maximum(self.sets.load.T, 1e-9)
        order = np.argsort(-price / load, axis=1, kind="stable")
        rank = np.empty(len(price), np.int64)
        rank[order[0]] = np.arange(len(price))
        columns, outcome = np.zeros((COLUMNS, len(price)), np.int64), self.state.outcome
        limits = kernel.PricingLimits(GOAL, work, MOST_CHECKED, DECISIONS)
        code = kernel.price(price, np.vstack((rank, order)), limits, self.sets, self.state, columns)
        self.spent += outcome[kernel.SPENT]
        return code, float(outcome[kernel.VALUE]), columns[: int(outcome[kernel.FOUND])]


def _conflicts(size: Floats, room: Floats) -> Bools:
    """Return the pairs of types ``(k, k)`` that exclude each other: they are too long together along every axis."""
    both = size[:, None] + size[None]
    return np.asarray((both > room + SLACK).all(axis=2))
