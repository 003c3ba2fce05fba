"""Guided separation on a number of plates, and the disturbance of layouts from which it starts again."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.plugins.packers.plates.programs import make_exact
from amprep.plugins.packers.plates.state import OnPlates, PlateScene, placed_from

PROGRESS = 0.98
"""The total overlap must fall below this fraction of the least one to count as progress."""

RESIDUE = 0.06
"""Total overlap, in mean sizes of the shapes, at which the linear program is tried."""

SMALL = 1e-3
"""Total overlap (mm) at which the linear program is tried in any case, and the search ends."""

LESS = 0.8
"""Fraction of the overlap at the last try below which it is tried again."""

SIMILAR = (0.3, 1.1)
"""Areas of items for an exchange, as fractions of that of the item that overlaps."""


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
        if overlap < residue and (overlap < SMALL or overlap < LESS * tried):
            tried = overlap
            exact = make_exact(scene, placed_from(best, items))
            if exact is not None:
                return PlateAttempt(0.0, nearest, exact)
            if overlap < SMALL:
                break
    return PlateAttempt(least, nearest, None)


def clipped(scene: PlateScene, placed: OnPlates) -> OnPlates:
    """Return a layout with all items in their ranges of positions."""
    shapes = scene.instance.arrays
    position = np.maximum(np.minimum(placed.position, shapes.hi[placed.shape]), shapes.lo[placed.shape])
    return placed._replace(position=position)


def disturbed(scene: PlateScene, placed: OnPlates) -> OnPlates:
    """Exchange an item that overlaps, or any one where none does, with another of similar size, once to three times."""
    changed, rng = placed.copy(), scene.rng
    n = len(placed.items)
    if n < 2:
        return changed
    area = scene.instance.half[scene.instance.first[placed.items]].prod(axis=1)
    chance = overlaps(scene, placed) + 1e-2 * scene.outlines.step
    for _ in range(int(rng.integers(1, 4))):
        i = int(rng.choice(n, p=chance / chance.sum()))
        similar = (area >= SIMILAR[0] * area[i]) & (area <= SIMILAR[1] * area[i])
        similar[i] = False
        others = np.flatnonzero(similar) if similar.any() else np.delete(np.arange(n), i)
        j = int(rng.choice(others))
        changed.position[[i, j]] = changed.position[[j, i]]
        changed.plate[[i, j]] = changed.plate[[j, i]]
    return changed


def overlaps(scene: PlateScene, placed: OnPlates) -> Floats:
    """Return the total overlap of each item, mm."""
    layout, state = scene.layout(placed), scene.state(len(placed.items))
    scene.run(layout, scene.layout(placed), scene.rules(placed.items, max(placed.plates, 1)), state, 0)
    return np.asarray(state.overlap.sum(axis=1))


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
