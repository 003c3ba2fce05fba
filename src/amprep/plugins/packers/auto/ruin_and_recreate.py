"""The search of `auto`: with one build less, a few builds are packed again until every item is placed."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.boxes import ruin_and_recreate as kernel
from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Stop
from amprep.plugins.packers.auto.set_covering import Pool, choose_builds
from amprep.plugins.packers.bounds.fractional_cover import MOST_TYPES
from amprep.plugins.packers.extreme_points import PassRunner, constructive_passes
from amprep.plugins.packers.instance.prepare import PreparedInstance
from amprep.plugins.packers.params import AutoParams

PAUSE = 1_000_000
"""Comparisons between two calls of `stop`, some 25 ms."""

FIRST_CHOICE, GROWTH = 20_000_000, 2
"""Comparisons before the first choice among all met builds, and the factor from each choice to the next."""

MOST_MET, MOST_HELD = 1 << 15, 8_000_000
"""Greatest number of remembered builds, and of items in all of them together, 40 bytes each."""


class RuinAndRecreate:
    """Searches for an arrangement with one build less than the best one; some items are unassigned meanwhile.

    The emptiest build is dissolved. Then a few builds and the unassigned items are packed again in a disturbed order,
    until no item is unassigned (see `amprep.kernels.boxes.ruin_and_recreate`). From time to time the fewest builds
    that hold everything are chosen among all builds met (see `choose_builds`).

    Attributes
    ----------
    best
        The best arrangement; every item is in a build.
    spent
        ``(2,)`` comparisons and steps made.
    """

    def __init__(
        self, runner: PassRunner, start: Arrangement, params: AutoParams, rng: np.random.Generator
    ) -> None:
        self.instance, self.params, self.best = runner.instance, params, start
        n = len(self.instance.type_of)
        self.items = np.flatnonzero(self.instance.free)
        keys = _keys(self.instance)
        self.orders = kernel.SearchOrders(
            self.items,
            keys,
            keys[0] / max(float(keys[0][self.items].mean()), 1e-300),
            np.unique([each.rule for each in constructive_passes(self.instance)], axis=0),
        )
        self.spent = np.zeros(2, np.int64)
        self.state = kernel.SearchState(
            arrangement=start.copy(),
            met=no_builds(n, int(np.ceil(len(self.items) / max(self.builds, 1)))),
            random=rng.integers(1, 2**63, 1, dtype=np.uint64),
            spent=self.spent,
            repacked=Arrangement.unassigned(n),
            pass_state=runner.state,
            chosen=np.zeros(params.ruin_size, np.int64),
            order=np.zeros(n, np.int64),
        )
        self.next_choice = FIRST_CHOICE

    @property
    def builds(self) -> int:
        """Builds of the best arrangement."""
        return self.best.builds

    def save_a_build(self, proved: Callable[[], int], stop: Stop) -> str:
        """Search for an arrangement with one build less; return "" on success, else the reason for the end."""
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
                self.best = self.state.arrangement.copy()
                return ""
            chosen = self._choose_in_time(stop)
            if chosen is not None:
                self.best = chosen
                self.state = self.state._replace(arrangement=chosen.copy())
                return ""

    def _dissolve(self) -> None:
        """Make the items of the emptiest build unassigned; a build with fixed items is never dissolved."""
        build, weight = self.state.arrangement.build, self.orders.weight
        full = np.bincount(build[self.items], weights=weight[self.items], minlength=self.builds)
        if self.instance.problem.fixed:
            full[0] = np.inf
        emptiest = int(full.argmin())
        build[build == emptiest] = -1
        build[build > emptiest] -= 1

    def _run(self) -> int:
        params = self.params
        code = kernel.search(
            self.builds - 1,
            params.ruin_size,
            params.temperature,
            PAUSE,
            self.instance.boxes,
            self.orders,
            self.state,
        )
        return int(code)

    def _choose_in_time(self, stop: Stop) -> Arrangement | None:
        """Choose the fewest builds among all met, if it is time to do so; return them if this saves a build."""
        if self.instance.problem.fixed or self.spent[kernel.SPENT] < self.next_choice:
            return None
        self.next_choice *= GROWTH
        types, type_of_own = np.unique(self.instance.type_of[self.items], return_inverse=True)
        if len(types) > MOST_TYPES:
            return None
        type_of = np.zeros(len(self.instance.type_of), np.int64)
        type_of[self.items] = type_of_own
        start, held, met = self._builds_met()
        pool = Pool(start, type_of[held])
        demand = np.bincount(type_of_own, minlength=len(types))
        chosen = choose_builds(pool, demand, np.arange(self.builds), self.builds - 1, stop)
        if chosen is None:
            return None
        found = Arrangement.unassigned(len(type_of))
        waiting = [self.items[type_of_own == k].tolist() for k in range(len(types))]
        for number, row in enumerate(chosen.tolist()):
            for at in range(start[row], start[row + 1]):
                if waiting[pool.type_of[at]]:
                    item = waiting[pool.type_of[at]].pop()
                    found.build[item] = number
                    found.orientation[item], found.position[item] = met.orientation[at], met.position[at]
        return found

    def _builds_met(self) -> tuple[Int64s, Int64s, Arrangement]:
        """Return where builds begin, the items that they hold, and their arrangement; the best builds come first."""
        best, met = self.best, self.state.met
        own = np.concatenate([np.flatnonzero(best.build == number) for number in range(self.builds)])
        sizes = np.bincount(best.build[own], minlength=self.builds)
        last = int(met.number[0])
        kept = slice(int(met.start[last]))
        start = np.concatenate(([0], np.cumsum(sizes), sizes.sum() + met.start[1 : last + 1])).astype(
            np.int64
        )
        return (
            start,
            np.concatenate((own, met.item[kept])),
            Arrangement(
                np.repeat(np.arange(len(start) - 1), np.diff(start)),
                np.concatenate((best.orientation[own], met.orientation[kept])),
                np.concatenate((best.position[own], met.position[kept])),
            ),
        )


def no_builds(items: int, in_a_build: int) -> kernel.MetBuilds:
    """Return an empty memory of builds, for `items` items of which `in_a_build` are in one build on average."""
    held = max(min(MOST_MET * in_a_build, MOST_HELD), 4 * items)
    return kernel.MetBuilds(
        code=np.random.default_rng(0).integers(1, 2**63, items, dtype=np.uint64),
        key=np.zeros(2 * MOST_MET, np.uint64),
        row=np.full(2 * MOST_MET, -1, np.int64),
        start=np.zeros(MOST_MET, np.int64),
        item=np.zeros(held, np.int64),
        orientation=np.zeros(held, np.int64),
        position=np.zeros((held, 3)),
        number=np.zeros(1, np.int64),
    )


def _keys(instance: PreparedInstance) -> Floats:
    """Return sort keys ``(8, n)`` above 0: volume, longest side, areas of faces, sides."""
    size = np.array([item_type[0].size for item_type in instance.types]).reshape(-1, 3)[instance.type_of]
    x, y, z = size.T
    keys = np.array([x * y * z, size.max(axis=1, initial=0.0), x * y, y * z, x * z, x, y, z])
    return np.asarray(np.maximum(keys, 1e-12))
