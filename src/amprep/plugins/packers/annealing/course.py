"""The course of the annealing for each objective: one build is filled or lowered, or one build after another filled."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from amprep.arrays import Floats
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem, Placement
from amprep.plugins.packers.annealing.bounds import objective_bound, solid_volume
from amprep.plugins.packers.annealing.params import AnnealingParams
from amprep.plugins.packers.annealing.scene import PreparedVolumes
from amprep.plugins.packers.annealing.search import BuildSearch, BuildTask
from amprep.plugins.packers.annealing.start import RESERVE, placements, start_layout

Builds = list[dict[int, Placement]]
"""Placements of each build by item, the fixed ones included."""


@dataclass(frozen=True, eq=False)
class Annealing:
    """A problem with its volumes, its first layout and the parameters of the search."""

    prepared: PreparedVolumes
    start: Packing
    params: AnnealingParams
    rng: np.random.Generator

    @property
    def problem(self) -> PackingProblem:
        """The packing problem."""
        return self.prepared.problem

    @cached_property
    def volumes(self) -> Floats:
        """Volume of every item, ``(n,)`` mm3."""
        known = {id(item.volume): item.volume for item in self.problem.items}
        measured = {key: solid_volume(volume) for key, volume in known.items()}
        return np.array([measured[id(item.volume)] for item in self.problem.items])

    @cached_property
    def still(self) -> set[int]:
        """Items with a fixed placement."""
        return {placement.item for placement in self.problem.fixed}

    def pack(self, too_large: set[int], stop: Stop, progress: Progress) -> tuple[Builds, str]:
        """Return the builds, and the reason of an early end or ""."""
        items = [i for i in range(len(self.problem.items)) if i not in self.still and i not in too_large]
        first = [placements(self.start, number) for number in range(len(self.start.builds))]
        if stop():
            return first, stop.reason
        if not items or self.rank(first) <= self._best_rank(too_large):
            return first, "bound met" if items else ""
        pack = self._pack_builds if self.problem.objective == "builds" else self._pack_one
        found, reason = pack(items, stop, progress)
        return min((found, first), key=self.rank), reason

    def rank(self, builds: Builds) -> tuple[float, float]:
        """Return a rank that is smaller for better builds: value or items outside, then the objective."""
        if self.problem.objective == "fill":
            return (-self.reached(builds), 0.0)
        placed = {item for build in builds for item in build}
        left = sum(self.volumes[i] for i in range(len(self.problem.items)) if i not in placed)
        return (float(left), self.reached(builds))

    def _best_rank(self, too_large: set[int]) -> tuple[float, float]:
        """Return a rank that no builds can improve on."""
        bound = self.bound(too_large)
        if self.problem.objective == "fill":
            return (-bound, 0.0)
        left = sum(self.volumes[i] for i in too_large)
        return (float(left), bound)

    def reached(self, builds: Builds) -> float:
        """Return the value of the objective."""
        if self.problem.objective == "builds":
            return float(len(builds))
        placed = [placement for build in builds for placement in build.values()]
        if self.problem.objective == "fill":
            return float(sum(self.problem.items[placement.item].value for placement in placed))
        return max((self._top(placement) for placement in placed), default=0.0)

    def bound(self, too_large: set[int]) -> float:
        """Return the bound on the objective."""
        items = [i for i in range(len(self.problem.items)) if i not in self.still and i not in too_large]
        return objective_bound(self.prepared, items, self.volumes, self.start)

    def _top(self, placement: Placement) -> float:
        points = self.prepared.points[self.prepared.shape_of[placement.item]]
        return float((points @ placement.rotation[2]).max() + placement.translation[2])

    def _search(
        self, items: list[int], layout: dict[int, Placement], weights: Floats, *, first: bool
    ) -> BuildSearch:
        """Return the search of one build from a layout."""
        lowers = self.problem.objective == "height"
        task = BuildTask(
            movable=items,
            fixed=self.problem.fixed if first else (),
            layout=layout,
            weights=weights[items],
            volumes=self.volumes[items],
            lowers=lowers,
            least_height=self.bound(set()) if lowers else 0.0,
        )
        return BuildSearch(self.prepared, task, self.params, self.rng)

    def _pack_one(self, items: list[int], stop: Stop, progress: Progress) -> tuple[Builds, str]:
        """Anneal one build from the first layout; from one with more clearance if that layout is too tight."""
        value = np.array([item.value for item in self.problem.items])
        weights = value if self.problem.objective == "fill" else self.volumes
        search = self._search(items, placements(self.start, 0), weights, first=True)
        if search.colliding:
            apart = start_layout(self.problem, self.params.start, self.rng, stop, RESERVE)
            search = self._search(items, placements(apart, 0), weights, first=True)
        reason = search.run(stop, progress)
        build = {placement.item: placement for placement in (*self.problem.fixed, *search.best())}
        return ([build] if build else []), reason

    def _pack_builds(self, items: list[int], stop: Stop, progress: Progress) -> tuple[Builds, str]:
        """Fill one build after another with what is left (thesis 2.1), each from its first layout.

        An item that another one displaces is tried in the builds that follow; what is left at the end gets builds of
        its own, by a packer of boxes.
        """
        start = start_layout(self.problem, self.params.start, self.rng, stop, RESERVE)
        expected = max(1, len(start.builds))
        left, builds, reason = set(items), Builds(), ""
        while left and not reason:
            number = len(builds)
            kept = {i: p for i, p in placements(start, number).items() if i in left}
            search = self._search(sorted(left), kept, self.volumes, first=number == 0)
            reason = search.run(stop, _part_of(progress, number, expected))
            fixed = self.problem.fixed if number == 0 else ()
            build = {placement.item: placement for placement in (*fixed, *search.best())}
            if not build:
                break
            builds.append(build)
            left -= build.keys()
        return [*builds, *self._own_builds(sorted(left), stop)], reason

    def _own_builds(self, items: list[int], stop: Stop) -> Builds:
        """Return further builds for some items."""
        if not items:
            return []
        chosen = tuple(self.problem.items[item] for item in items)
        rest = replace(self.problem, items=chosen, fixed=())
        packer = "extreme-points" if self.params.start == "outside" else self.params.start
        packing = start_layout(rest, packer, self.rng, stop)
        return [
            {items[p.item]: Placement(items[p.item], p.rotation, p.translation) for p in build}
            for build in packing.builds
        ]


def _part_of(progress: Progress, number: int, count: int) -> Progress:
    """Return a callback for the progress of one build of several."""

    def tell(fraction: float, message: str) -> None:
        progress(min(1.0, (number + fraction) / count), f"build {number + 1}: {message}")

    return tell
