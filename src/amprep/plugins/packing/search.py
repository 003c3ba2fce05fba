"""The search of `auto`: one build less, and a few builds packed anew until nothing is loose."""

import numpy as np

from amprep.kernels import box_places as records
from amprep.kernels import packing_search as kernel
from amprep.model.arrays import Floats
from amprep.model.control import Stop
from amprep.plugins.packing.extreme_points import Runner, Solution
from amprep.plugins.packing.params import AutoParams
from amprep.plugins.packing.scene import Scene
from amprep.plugins.packing.sortings import Pass, passes

PAUSE = 1_000_000
"""Comparisons between two looks at `stop`, some 25 ms."""


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

    @property
    def builds(self) -> int:
        """Builds of the best solution."""
        return int(self.best.build.max(initial=-1)) + 1

    def save_a_build(self, stop: Stop) -> str:
        """Search for a solution with one build less; return why it ended in vain, empty when it did not."""
        self._dissolve()
        steps, limit = int(self.spent[kernel.STEPS]), self.params.patience * len(self.items)
        code = kernel.PAUSED
        while code == kernel.PAUSED:
            if stop():
                return stop.reason
            if self.spent[kernel.SPENT] > self.params.work * 1e6:
                return "work used up"
            if self.spent[kernel.STEPS] - steps > limit:
                return "no better one found"
            code = self._run()
        variant = self.bins.variant - self.first_variant
        build = self.bins.build.copy()
        plan = Pass(self.items, self.styles[0])
        rank = (0.0, float(build.max() + 1))
        self.best = Solution(plan, rank, True, build, variant, self.bins.place.copy())
        return ""

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
            self.bins, self.answer, runner.scratch, self.chosen, self.order, self.spent,
        )  # fmt: skip
        return int(code)


def _keys(scene: Scene) -> Floats:
    """Return sort keys ``(8, n)`` above 0: volume, longest side, areas of faces, sides."""
    size = np.array([kind[0].size for kind in scene.kinds]).reshape(-1, 3)[scene.kind]
    x, y, z = size.T
    keys = np.array([x * y * z, size.max(axis=1, initial=0.0), x * y, y * z, x * z, x, y, z])
    return np.asarray(np.maximum(keys, 1e-12))


def _styles(scene: Scene) -> Floats:
    """Return the ways to choose places that suit the room, ``(s, 6)``."""
    return np.unique([plan.style for plan in passes(scene)], axis=0)
