"""Guided separation on a number of plates, and the disturbance of layouts from which it starts again."""

from typing import NamedTuple

import numpy as np

from amprep.plugins.packers.plates.programs import make_exact
from amprep.plugins.packers.plates.state import OnPlates, PlateScene, placed_from

PROGRESS = 0.98
"""The total overlap must fall below this fraction of the least one to count as progress."""

RESIDUE = 0.06
"""Total overlap, in mean sizes of the shapes, at which the linear program is tried."""

SMALL = 1e-3
"""Total overlap (mm) at which the linear program is tried in any case."""


class PlateAttempt(NamedTuple):
    """Result of a separation: the layout of least overlap, and the one without any if it was found."""

    overlap: float
    nearest: OnPlates
    exact: OnPlates | None


def separated(scene: PlateScene, start: OnPlates, plates: int) -> PlateAttempt:
    """Move overlapping items until nothing overlaps, or until there is no progress for a while."""
    start = clipped(scene, start)
    layout, best, items = scene.layout(start), scene.layout(start), start.items
    state, rules = scene.state(len(items)), scene.rules(items, plates)
    least, nearest, idle, tried = np.inf, start, 0, np.inf
    residue = RESIDUE * scene.instance.mean_size
    while not scene.budget.over() and idle < scene.params.persistence:
        overlap = scene.run(layout, best, rules, state)
        idle = 0 if overlap < PROGRESS * least else idle + 1
        if overlap < least:
            least, nearest = overlap, placed_from(best, items)
        if overlap < residue and (overlap < SMALL or overlap < 0.8 * tried):
            tried = overlap
            exact = make_exact(scene, placed_from(best, items))
            if exact is not None:
                return PlateAttempt(0.0, nearest, exact)
    return PlateAttempt(least, nearest, None)


def clipped(scene: PlateScene, placed: OnPlates) -> OnPlates:
    """Return a layout with all items in their ranges of positions."""
    shapes = scene.instance.arrays
    position = np.maximum(np.minimum(placed.position, shapes.hi[placed.shape]), shapes.lo[placed.shape])
    return placed._replace(position=position)


def disturbed(scene: PlateScene, placed: OnPlates) -> OnPlates:
    """Exchange the places of two items, large ones more often; of two pairs in half of all cases."""
    changed, half, rng = placed.copy(), scene.instance.half, scene.rng
    n = len(placed.items)
    if n < 2:
        return changed
    for _ in range(int(rng.integers(1, 3))):
        chance = half[changed.shape].prod(axis=1)
        i, j = rng.choice(n, 2, replace=False, p=chance / chance.sum()).tolist()
        changed.position[[i, j]] = changed.position[[j, i]]
        changed.plate[[i, j]] = changed.plate[[j, i]]
    return changed


class PlateAttempts:
    """The attempts with the least overlap, from which the search starts again."""

    SIZE = 8

    def __init__(self) -> None:
        self.attempts: list[PlateAttempt] = []

    def add(self, attempt: PlateAttempt) -> None:
        """Add a failed attempt; the worst one leaves a full pool."""
        self.attempts.append(attempt)
        self.attempts.sort(key=lambda each: each.overlap)
        del self.attempts[self.SIZE :]

    def choose(self, rng: np.random.Generator, start: OnPlates) -> OnPlates:
        """Return the layout of the start or, three times as often, an attempt, those of little overlap more often."""
        if rng.random() < 0.25 or not self.attempts:
            return start
        number = min(int(rng.exponential(1.5)), len(self.attempts) - 1)
        return self.attempts[number].nearest
