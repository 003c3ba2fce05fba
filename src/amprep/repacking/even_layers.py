"""Move parts of a packing up and down so that the cross-sections of all layers become more equal."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.removal.vertical import too_near, vertical_travel
from amprep.geometry.slicing.cross_sections import cross_section_areas
from amprep.model import Packing, PackingProblem, Part, Placement, Stop
from amprep.repacking.volume_bodies import VolumeBodies

# Strategy. The sum of the squared areas of all layers falls if and only if their variation does, since their sum stays.
# One part after another, largest first, is moved to the height, within its free travel up and down, where that sum is
# least; seen from the part, it is the correlation of its own areas with those of all others. Heights are steps of one
# layer, so that areas are shifted and never computed again. This is repeated until nothing moves. No part leaves the
# height of its build, so neither the height nor the number of builds rises. At the end all distances are checked; if
# one were too small, the build would stay as it was.

LAYERS = 400
"""Layers of a build, of equal height."""

ROUNDS = 8
"""Rounds over all parts, at most."""

LEAST_GAIN = 1e-6
"""Fraction of the sum of squares that a move must gain."""


@dataclass(frozen=True)
class Evened:
    """The variation of the areas of layers in a build before and after, and the number of parts that moved."""

    build: int
    before: float
    after: float
    moved: int


def even_layers(
    problem: PackingProblem, packing: Packing, parts: Sequence[Part], stop: Stop
) -> tuple[Packing, tuple[Evened, ...]]:
    """Return a packing in which parts were moved vertically, and what was gained in each build where some were.

    Parameters
    ----------
    problem, packing
        A problem with stacking, and a packing that keeps its rules.
    parts
        The parts of the problem, whose meshes have the cross-sections.
    stop
        Ends the moves early.
    """
    volumes, gains, builds = VolumeBodies(problem), [], list(packing.builds)
    for number, build in enumerate(packing.builds):
        fixed = {placement.item for placement in problem.fixed} if number == 0 else set()
        layered = _Layers(problem, volumes, parts, build, fixed)
        before = layered.variation
        moved = layered.descend(stop)
        if moved and not layered.is_too_near(moved):
            builds[number] = layered.placements
            gains.append(Evened(number + 1, before, layered.variation, len(moved)))
    return replace(packing, builds=tuple(builds)), tuple(gains)


class _Layers:
    """The parts of a build, and the areas of its layers."""

    def __init__(
        self,
        problem: PackingProblem,
        volumes: VolumeBodies,
        parts: Sequence[Part],
        build: Sequence[Placement],
        fixed: set[int],
    ) -> None:
        self._problem, self._volumes = problem, volumes
        self.placements = tuple(build)
        self._bodies = [volumes.body(placement) for placement in build]
        self._free = [index for index, placement in enumerate(build) if placement.item not in fixed]
        self._low = min((float(body.low[:, 2].min()) for body in self._bodies), default=problem.lift)
        self._low = min(self._low, problem.lift)
        self._high = max((float(body.high[:, 2].max()) for body in self._bodies), default=self._low)
        self._layer = max(self._high - self._low, 1e-9) / LAYERS
        heights = np.asarray(self._low + self._layer * (np.arange(LAYERS) + 0.5), np.float64)
        self._own = [_areas(problem, parts, placement, heights) for placement in build]
        self._total = sum(self._own, np.zeros(LAYERS))

    @property
    def variation(self) -> float:
        """Coefficient of variation of the areas of the layers."""
        mean = float(self._total.mean())
        return float(self._total.std()) / mean if mean > 0.0 else 0.0

    def descend(self, stop: Stop) -> set[int]:
        """Move parts until none gains any more; return those that moved."""
        order = sorted(self._free, key=lambda index: -float(self._own[index].sum()))
        moved: set[int] = set()
        for _ in range(ROUNDS):
            now = {index for index in order if not stop() and self._move(index)}
            moved |= now
            if not now:
                break
        return moved

    def _move(self, index: int) -> bool:
        """Move one part to the best height within its free travel; tell whether it moved."""
        body, own = self._bodies[index], self._own[index]
        others = [other for k, other in enumerate(self._bodies) if k != index] + list(self._volumes.zones)
        down, up = (
            min(vertical_travel(body, others, sign, limit, self._problem.clearance), limit)
            for sign, limit in (
                (-1, max(float(body.low[:, 2].min()) - self._problem.lift, 0.0)),
                (1, max(self._high - float(body.high[:, 2].max()), 0.0)),
            )
        )
        layers = np.flatnonzero(own)
        if not len(layers):
            return False
        first, last = int(layers[0]), int(layers[-1]) + 1
        steps = np.arange(-min(int(down / self._layer), first), min(int(up / self._layer), LAYERS - last) + 1)
        rest, section = self._total - own, own[first:last]
        overlap = np.array([float(rest[first + step : last + step] @ section) for step in steps])
        step = int(steps[overlap.argmin()])
        gain = 2.0 * (float(rest[first:last] @ section) - float(overlap.min()))
        if gain <= LEAST_GAIN * float(self._total @ self._total):
            return False
        shifted = np.zeros(LAYERS)
        shifted[first + step : last + step] = section
        self._own[index], self._total = shifted, rest + shifted
        self._shift(index, step * self._layer)
        return True

    def _shift(self, index: int, height: float) -> None:
        old = self.placements[index]
        new = Placement(old.item, old.rotation, old.translation + [0.0, 0.0, height])
        self.placements = (*self.placements[:index], new, *self.placements[index + 1 :])
        self._bodies[index] = self._volumes.body(new)

    def is_too_near(self, moved: set[int]) -> bool:
        """Tell whether a part that moved is nearer to another than the clearance."""
        gap = self._problem.clearance
        return any(
            too_near(self._bodies[index], other, gap)
            for index in moved
            for k, other in enumerate(self._bodies)
            if k != index
        )


def _areas(problem: PackingProblem, parts: Sequence[Part], placement: Placement, heights: Floats) -> Floats:
    """Return the areas of the cross-sections of a placed part."""
    item = problem.items[placement.item]
    mesh = parts[item.part].mesh
    vertices = mesh.vertices @ (placement.rotation @ item.turn).T + placement.translation
    return np.maximum(cross_section_areas(vertices[mesh.triangles], heights), 0.0)
