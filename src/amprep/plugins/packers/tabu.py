"""The packer `tabu`: Lodi, Martello and Vigo's tabu search over the sub-heuristic of touching areas."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.boxes.build_space import union_volume
from amprep.kernels.boxes import tabu as kernel
from amprep.kernels.boxes.places import FINISHED, PAUSED
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.volume import builds_bound
from amprep.plugins.packers.extreme_points import Runner
from amprep.plugins.packers.instance.orders import Pass
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.instance.solution import Solution, as_packing
from amprep.plugins.packers.params import TabuParams
from amprep.plugins.packers.sweep import best_rows

MOST_BINS = 20_000_000
"""Boxes that may be in builds, a build for each item, 48 bytes each."""

PAUSE = 4_000_000
"""Comparisons between two looks at `stop`, some 20 ms."""


def pack_tabu(
    problem: PackingProblem, *, params: TabuParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack into as few builds as possible by tabu search (thesis 2.4).

    After Lodi, Martello, Vigo, EJOR 141 (2002), doi:10.1016/S0377-2217(02)00134-0. What the thesis leaves
    open: a penalty is tabu while it is among the last `tenure` penalties of moves with the same k; after a
    strong diversification d and k start anew; the search ends when the lower bound is met, or after
    `patience` strong diversifications in vain. No random numbers are drawn.
    """
    del rng
    scene = prepare(problem)
    bound = builds_bound(scene)
    search = TabuSearch(scene, params)
    reason = "finished" if not len(search.items) else ""
    while not reason:
        if search.best_count <= bound:
            reason = "bound met"
        elif stop():
            reason = stop.reason
        elif search.work > params.work * 1e6:
            reason = "work used up"
        elif search.idle > params.patience:
            reason = "no better one found"
        else:
            progress(min(search.work / (params.work * 1e6), 1.0), f"{search.best_count} builds")
            if not search.search(stop):
                search.diversify()
    return as_packing(scene, search.best(), reason)


@dataclass(eq=False)
class State:
    """Where the items are: build (-1: nowhere), variant as the kernel numbers them, place."""

    build: Int64s
    variant: Int64s
    place: Floats

    def copy(self) -> "State":
        """Return a copy that keeps what it is."""
        return State(self.build.copy(), self.variant.copy(), self.place.copy())


