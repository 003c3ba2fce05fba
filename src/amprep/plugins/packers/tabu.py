"""The packer `tabu`: the tabu search of Lodi, Martello and Vigo over the heuristic of touching areas."""

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.boxes.build_space import union_volume
from amprep.kernels.boxes import tabu as kernel
from amprep.kernels.boxes.extreme_points import FINISHED, PAUSED
from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.bounds.combinatorial import builds_bound
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.params import TabuParams
from amprep.plugins.packers.sweep import best_rows

MOST_BOXES = 20_000_000
"""Greatest number of boxes in all open builds together when there is a build for each item, 48 bytes each."""

PAUSE = 4_000_000
"""Comparisons between two calls of `stop`, some 20 ms."""


def pack_tabu(
    problem: PackingProblem, *, params: TabuParams, rng: np.random.Generator, stop: Stop, progress: Progress
) -> Packing:
    """Pack into as few builds as possible by tabu search (thesis 2.4).

    After Lodi, Martello, Vigo, EJOR 141 (2002), doi:10.1016/S0377-2217(02)00134-0. The thesis leaves some details
    open. Here a penalty is tabu while it is among the last `tenure` penalties of moves with the same k. After every
    diversification k starts again at 1; after a strong one d does, too. The search ends when the lower bound is met, or
    after `patience` strong diversifications without success. No random numbers are drawn.
    """
    del rng
    instance = prepare(problem)
    bound = builds_bound(instance)
    search = TabuSearch(instance, params)
    reason = "finished" if not len(search.items) else ""
    while not reason:
        if search.best.builds <= bound:
            reason = "bound met"
        elif stop():
            reason = stop.reason
        elif search.work >= params.work * 1e6:
            reason = "work used up"
        elif search.idle > params.patience:
            reason = "no better one found"
        else:
            progress(min(search.work / max(params.work * 1e6, 1.0), 1.0), f"{search.best.builds} builds")
            if not search.search(stop):
                search.diversify()
    return as_packing(instance, PackerResult(search.best, float(bound), reason))


