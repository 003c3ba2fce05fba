"""The search of `auto`: one build less, and a few builds packed anew until nothing is loose."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes import places as records
from amprep.kernels.boxes import ruin_and_recreate as kernel
from amprep.model.control import Stop
from amprep.plugins.packers.auto.set_covering import MOST_KINDS, Pool, choose_builds
from amprep.plugins.packers.extreme_points import Runner
from amprep.plugins.packers.instance.orders import Pass, passes
from amprep.plugins.packers.instance.prepare import Scene
from amprep.plugins.packers.instance.solution import Solution
from amprep.plugins.packers.params import AutoParams

PAUSE = 1_000_000
"""Comparisons between two looks at `stop`, some 25 ms."""

FIRST_CHOICE, GROWTH = 20_000_000, 2
"""Comparisons before builds are first chosen among all that were met, and how much later each next time."""

MOST_SEEN, MOST_HELD = 1 << 15, 8_000_000
"""Builds remembered, and items in them all together, 40 bytes each."""


class Search:
    """The moving state: items in one build less than the best solution has, some of them loose."""

    def __init__(self, runner: Runner, start: Solution, params: AutoParams, rng: np.random.Generator) -> None:
        self.runner, self.scene, self.params, self.best = runner, runner.scene, params, start
        n = len(self.scene.kind)
        self.items = np.flatnonzero(self.scene.free)
        self.first_variant = runner.shapes.first_variant[self.scene.kind]
        self.bins = kernel.Bins(
            start.build.copy(), start.variant + self.first_variant, np.array(start.place, np.float64)
        )
        self.keys = _keys(self.scene)
        volume = self.keys[0]
        self.weight = volume / max(float(volume[self.items].mean()), 1e-300)
        self.styles = _styles(runner.scene)
        self.random = rng.integers(1, 2**63, 1, dtype=np.uint64)
        self.answer = records.Answer(
            np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros((n, 3)), np.zeros((n + 1, 2))
        )
        self.chosen, self.order = np.zeros(params.most_ruined, np.int64), np.zeros(n, np.int64)
        self.spent = np.zeros(2, np.int64)
        self.seen = _nothing_seen(n, int(np.ceil(len(self.items) / max(self.builds, 1))))
        self.next_choice = FIRST_CHOICE

    @property
    def builds(self) -> int:
        """Builds of the best solution."""
        return int(self.best.build.max(initial=-1)) + 1

    def save_a_build(self, proved: Callable[[], int], stop: Stop) -> str:
        """Search for a solution with one build less; return why it ended in vain, empty when it did not."""
        self._dissolve()
        steps, limit = int(self.spent[kernel.STEPS]), self.params.patience * len(self.items)
        while True:
            if self.builds <= proved():
                return "bound met"
            if stop():
                return stop.reason
            if self.spent[kernel.SPENT] > self.params.work * 1e6:
                return "work used up"
            if self.spent[kernel.STEPS] - steps > limit:
                return "no better one found"
            if self._run() == kernel.SOLVED:
                self._keep(
                    self.bins.build.copy(), self.bins.variant - self.first_variant, self.bins.place.copy()
                )
                return ""
            if self._choose_in_time(stop):
                return ""

    def _keep(self, build: Int64s, variant: Int64s, place: Floats) -> None:
        """Make this the best solution and go on from it."""
        plan, rank = Pass(self.items, self.styles[0]), (0.0, float(build.max() + 1))
        self.best = Solution(plan, rank, True, build, variant, place)
        self.bins = kernel.Bins(build.copy(), variant + self.first_variant, place.copy())

    def _choose_in_time(self, stop: Stop) -> bool:
        """From time to time try to save a build by choosing among all builds met; say whether it did."""
        if self.scene.problem.fixed or self.spent[kernel.SPENT] < self.next_choice:
            return False
        self.next_choice *= GROWTH
        kinds, kind = np.unique(self.scene.kind[self.items], return_inverse=True)
        if len(kinds) > MOST_KINDS:
            return False
        of_item = np.zeros(len(self.scene.kind), np.int64)
        of_item[self.items] = kind
        start, item, variant, place = self._met()
        pool = Pool(start, of_item[item])
        demand = np.bincount(kind, minlength=len(kinds))
        chosen = choose_builds(pool, demand, np.arange(self.builds), self.builds - 1, stop)
        if chosen is None:
            return False
        build = np.full(len(self.scene.kind), -1, np.int64)
        new_variant, new_place = np.zeros_like(build), np.zeros((len(build), 3))
        waiting = [self.items[kind == k].tolist() for k in range(len(kinds))]
        for number, row in enumerate(chosen.tolist()):
            for at in range(start[row], start[row + 1]):
                if waiting[pool.kind[at]]:
                    own = waiting[pool.kind[at]].pop()
                    build[own], new_variant[own], new_place[own] = number, variant[at], place[at]
        self._keep(build, new_variant - self.first_variant, new_place)
        return True

    def _met(self) -> tuple[Int64s, Int64s, Int64s, Floats]:
        """Return where builds begin, and item, variant and place of what they hold: the best ones first."""
        own = np.concatenate([np.flatnonzero(self.best.build == number) for number in range(self.builds)])
        sizes = np.bincount(self.best.build[own], minlength=self.builds)
        last = int(self.seen.noted[0])
        kept = slice(int(self.seen.start[last]))
        start = np.concatenate(([0], np.cumsum(sizes), sizes.sum() + self.seen.start[1 : last + 1]))
        variant = (self.best.variant + self.first_variant)[own]
        return (
            start.astype(np.int64),
            np.concatenate((own, self.seen.item[kept])),
            np.concatenate((variant, self.seen.variant[kept])),
            np.concatenate((self.best.place[own], self.seen.place[kept])),
        )

    def _dissolve(self) -> None:
        """Make the items of the emptiest build loose, never those of one in which something is fixed."""
        build = self.bins.build
        full = np.bincount(build[self.items], weights=self.weight[self.items], minlength=self.builds)
        if self.scene.problem.fixed:
            full[0] = np.inf
        emptiest = int(full.argmin())
        build[build == emptiest] = -1
        build[build > emptiest] -= 1

    def _run(self) -> int:
        runner = self.runner
        code = kernel.search(
            self.items, self.builds - 1, self.params.most_ruined, self.params.heat, self.keys, self.weight,
            self.styles, runner.shapes, runner.room, runner.obstacles, runner.zones, PAUSE, self.random,
            self.bins, self.answer, runner.scratch, self.chosen, self.order, self.spent, self.seen,
        )  # fmt: skip
        return int(code)


def _nothing_seen(items: int, in_a_build: int) -> kernel.Seen:
    """Return an empty memory of builds."""
    held = max(min(MOST_SEEN * in_a_build, MOST_HELD), 4 * items)
    return kernel.Seen(
        np.random.default_rng(0).integers(1, 2**63, items, dtype=np.uint64),
        np.zeros(2 * MOST_SEEN, np.uint64), np.full(2 * MOST_SEEN, -1, np.int64), np.zeros(MOST_SEEN, np.int64),
        np.zeros(held, np.int64), np.zeros(held, np.int64), np.zeros((held, 3)), np.zeros(1, np.int64),
    )  # fmt: skip


def _keys(scene: Scene) -> Floats:
    """Return sort keys ``(8, n)`` above 0: volume, longest side, areas of faces, sides."""
    size = np.array([kind[0].size for kind in scene.kinds]).reshape(-1, 3)[scene.kind]
    x, y, z = size.T
    keys = np.array([x * y * z, size.max(axis=1, initial=0.0), x * y, y * z, x * z, x, y, z])
    return np.asarray(np.maximum(keys, 1e-12))


def _styles(scene: Scene) -> Floats:
    """Return the ways to choose places that suit the room, ``(s, 6)``."""
    return np.unique([plan.style for plan in passes(scene)], axis=0)
