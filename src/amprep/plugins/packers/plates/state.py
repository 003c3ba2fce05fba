"""The moving state of the search for plates: layouts, work arrays, and the fields of depth."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, starts_of
from amprep.geometry.plates.sampling import sample_outlines
from amprep.kernels.guided_search import READ, MoveRules
from amprep.kernels.plates.contacts import PlatePieces
from amprep.kernels.plates.records import (
    NONE,
    UNKNOWN,
    FieldCache,
    PlateLayout,
    PlateState,
    SampledOutlines,
)
from amprep.kernels.plates.separate import separate_plates
from amprep.plugins.packers.params import PlatesParams
from amprep.plugins.packers.plates.shapes import PlateInstance
from amprep.plugins.packers.separation.state import WorkBudget

CANDIDATES = 4
"""Number of cells of a scan from which a descent starts."""

FINEST = 0.01
"""Step at which a descent ends, in steps of the fields."""

ROUNDS = 4
"""Rounds between two calls of `WorkBudget.over`."""

SMALLEST_FIELDS = 1_000_000
"""Least number of values of the cache of fields."""


class OnPlates(NamedTuple):
    """Shape, plate and centre of some items.

    Attributes
    ----------
    items
        ``(n,)`` items of the problem.
    shape, plate
        ``(n,)``.
    position
        ``(n, 2)`` mm.
    """

    items: Int64s
    shape: Int64s
    plate: Int64s
    position: Floats

    def copy(self) -> "OnPlates":
        """Return a copy that may be changed."""
        return OnPlates(self.items, self.shape.copy(), self.plate.copy(), self.position.copy())

    @property
    def plates(self) -> int:
        """Number of plates."""
        return int(self.plate.max(initial=-1)) + 1

    def rows(self, kept: Int64s) -> "OnPlates":
        """Return some rows."""
        return OnPlates(self.items[kept], self.shape[kept], self.plate[kept], self.position[kept])

    def with_rows(self, other: "OnPlates") -> "OnPlates":
        """Return the rows of both."""
        return OnPlates(*(np.concatenate(pair) for pair in zip(self, other, strict=True)))


def none_on_plates() -> OnPlates:
    """Return no rows."""
    empty = np.zeros(0, np.int64)
    return OnPlates(empty, empty, empty, np.zeros((0, 2)))


@dataclass(frozen=True, eq=False)
class PlateScene:
    """All that a search needs to know: the instance, its fields and pieces, parameters, generator and budget."""

    instance: PlateInstance
    outlines: SampledOutlines
    pieces: PlatePieces
    cache: FieldCache
    params: PlatesParams
    rng: np.random.Generator
    budget: WorkBudget

    def layout(self, placed: OnPlates) -> PlateLayout:
        """Return items and obstacles as the kernels read them; a copy."""
        obstacles, s = self.instance.obstacles, len(self.instance.shapes)
        positions = np.array([obstacle.position for obstacle in obstacles]).reshape(-1, 2)
        return PlateLayout(
            np.concatenate((placed.shape, s + np.arange(len(obstacles)))),
            np.concatenate((placed.plate, np.array([o.plate for o in obstacles], np.int64))),
            np.concatenate((placed.position, positions)),
        )

    def rules(self, items: Int64s, plates: int) -> MoveRules:
        """Return the rules of moves of some items among some plates."""
        instance, finest = self.instance, FINEST * self.outlines.step
        enough = 1e-6 * max(len(items), 1)
        chance = self.params.scan_chance
        return MoveRules(instance.first[items], instance.end[items], plates, chance, finest, enough)

    def state(self, items: int) -> PlateState:
        """Return overlaps, weights of 1, and work arrays."""
        n, shapes = items + len(self.instance.obstacles), self.instance.arrays
        sides = np.maximum((shapes.hi - shapes.lo) / self.outlines.step, 0.0).astype(np.int64) + 2
        cells = int(sides.prod(axis=1).max(initial=1))
        return PlateState(
            np.zeros((items, n)),
            np.ones((items, n)),
            self.rng.integers(1, 2**63, 1).astype(np.uint64),
            np.zeros(4, np.int64),
            np.empty(cells, np.float32),
            np.empty(cells, np.float32),
            np.empty(n, np.int64),
            np.empty(items, np.int64),
            np.empty(CANDIDATES, np.int64),
            np.empty(CANDIDATES),
        )

    def run(
        self,
        layout: PlateLayout,
        best: PlateLayout,
        rules: MoveRules,
        state: PlateState,
        rounds: int = ROUNDS,
    ) -> float:
        """Run some rounds of the separation and charge their work; return the total overlap of the best layout."""
        before = int(state.spent[READ])
        shapes = self.instance.arrays
        least = separate_plates(self.outlines, self.cache, shapes, rules, layout, best, state, rounds)
        self.budget.left -= int(state.spent[READ]) - before + 1000
        return float(least)


def make_scene(
    instance: PlateInstance, params: PlatesParams, rng: np.random.Generator, budget: WorkBudget
) -> PlateScene:
    """Return a scene with an empty cache of fields."""
    outlines, clearances = instance.outlines, np.full(len(instance.outlines), instance.problem.clearance)
    for obstacle in instance.obstacles:
        clearances[obstacle.outline] = obstacle.clearance
    step = params.step * instance.mean_size
    sampled = sample_outlines(outlines, clearances.tolist(), step, instance.radius)
    pieces = [outline.pieces for outline in outlines]
    points = [piece for each in pieces for piece in each]
    convex = PlatePieces(
        np.concatenate(points),
        starts_of(points),
        starts_of(pieces),
        np.array([[*point.min(axis=0), *point.max(axis=0)] for point in points]),
        np.array([outline.half for outline in outlines]),
        clearances,
    )
    first = np.full((*instance.conflict.shape, 4), UNKNOWN, np.int64)
    first[~instance.conflict] = NONE
    values = np.empty(_cache_size(sampled, params.memory), np.int16)
    cache = FieldCache(values, first, np.zeros(2, np.int64))
    return PlateScene(instance, sampled, convex, cache, params, rng, budget)


def _cache_size(outlines: SampledOutlines, memory: float) -> int:
    """Return the number of values of the cache: those of all fields, or what the memory (MB) holds."""
    side = outlines.half[:, None] + outlines.half[None] + outlines.clearance.max(initial=0.0)
    cells = 2.0 * (side / outlines.step + 2.0) + 1.0
    largest = float(cells.prod(axis=2).max(initial=1.0)) if len(cells) else 1.0
    together = 4.0 * float(cells.prod(axis=2).sum())
    return int(max(min(together, memory * 5e5), 4.0 * largest, SMALLEST_FIELDS))


def placed_from(layout: PlateLayout, items: Int64s) -> OnPlates:
    """Return the items of a layout without the obstacles; a copy."""
    n = len(items)
    return OnPlates(items, layout.shape[:n].copy(), layout.plate[:n].copy(), layout.position[:n].copy())