class TabuSearch:
    """The state of the search: the present arrangement and the best one, k, d and the tabu lists.

    Attributes
    ----------
    best
        The best arrangement so far.
    target
        The build that the search tries to empty.
    k, d
        Number of other builds that a move packs again; number of diversifications since the last strong one.
    work, idle
        Comparisons made; strong diversifications since the last better arrangement.
    """

    def __init__(self, instance: PreparedInstance, params: TabuParams) -> None:
        self.params, self.instance = params, instance
        volume = _volumes(instance)
        free = np.flatnonzero(instance.free)
        self.items = free[np.lexsort((free, instance.type_of[free], -volume[free]))]
        self.fraction = volume / instance.problem.space.volume_mm3
        self.work, self.k, self.d, self.idle = 0, 1, 0, 0
        self.tabu = np.full((params.max_tuple_size + 1, max(params.tenure, 1)), -1.0)
        self.state = self._new_state()
        self.current = self._start()
        self.best = self.current.copy()
        if len(self.items):
            # a result to fall back on when time is short; the search itself starts as in the thesis
            packed = (self._heuristic() if params.start == "separate" else None) or self._rows()
            self.best = packed if packed.builds < self.best.builds else self.best
        self.target = self._by_filling()[0] if len(self.items) else 0

    def search(self, stop: Stop) -> bool:
        """Try to move an item out of the target build (thesis 2.4, Search); return False to diversify."""
        others = np.array([b for b in range(self.current.builds) if b != self.target], np.int64)
        self.state.least[0] = np.inf
        for item in self.items[self.current.build[self.items] == self.target].tolist():
            self.state.cursor[kernel.STARTED] = 0
            code = PAUSED
            while code == PAUSED:
                code = self._explore(item, others)
                if code == PAUSED and (stop() or self.work > self.params.work * 1e6):
                    return True
            if code != FINISHED:
                if code == kernel.FEWER:
                    self.k = max(1, self.k - 1)
                self._move(self.state.trial)
                return True
        if np.isfinite(self.state.least[0]):
            self.tabu[self.k] = np.roll(self.tabu[self.k], 1)
            if self.params.tenure:
                self.tabu[self.k, 0] = self.state.least[0]
            self._move(self.state.kept)
            return True
        if self.k < min(self.params.max_tuple_size, self.current.builds - 1):
            self.k += 1
            return True
        return False

    def diversify(self) -> None:
        """Choose the next emptiest build as target; after d_max times separate the items of the emptier half."""
        self.d += 1
        filling = self._by_filling()
        self.k = 1
        if self.d <= self.params.max_diversifications and self.d < len(filling):
            self.target = filling[self.d]
            return
        emptier = np.isin(self.current.build, filling[: max(1, len(filling) // 2)])
        self._separate(np.flatnonzero(emptier))
        self.tabu[:], self.d, self.idle = -1.0, 0, self.idle + 1
        self.target = self._by_filling()[0]

    def _explore(self, item: int, others: Int64s) -> int:
        move = kernel.Move(item, self.target, self.k, others)
        code = kernel.explore(
            move, self.current.build, self.tabu[self.k], PAUSE, self.instance.boxes, self.state
        )
        self.work += int(self.state.cursor[kernel.WORK])
        return int(code)

    def _move(self, trial: Arrangement) -> None:
        """Move the items of a trial to its builds."""
        moved = np.flatnonzero(trial.build >= 0)
        self.current.build[moved] = self.current.builds + trial.build[moved]
        self.current.orientation[moved] = trial.orientation[moved]
        self.current.position[moved] = trial.position[moved]
        self._renumber()
        if self.current.builds < self.best.builds:
            self.best, self.idle = self.current.copy(), 0
        self.target = self._by_filling()[0]

    def _separate(self, items: Int64s) -> None:
        """Give each of the items a build of its own."""
        self.current.build[items] = self.current.builds + np.arange(len(items))
        first, orientations = self.instance.first_orientation, self.instance.orientations
        for item in items.tolist():
            item_type = self.instance.type_of[item]
            fitting = (o for o in range(first[item_type], first[item_type + 1]) if orientations[o].fits)
            chosen = next(fitting)
            self.current.orientation[item] = chosen
            self.current.position[item] = orientations[chosen].feasible_position
        self._renumber()

    def _start(self) -> Arrangement:
        """Return the first arrangement: of the heuristic, or with every item in its own build."""
        self.current = Arrangement.unassigned(len(self.instance.type_of))
        packed = self._heuristic() if self.params.start == "heuristic" and len(self.items) else None
        if packed is None:
            self._separate(self.items)
        return packed or self.current

    def _heuristic(self) -> Arrangement | None:
        """Return the sub-heuristic's packing of all items; None where that takes too long."""
        n, boxes = len(self.items), self.state.open_builds.placed.shape[1]
        if n * boxes > MOST_BOXES:
            return None
        packed = Arrangement.unassigned(len(self.instance.type_of))
        used = kernel.sub_heuristic(
            self.items, self.instance.boxes, n, packed, _open_builds(n, boxes), self.state.cursor
        )
        return None if used > n else packed

    def _rows(self) -> Arrangement:
        """Return rows of all items; with zones, where rows are not packed, the arrangement of the start."""
        if self.instance.boxes.zones:
            return self.current.copy()
        return best_rows(self.instance, self.items)

    def _renumber(self) -> None:
        """Number the builds from 0 on, without gaps."""
        placed = self.current.build >= 0
        self.current.build[placed] = np.unique(self.current.build[placed], return_inverse=True)[1]

    def _by_filling(self) -> list[int]:
        """Return the builds by filling function, then by number of items, the least first."""
        build = self.current.build[self.items]
        count = np.bincount(build)
        volume = np.bincount(build, weights=self.fraction[self.items])
        filling = volume - self.params.count_weight * count / len(self.items)
        order: list[int] = np.lexsort((np.arange(len(count)), count, np.round(filling, 12))).tolist()
        return order

    def _new_state(self) -> kernel.MoveSearch:
        """Return work arrays of the kernel."""
        instance, n, most = self.instance, len(self.instance.type_of), self.params.max_tuple_size
        most_boxes = [max(len(orientation.lo) for orientation in item_type) for item_type in instance.types]
        boxes = instance.boxes.zones + sum(
            most_boxes[item_type] for item_type in instance.type_of[self.items]
        )
        return kernel.MoveSearch(
            by_volume=self.items,
            fraction=self.fraction,
            chosen=np.zeros(most, np.int64),
            wanted=np.zeros(2 * n + most + 2, np.bool_),
            order=np.zeros(2 * n, np.int64),
            trial=Arrangement.unassigned(n),
            merged=Arrangement.unassigned(n),
            kept=Arrangement.unassigned(n),
            open_builds=_open_builds(most + 1, boxes),
            least=np.full(1, np.inf),
            cursor=np.zeros(3, np.int64),
        )


def _open_builds(builds: int, boxes: int) -> kernel.OpenBuilds:
    """Return work arrays for open builds with up to `boxes` boxes each."""
    return kernel.OpenBuilds(np.zeros((builds, boxes, 6)), np.zeros(builds, np.int64), np.zeros(6))


def _volumes(instance: PreparedInstance) -> Floats:
    """Return the volume of every item's boxes, ``(n,)`` mm3."""
    volumes = np.array([union_volume(item_type[0].lo, item_type[0].hi) for item_type in instance.types])
    return np.asarray(volumes[instance.type_of] if len(volumes) else np.zeros(0))
