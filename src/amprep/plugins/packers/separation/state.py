"""The moving state of the separation search: layouts, work arrays, and the budget of work."""

import time
from dataclasses import dataclass, field, replace
from functools import cached_property
from threading import Event
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats, Int64s
from amprep.kernels.guided_search import READ, MoveRules
from amprep.kernels.no_fit.records import PositionRange, SeparationState, ShapeLayout
from amprep.kernels.no_fit.separate import separate
from amprep.model.control import Progress, Stop, silent
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.no_fit import NoFit
from amprep.plugins.packers.separation.shapes import ShapeInstance

CANDIDATES = 1
"""Number of cells of a scan from which a descent starts."""

FINEST = 0.02
"""Step at which a descent ends, in steps of the fields."""

ROUNDS = 10
"""Rounds of a span, after which progress is judged."""

DEFAULT_FAILURES = 20
"""Number of failures at which a search ends if neither time nor work nor failures are limited."""

CALL_WORK = 50_000_000
"""Field values read between two calls of `WorkBudget.over`: a tenth of a second or less."""


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


UNLIMITED = 1e14
"""Work that no search does, in days."""


@dataclass
class WorkBudget:
    """Work that may still be done, in field values read.

    Attributes
    ----------
    stop
        Time limit and cancellation.
    limit, left
        Work at the start, and what is left of it.
    ended
        Event that is set when the search ends for another reason.
    begun
        ``time.monotonic()`` at the start.
    """

    stop: Stop
    limit: float
    left: float = field(init=False)
    ended: Event = field(default_factory=Event)
    begun: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        self.left = self.limit

    @property
    def spent(self) -> float:
        """Work that is done."""
        return self.limit - self.left

    @property
    def timed(self) -> bool:
        """Whether only the time is limited."""
        return self.limit >= UNLIMITED and self.stop.deadline is not None

    @property
    def used(self) -> float:
        """Fraction of the work that is done; where work is not limited, of the time."""
        if not self.timed:
            return float(min(self.spent / max(self.limit, 1.0), 1.0))
        passed = time.monotonic() - self.begun
        return float(min(passed / max(passed + self.stop.remaining(), 1e-9), 1.0))

    def stopped(self) -> bool:
        """Tell whether the search has to end for another reason than its work."""
        return self.ended.is_set() or self.stop()

    def over(self) -> bool:
        """Tell whether the search has to end."""
        return self.left <= 0.0 or self.stopped()


@dataclass(frozen=True, eq=False)
class Scene:
    """All that a search for layouts needs to know: the instance, its no-fit solids, parameters, generator, budget."""

    instance: ShapeInstance
    no_fit: NoFit
    params: SeparationParams
    rng: np.random.Generator
    budget: WorkBudget
    progress: Progress = silent

    @cached_property
    def full_height(self) -> PositionRange:
        """Positions in a build as high as the build volume."""
        problem = self.instance.problem
        return self.instance.positions(float(problem.space.size[2]) - problem.clearance)

    @cached_property
    def item_values(self) -> Floats:
        """Value of each item of the problem."""
        return np.array([item.value for item in self.instance.problem.items])

    def free_volume(self, placed: Placed) -> float:
        """Return the volume (mm3) of one build, with the tolerance, that the items of a layout leave free."""
        space = self.instance.problem.space
        room = replace(space, size=space.size + 2.0 * CONTACT_TOLERANCE).volume_mm3
        return room - float(self.instance.volumes[placed.items].sum())

    def gives_up(self, failures: int) -> bool:
        """Tell whether the search ends after some failures."""
        most = self.params.failures
        if most is None and self.params.work is None and not self.budget.timed:
            most = DEFAULT_FAILURES
        return most is not None and failures >= most

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
            overlap=np.zeros((items, n)),
            weight=np.ones((items, n)),
            outside=np.zeros(items),
            outside_weight=np.ones(items),
            touching=np.zeros(items, np.int64),
            pairs=np.empty((items * n, 2), np.int32),
            listed=np.zeros((items, n), bool),
            progress=np.array([0, -1]),
            least=np.full(1, np.inf),
            random=seed,
            spent=np.zeros(4, np.int64),
            sums=np.empty(cells, np.float32),
            near=np.empty((n, 5), np.int64),
            frame=np.empty((n, 4)),
            order=np.empty(items, np.int64),
            cell=np.empty(CANDIDATES, np.int64),
            value=np.empty(CANDIDATES),
        )

    def run(
        self,
        layout: ShapeLayout,
        best: ShapeLayout,
        rules: MoveRules,
        within: PositionRange,
        state: SeparationState,
    ) -> float:
        """Run a span of the separation and charge its work; return the total overlap of its best layout."""
        state.least[0], rounds = np.inf, ROUNDS
        while rounds > 0 and not self.budget.over():
            before = int(state.spent[READ])
            done = separate(self.no_fit.fields, within, rules, layout, best, state, rounds, CALL_WORK)
            self.budget.left -= int(state.spent[READ]) - before + 1000
            rounds = 0 if state.least[0] <= rules.enough else rounds - int(done)
        return float(state.least[0])


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
