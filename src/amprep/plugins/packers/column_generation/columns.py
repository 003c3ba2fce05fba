"""Builds as columns of a set covering: how many items of each kind, and where they stand."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.model.packing import Objective, Packing, PackingProblem
from amprep.plugins.packers.instance.arrangement import Arrangement, arrangement_of, nothing_placed
from amprep.plugins.packers.instance.prepare import Scene, prepare


@dataclass(frozen=True, eq=False)
class Column:
    """A build by kinds: any items of these kinds may take the places.

    Attributes
    ----------
    kind, variant
        ``(m,)`` int64.
    place
        ``(m, 3)`` mm, least corners.
    """

    kind: Int64s
    variant: Int64s
    place: Floats

    def counts(self, kinds: int) -> Int64s:
        """Return how many items of each kind there are, ``(kinds,)``."""
        return np.bincount(self.kind, minlength=kinds)


def demand_of(scene: Scene) -> Int64s:
    """Return how many items of each kind are to be placed, ``(kinds,)``."""
    return np.bincount(scene.kind[scene.free], minlength=len(scene.kinds))


def columns_of(scene: Scene, packing: Packing) -> list[Column]:
    """Return the builds of a packing of this scene, which holds nothing fixed."""
    return _columns(scene, arrangement_of(scene, packing), np.arange(len(scene.kind)))


def _columns(scene: Scene, found: Arrangement, items: Int64s) -> list[Column]:
    """Return the builds of an arrangement of some `items` of the scene."""
    columns = []
    for build in range(int(found.build.max(initial=-1)) + 1):
        own = np.flatnonzero(found.build == build)
        columns.append(Column(scene.kind[items[own]], found.variant[own], found.place[own]))
    return columns


def single_columns(scene: Scene) -> list[Column]:
    """Return a build for each kind to be placed, with one item: so there is a cover."""
    columns = []
    for kind in np.flatnonzero(demand_of(scene)).tolist():
        variant = next(v for v, way in enumerate(scene.kinds[kind]) if np.isfinite(way.home[0]))
        place = scene.kinds[kind][variant].home[None]
        columns.append(Column(np.array([kind]), np.array([variant]), place))
    return columns


@dataclass(frozen=True, eq=False)
class Part:
    """A problem over some of a scene's items, and the way back."""

    scene: Scene
    problem: PackingProblem
    items: Int64s

    def columns(self, packing: Packing) -> list[Column]:
        """Return the builds of a packing of the smaller problem."""
        return _columns(self.scene, arrangement_of(prepare(self.problem), packing), self.items)


def part_of(scene: Scene, items: Int64s, objective: Objective, values: Floats | None = None) -> Part:
    """Return the problem over `items`, with the `values` of their kinds when given."""
    kept = [scene.problem.items[item] for item in items.tolist()]
    if values is not None:
        worth = values[scene.kind[items]].tolist()
        kept = [replace(item, value=value) for item, value in zip(kept, worth, strict=True)]
    return Part(scene, replace(scene.problem, items=tuple(kept), objective=objective), items)


def remaining_items(scene: Scene, taken: Int64s) -> Int64s:
    """Return the items to be placed when `taken` ``(kinds,)`` of each kind are."""
    left = demand_of(scene) - taken
    kept = [np.flatnonzero(scene.free & (scene.kind == k))[: max(n, 0)] for k, n in enumerate(left.tolist())]
    return np.sort(np.concatenate(kept)) if kept else np.empty(0, np.int64)


def arrangement_from(scene: Scene, columns: Iterable[Column]) -> Arrangement:
    """Return a cover as an arrangement: what is covered twice is left out the second time."""
    found = nothing_placed(scene)
    waiting = [np.flatnonzero(scene.free & (scene.kind == k)).tolist() for k in range(len(scene.kinds))]
    build = 0
    for column in columns:
        used = False
        for kind, variant, place in zip(column.kind.tolist(), column.variant, column.place, strict=True):
            if waiting[kind]:
                item, used = waiting[kind].pop(0), True
                found.build[item], found.variant[item], found.place[item] = build, variant, place
        build += used
    return found


def count_of(columns: Sequence[Column], kinds: int) -> Int64s:
    """Return how many items of each kind are in all columns together, ``(kinds,)``."""
    total = np.zeros(kinds, np.int64)
    for column in columns:
        total += column.counts(kinds)
    return total