class TabuSearch:
    """The search's moving state: the solution, the best one, k, d and the tabu lists."""

    def __init__(self, scene: Scene, params: TabuParams) -> None:
        self.params, self.scene = params, scene
        runner = Runner(scene)
        self.shapes, self.room = runner.shapes, runner.room
        self.zones = runner.obstacles[: runner.zones]
        volume = _volumes(scene)
        free = np.flatnonzero(scene.free)
        self.items = free[np.lexsort((free, scene.kind[free], -volume[free]))]
        self.share = volume / scene.problem.space.volume_mm3
        self.work, self.k, self.d, self.idle = 0, 1, 0, 0
        self.tabu = np.full((params.most_tuple + 1, max(params.tenure, 1)), -1.0)
        self._allocate()
        self.current = self._start()
        self._best = self.current.copy()
        if len(self.items):
            # a solution to fall back on should the time be short; the search itself starts as in the thesis
            packed = (self._heuristic() if params.start == "separate" else None) or self._rows()
            self._best = packed if packed.build.max() < self._best.build.max() else self._best
        self.target = self._by_filling()[0] if len(self.items) else 0

    @property
    def best_count(self) -> int:
        """Builds of the best solution."""
        return int(self._best.build.max(initial=-1)) + 1

    def best(self) -> Solution:
        """Return the best solution."""
        best = self._best
        plan = Pass(self.items, np.empty(0))
        variant = best.variant - self.shapes.first_variant[self.scene.kind]
        return Solution(plan, (float(self.best_count),), True, best.build, variant, best.place)

    def search(self, stop: Stop) -> bool:
        """Move one item out of the target build, as thesis 2.4 says under Search; False to diversify."""
        others = np.array([b for b in range(self._count()) if b != self.target], np.int64)
        self.least[kernel.PENALTY] = np.inf
        for item in self.items[self.current.build[self.items] == self.target].tolist():
            self.cursor[kernel.STARTED] = 0
            code = PAUSED
            while code == PAUSED:
                code = self._explore(item, others)
                if code == PAUSED and (stop() or self.work > self.params.work * 1e6):
                    return True
            if code != FINISHED:
                if code == kernel.FEWER:
                    self.k = max(1, self.k - 1)
                self._move(self.trial, self.trial.build)
                return True
        if np.isfinite(self.least[kernel.PENALTY]):
            self.tabu[self.k] = np.roll(self.tabu[self.k], 1)
            if self.params.tenure:
                self.tabu[self.k, 0] = self.least[kernel.PENALTY]
            self._move(self.kept, self.kept.build)
            return True
        if self.k < min(self.params.most_tuple, self._count() - 1):
            self.k += 1
            return True
        return False

    def diversify(self) -> None:
        """Aim at the next emptiest build; after d_max times give each item of the emptier half its own."""
        self.d += 1
        filling = self._by_filling()
        self.k = 1
        if self.d <= self.params.most_diversify and self.d < len(filling):
            self.target = filling[self.d]
            return
        emptier = np.isin(self.current.build, filling[: max(1, len(filling) // 2)])
        self._separate(np.flatnonzero(emptier))
        self.tabu[:], self.d, self.idle = -1.0, 0, self.idle + 1
        self.target = self._by_filling()[0]

    def _explore(self, item: int, others: Int64s) -> int:
        code = kernel.explore(
            item, self.target, others, self.k, self.items, self.share, self.current.build, self.shapes,
            self.room, self.zones, PAUSE, self.tabu[self.k], self.chosen, self.wanted, self.order, self.trial,
            self.merged, self.kept, self.bins, self.place, self.least, self.cursor,
        )  # fmt: skip
        self.work += int(self.cursor[kernel.WORK])
        return int(code)

    def _move(self, trial: kernel.Trial, build: Int64s) -> None:
        """Take the trial's builds over in place of those of its items."""
        moved = np.flatnonzero(build >= 0)
        self.current.build[moved] = self._count() + build[moved]
        self.current.variant[moved], self.current.place[moved] = trial.variant[moved], trial.place[moved]
        self._renumber()
        if self._count() < self.best_count:
            self._best, self.idle = self.current.copy(), 0
        self.target = self._by_filling()[0]

    def _separate(self, items: Int64s) -> None:
        """Give each of the items a build of its own."""
        self.current.build[items] = self._count() + np.arange(len(items))
        for item in items.tolist():
            variants = self.scene.kinds[self.scene.kind[item]]
            v = next(i for i, variant in enumerate(variants) if np.isfinite(variant.home[0]))
            self.current.variant[item], self.current.place[item] = v, variants[v].home
        first = self.shapes.first_variant[self.scene.kind[items]]
        self.current.variant[items] += first
        self._renumber()

    def _start(self) -> State:
        n = len(self.scene.kind)
        self.current = State(np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros((n, 3)))
        packed = self._heuristic() if self.params.start == "heuristic" and len(self.items) else None
        if packed is None:
            self._separate(self.items)
        return packed or self.current

    def _heuristic(self) -> State | None:
        """Return the sub-heuristic's packing of everything, None where that takes too long."""
        n, boxes = len(self.items), self.bins.placed.shape[1]
        if n * boxes > MOST_BINS:
            return None
        bins = kernel.Bins(np.zeros((n, boxes, 6)), np.zeros(n, np.int64))
        self.trial.build[:] = -1
        used = kernel.sub_heuristic(
            self.items, self.shapes, self.room, self.zones, n, self.trial, bins, self.place, self.cursor
        )
        if used > n:
            return None
        return State(self.trial.build.copy(), self.trial.variant.copy(), self.trial.place.copy())

    def _rows(self) -> State:
        """Return rows of everything; with zones, where they cannot be, what the search starts from."""
        if len(self.zones):
            return self.current.copy()
        rows = best_rows(self.scene, self.items)
        first = self.shapes.first_variant[self.scene.kind]
        return State(rows.build, np.where(rows.build >= 0, rows.variant + first, 0), rows.place)

    def _renumber(self) -> None:
        """Give the builds the numbers from 0 on, without gaps."""
        placed = self.current.build >= 0
        self.current.build[placed] = np.unique(self.current.build[placed], return_inverse=True)[1]

    def _count(self) -> int:
        return int(self.current.build.max(initial=-1)) + 1

    def _by_filling(self) -> list[int]:
        """Return the builds by filling function, the least first; ties by the number of items."""
        build = self.current.build[self.items]
        count = np.bincount(build)
        volume = np.bincount(build, weights=self.share[self.items])
        filling = volume - self.params.count_weight * count / len(self.items)
        order: list[int] = np.lexsort((np.arange(len(count)), count, np.round(filling, 12))).tolist()
        return order

    def _allocate(self) -> None:
        """Make the kernel's work arrays."""
        n, most = len(self.scene.kind), self.params.most_tuple
        boxes = len(self.zones) + sum(
            max(len(variant.lo) for variant in self.scene.kinds[kind]) for kind in self.scene.kind[self.items]
        )
        self.trial, self.merged, self.kept = (
            kernel.Trial(np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros((n, 3))) for _ in range(3)
        )
        self.bins = kernel.Bins(np.zeros((most + 1, boxes, 6)), np.zeros(most + 1, np.int64))
        self.chosen, self.order = np.zeros(most, np.int64), np.zeros(2 * n, np.int64)
        self.wanted, self.place = np.zeros(2 * n + most + 2, np.bool_), np.zeros(6)
        self.least, self.cursor = np.full(1, np.inf), np.zeros(3, np.int64)


def _volumes(scene: Scene) -> Floats:
    """Return the volume of every item's boxes, ``(n,)`` mm3."""
    kinds = np.array([union_volume(kind[0].lo, kind[0].hi) for kind in scene.kinds])
    return np.asarray(kinds[scene.kind] if len(kinds) else np.zeros(0))
