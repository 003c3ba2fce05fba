"""The moving state of the separation search: layouts, work arrays, and the budget of work."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.kernels.no_fit.records import READ, MoveRules, PositionRange, SeparationState, ShapeLayout
from amprep.kernels.no_fit.separate import separate
from amprep.model.control import Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.shapes import NoFit, ShapeInstance

CANDIDATES = 4
"""Number of cells of a scan from which a descent starts."""

FINEST = 0.02
"""Step at which a descent ends, in steps of the fields."""

ROUNDS = 10
"""Rounds between two calls of `WorkBudget.over`."""


class Placed(NamedTuple):
    """Shape, build and least corner of some items.

    Attributes
    ----------
    items
        ``(n,)`` items of the problem.
    shape, build
        ``(n,)``.
    position
        ``(n, 3)`` mm.
    """

    items: Int64s
    shape: Int64s
    build: Int64s
    position: Floats

    def copy(self) -> "Placed":
        """Return a copy that may be changed."""
        return Placed(self.items, self.shape.copy(), self.build.copy(), self.position.copy())

    @property
    def builds(self) -> int:
        """Number of builds."""
        return int(self.build.max(initial=-1)) + 1


@dataclass
class WorkBudget:
    """Work that may still be done, in field values read."""

    stop: Stop
    left: float

    def over(self) -> bool:
        """Tell whether the search has to end."""
        return self.left <= 0.0 or self.stop()


@dataclass(frozen=True, eq=False)
class Scene:
    """All that a search for layouts needs to know: the instance, its no-fit solids, parameters, generator, budget."""

    instance: ShapeInstance
    no_fit: NoFit
    params: SeparationParams
    rng: np.random.Generator
    budget: WorkBudget

    def layout(self, placed: Placed) -> ShapeLayout:
        """Return items and obstacles as the kernels read them; a copy."""
        obstacles = self.no_fit.obstacles
        m = len(self.instance.shapes)
        builds = np.array([obstacle.build for obstacle in obstacles], np.int64)
        positions = np.array([obstacle.position for obstacle in obstacles]).reshape(-1, 3)
        return ShapeLayout(
            np.concatenate((placed.shape, m + np.arange(len(obstacles)))),
            np.concatenate((placed.build, builds)),
            np.concatenate((placed.position, positions)),
        )

    def rules(self, items: Int64s, builds: int) -> MoveRules:
        """Return the rules of moves of some items among some builds."""
        instance, step = self.instance, self.no_fit.fields.step
        enough = 1e-6 * max(len(items), 1)
        chance = self.params.scan_chance
        return MoveRules(instance.first[items], instance.end[items], builds, chance, FINEST * step, enough)

    def work_arrays(self, items: int, within: PositionRange) -> SeparationState:
        """Return overlaps and weights 1, and the work arrays for scans within a range of positions."""
        n = items + len(self.no_fit.obstacles)
        cells = scan_cells(within, self.no_fit.fields.step)
        seed = self.rng.integers(1, 2**63, 1).astype(np.uint64)
        return SeparationState(
            np.zeros((items, n)),
            np.ones((items, n)),
            np.zeros(items),
            np.ones(items),
            seed,
            np.zeros(4, np.int64),
            np.empty(cells, np.float32),
            np.empty(n, np.int64),
            np.empty(items, np.int64),
            np.empty(CANDIDATES, np.int64),
            np.empty(CANDIDATES),
        )

    def run(
        self,
        layout: ShapeLayout,
        best: ShapeLayout,
        rules: MoveRules,
        within: PositionRange,
        state: SeparationState,
    ) -> float:
        """Run some rounds of the separation and charge their work; return the total overlap of the best layout."""
        before = int(state.spent[READ])
        least = separate(self.no_fit.fields, within, rules, layout, best, state, ROUNDS)
        self.budget.left -= int(state.spent[READ]) - before + 1000
        return float(least)


def scan_cells(within: PositionRange, step: float) -> int:
    """Return the greatest number of cells of a scan, which are two steps apart."""
    counts = np.maximum((within.hi - within.lo) / (2.0 * step), 0.0).astype(np.int64) + 1
    return int(counts.prod(axis=1).max(initial=1))


def placed_from(layout: ShapeLayout, items: Int64s) -> Placed:
    """Return the items of a layout without the obstacles; a copy."""
    n = len(items)
    return Placed(items, layout.shape[:n].copy(), layout.build[:n].copy(), layout.position[:n].copy())


def only(placed: Placed, kept: Int64s) -> Placed:
    """Return some rows."""
    return Placed(placed.items[kept], placed.shape[kept], placed.build[kept], placed.position[kept])


def joined(one: Placed, other: Placed) -> Placed:
    """Return the rows of both."""
    return Placed(*(np.concatenate(pair) for pair in zip(one, other, strict=True)))


def nothing_placed() -> Placed:
    """Return no rows."""
    empty = np.zeros(0, np.int64)
    return Placed(empty, empty, empty, np.zeros((0, 3)))
